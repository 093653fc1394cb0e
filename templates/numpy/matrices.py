def _entries(name, value, shape):
    """The entries of matrices on one axis, row by row, or an error."""
    array = _plain(name, value, shape)
    if array.shape[-2:] == shape:
        return array.reshape(*array.shape[:-2], len(_COMPONENTS[name]))
    raise ValueError(f"{name}: got shape {array.shape}; {_expected(name, shape)}")
