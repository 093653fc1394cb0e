def _entries(matrix):
    """The entries of matrices on one axis, row by row, or an error."""
    try:
        array = np.asarray(matrix)
    except ValueError as error:
        raise ValueError("matrix: not an array; expected (..., 3, 3)") from error
    if array.shape[-2:] != (3, 3):
        raise ValueError(f"matrix: got shape {array.shape}; expected (..., 3, 3)")
    return array.reshape(*array.shape[:-2], 9)
