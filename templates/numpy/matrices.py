def _entries(name, value, shape, or_flat=False):
    """The entries of matrices on one axis, row by row, or an error."""
    array = _plain(name, value, shape)
    if array.shape[-2:] == shape:
        return array.reshape(*array.shape[:-2], len(_COMPONENTS[name]))
    if or_flat and array.shape[-1:] == (len(_COMPONENTS[name]),):
        return array
    raise ValueError(f"{name}: got shape {array.shape}; {_expected(name, shape)}")
