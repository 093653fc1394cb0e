def _arrays(arguments):
    """The arguments as arrays of one dtype and of the same leading axes or none, and both."""
    arrays, leading, singles, is_uneven = [], (), 0, False
    for name, array in arguments.items():
        if type(array) is not _ARRAY or array.dtype is not _DOUBLE:
            array = _plain_floats(name, array)
            singles += array.dtype is _SINGLE
        shape = array.shape
        if shape[-1:] != _WIDTHS[name]:
            raise ValueError(f"{name}: got shape {shape}; {_expected(name)}")
        axes = shape[:-1]
        if axes and axes != leading:
            is_uneven = is_uneven or leading != ()
            leading = axes
        arrays.append(array)
    if singles and singles < len(arrays):
        arrays = [array.astype(_DOUBLE, copy=False) for array in arrays]
    if is_uneven:
        try:
            leading = np.broadcast_shapes(*(array.shape[:-1] for array in arrays))
        except ValueError as error:
            given = ", ".join(f"{name} {a.shape}" for name, a in zip(arguments, arrays))
            raise ValueError(
                f"axes before the last do not broadcast: {given}"
            ) from error
        arrays = [np.broadcast_to(a, leading + a.shape[-1:]) for a in arrays]
    return arrays, leading, arrays[0].dtype


def _plain_floats(name, value):
    """The argument as a plain array of native floats, or an error."""
    array = _plain(name, value)
    if array.dtype.char not in "fd" and array.dtype.kind not in "iu":
        raise TypeError(
            f"{name}: got dtype {array.dtype}; expected float64, float32 or integers"
        )
    return array.astype(_SINGLE if array.dtype.char == "f" else _DOUBLE, copy=False)


def _plain(name, value, shape=None):
    """The argument as a plain array, or an error; a matrix has a shape."""
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        raise TypeError(
            f"{name}: got masked entries; fill them, or leave their rows out"
        )
    if shape is None and (type(value) is not _ARRAY or value.dtype.names):
        value = _in_order(name, value, np)
    try:
        return np.asarray(value)
    except ValueError as error:
        raise ValueError(f"{name}: not an array; {_expected(name, shape)}") from error


def _expected(name, shape=None):
    components = _COMPONENTS[name]
    if shape:
        return f"expected (..., {', '.join(map(str, shape))})"
    return f"expected (..., {len(components)}), the last axis {', '.join(components)}"


def _checked_out(out, shape, dtype):
    """`out` if it is what the result needs, or an error."""
    if not isinstance(out, _ARRAY):
        raise TypeError(f"out: got {type(out).__name__}; expected a NumPy array")
    if out.dtype is not dtype and out.dtype != dtype:
        raise TypeError(f"out: got dtype {out.dtype}; expected {dtype}")
    if out.shape != shape:
        raise ValueError(f"out: got shape {out.shape}; expected {shape}")
    if not out.flags.writeable:
        raise ValueError("out: the array is read-only")
    return out


def _unshared(array, out):
    """The array, or a copy of it where writing to `out` would change it."""
    # a keyword would cost half as much again as the check
    return array.copy() if np.may_share_memory(array, out, 10_000) else array
