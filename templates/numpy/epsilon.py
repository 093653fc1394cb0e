def _eps(value):
    """The distance from one to the next float, in the type of an array."""
    return np.finfo(value.dtype).eps
