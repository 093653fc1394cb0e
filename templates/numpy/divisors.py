# What follows serves divisors that can vanish.

_EPS = 2.0**-52  # of float64
_LEAST = 2.0**-970  # of float64: the smallest normal number over eps
_FAR, _FAR_SINGLE = 2.0**103, 2.0**45  # half of 1/eps²


def _or_nan(value, scale, power=1):
    """What divides, or NaN where its size is at most eps**power times that of `scale`.

    Without a scale, where it is at most the smallest normal number over eps.
    """
    # One sum tells when none is lost. From 10,001 values on, OpenBLAS takes it in several threads,
    # which wait for one another: for up to eleven times as long on a busy processor.
    if scale is not None and value.ndim == 1 and value.size <= 10_000:
        ratio = scale / value
        far = _FAR if value.dtype is _DOUBLE else _FAR_SINGLE
        if ratio.dot(ratio) < far**power:
            return value
    eps, least = (2.0**-23, 2.0**-103) if value.dtype.char == "f" else (_EPS, _LEAST)
    limit = least if scale is None else eps**power * np.abs(scale)
    lost = np.abs(value) <= limit
    return (
        np.where(lost, value.dtype.type(np.nan), value)
        if np.count_nonzero(lost)
        else value
    )


def _or_nan_scalar(value, scale, power=1):
    """`_or_nan` of one float."""
    least = _LEAST if scale is None else _EPS**power * abs(scale)
    return value if abs(value) > least else float("nan")
