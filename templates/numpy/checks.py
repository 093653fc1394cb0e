def _checked(name, value):
    """The argument as a plain array, or an error that names it and what it should be."""
    try:
        array = np.asarray(value)
    except ValueError as error:
        raise ValueError(f"{name}: not an array; {_expected(name)}") from error
    if array.dtype.char not in "fd" and array.dtype.kind not in "iu":
        raise TypeError(
            f"{name}: got dtype {array.dtype}; expected float64, float32 or integers"
        )
    if array.ndim == 0 or array.shape[-1] != len(_COMPONENTS[name]):
        raise ValueError(f"{name}: got shape {array.shape}; {_expected(name)}")
    return array


def _expected(name):
    components = _COMPONENTS[name]
    return f"expected (..., {len(components)}), the last axis {', '.join(components)}"


def _leading_shape(arrays):
    """The shape that the axes before the last broadcast to."""
    shapes = {array.shape[:-1] for array in arrays.values()}
    if len(shapes) == 1:
        return shapes.pop()
    try:
        return np.broadcast_shapes(*shapes)
    except ValueError as error:
        given = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
        raise ValueError(f"axes before the last do not broadcast: {given}") from error


def _result(out, shape, dtype):
    """A new array, or `out` where it is what the result needs."""
    if out is None:
        return np.empty(shape, dtype)
    if not isinstance(out, np.ndarray):
        raise TypeError(f"out: got {type(out).__name__}; expected a NumPy array")
    if out.dtype != dtype:
        raise TypeError(f"out: got dtype {out.dtype}; expected {dtype}")
    if out.shape != shape:
        raise ValueError(f"out: got shape {out.shape}; expected {shape}")
    if not out.flags.writeable:
        raise ValueError("out: the array is read-only")
    return out


def _unshared(array, out):
    """The array, or a copy of it where writing to `out` would change it."""
    if out is None or not np.may_share_memory(array, out, max_work=10_000):
        return array
    return array.copy()
