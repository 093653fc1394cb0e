def _or_nan(value, scale, power=1):
    """What divides, or NaN where its size is at most eps**power times that of `scale`.

    Without a scale, where it is at most the smallest normal number over eps.
    """
    limits = jnp.finfo(value.dtype)
    if scale is None:
        least = limits.tiny / limits.eps
    else:
        least = float(limits.eps) ** power * jnp.abs(scale)
    return jnp.where(jnp.abs(value) <= least, jnp.nan, value)
