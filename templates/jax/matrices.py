def _entries(name, value, shape, or_flat=False):
    """The entries of matrices on one axis, row by row, or an error."""
    array, whole = _plain(name, value), len(_COMPONENTS[name])
    if array.shape[-2:] == shape:
        return array.reshape(*array.shape[:-2], whole)
    if or_flat and array.shape[-1:] == (whole,):
        return array
    expected = ", ".join(map(str, shape))
    raise ValueError(f"{name}: got shape {array.shape}; expected (..., {expected})")
