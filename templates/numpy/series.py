def _entire(square, *orders):
    """c_k of n² for each order k: c0 = cos n, c1 = sin n/n, c_(k+2) = (c_k(0) - c_k)/n².

    The first three follow from t = tan(n/2), which leaves c2 its digits where it vanishes.
    """
    half = 0.5 * np.sqrt(square)
    t = np.tan(half)
    scale = 1.0 + t * t
    ratio = np.divide(t, half, out=np.ones_like(t), where=half > 0)
    values = [(1.0 - t * t) / scale, ratio / scale, 0.5 * ratio * ratio / scale]
    for order in range(3, max(orders) + 1):
        switch, start, *coefficients = _SERIES[order]
        near = _polynomial(coefficients, square)
        far = (start - values[order - 2]) / square
        values.append(np.where(square < switch, near, far))
    return [values[order] for order in orders]


def _entire_scalar(square, *orders):
    """`_entire` of one float."""
    half = 0.5 * sqrt(square)
    t = tan(half)
    scale = 1.0 + t * t
    ratio = t / half if half else 1.0
    values = [(1.0 - t * t) / scale, ratio / scale, 0.5 * ratio * ratio / scale]
    for order in range(3, max(orders) + 1):
        switch, start, *coefficients = _SERIES[order]
        if square < switch:
            values.append(_polynomial(coefficients, square))
        else:
            values.append((start - values[order - 2]) / square)
    return [values[order] for order in orders]


def _polynomial(coefficients, x):
    """Coefficients from the lowest power up, by Horner's rule."""
    value = coefficients[-1] * x + coefficients[-2]
    for coefficient in reversed(coefficients[:-2]):
        value *= x
        value += coefficient
    return value
