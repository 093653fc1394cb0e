_EPSILON = {_SINGLE: np.float32(2.0**-23), _DOUBLE: np.float64(2.0**-52)}


def _eps(value):
    """The distance from one to the next float, in the type of an array."""
    return _EPSILON[value.dtype]
