def _parted(both, first, second):
    """Two results from one array, which holds one after the other on its last axis."""
    place, leading = prod(first), both.shape[:-1]
    derivative = both[..., place:].reshape(leading + second)
    return both[..., :place].reshape(leading + first), derivative
