def _components(**arguments):
    """Zeros like an entry of the result, and the components of all arguments by name."""
    arrays = {name: _checked(name, value) for name, value in arguments.items()}
    shape = jnp.broadcast_shapes(*(array.shape[:-1] for array in arrays.values()))
    dtype = jnp.result_type(*arrays.values())
    parts = {name: jnp.moveaxis(a.astype(dtype), -1, 0) for name, a in arrays.items()}
    return jnp.zeros(shape, dtype), parts


def _checked(name, value):
    """The argument as an array of floats, or an error that names it."""
    names, array = _COMPONENTS[name], _plain(name, _in_order(name, value, jnp))
    if not jnp.issubdtype(array.dtype, jnp.floating):
        if not jnp.issubdtype(array.dtype, jnp.integer):
            raise TypeError(f"{name}: got dtype {array.dtype}; expected floats")
        array = array.astype(float)
    if array.ndim == 0 or array.shape[-1] != len(names):
        raise ValueError(
            f"{name}: got shape {array.shape}; expected (..., {len(names)}), "
            f"the last axis {', '.join(names)}"
        )
    return array


def _plain(name, value):
    try:
        return jnp.asarray(value)
    except (TypeError, ValueError) as error:
        if hasattr(value, "mask"):
            raise TypeError(f"{name}: JAX takes no masked array") from error
        dtype = getattr(value, "dtype", type(value).__name__)
        raise TypeError(f"{name}: JAX takes no array of {dtype}") from error


def _together(like, shape, *values):
    """Entries as one array, row by row on the last axes."""
    whole = [jnp.broadcast_to(value, like.shape) for value in values]
    entries = [value.astype(like.dtype) for value in whole]
    return jnp.stack(entries, axis=-1).reshape(*like.shape, *shape)
