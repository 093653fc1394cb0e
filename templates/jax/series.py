def _entire(square, *orders):
    """c_k of n² for each order k: c0 = cos n, c1 = sin n/n, c_(k+2) = (c_k(0) - c_k)/n²."""
    return [_entire_of(order)(square) for order in orders]


@cache
def _entire_of(order):
    """c_k with its derivative (k c_(k+2) - c_(k+1))/2 by n², so that n = 0 is like any point."""

    @jax.custom_jvp
    def value(square):
        return _entire_value(order, square)

    @value.defjvp
    def tangent(primals, tangents):
        (square,), (step,) = primals, tangents
        after, last = _entire(square, order + 1, order + 2)
        return value(square), 0.5 * (order * last - after) * step

    return value


def _entire_value(order, square):
    """c_k of n²; the first three follow from t = tan(n/2), the others have a series near zero."""
    if order > 2:
        if order not in _SERIES:
            raise NotImplementedError("functions of |v| have two derivatives, no more")
        switch, start, *coefficients = _SERIES[order]
        is_near = square < switch
        near = jnp.polyval(jnp.array(coefficients[::-1], square.dtype), square)
        below = _entire_value(order - 2, square)
        far = (start - below) / jnp.where(is_near, 1.0, square)
        return jnp.where(is_near, near, far)
    half = 0.5 * jnp.sqrt(square)
    t = jnp.tan(half)
    scale = 1.0 + t * t
    ratio = jnp.where(half > 0, t / jnp.where(half > 0, half, 1.0), 1.0)
    return ((1.0 - t * t) / scale, ratio / scale, 0.5 * ratio * ratio / scale)[order]
