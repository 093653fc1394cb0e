def _longest(block, dtype, shape):
    """The number of orientations of a block: all that is alive at one time fits a cache."""
    held = block.__code__.co_nlocals + prod(shape)
    return max(min(_LONGEST, _CACHE // held) // dtype.itemsize, _SHORTEST)


def _columns(array):
    """The components of an array, each contiguous: a copy unless they are."""
    columns = np.moveaxis(array, -1, 0) if array.ndim > 2 else array.T
    is_ready = columns.strides[-1] == columns.itemsize
    return columns if is_ready else np.array(columns, order="C")


def _quiet():
    """A way to call functions without warnings: a context costs less than np.errstate."""
    if int(np.__version__.split(".")[0]) > 1:
        from contextvars import copy_context

        context = copy_context()
        context.run(np.seterr, all="ignore")
        return lambda function, *arguments: context.copy().run(function, *arguments)
    return np.errstate(all="ignore")(lambda function, *arguments: function(*arguments))


_quietly = _quiet()


def _compute(result, leading, block, arrays, shape, threads):
    """Fill the result by one call of the block, or by many."""
    count = prod(leading)
    if count <= _SHORTEST or count <= _longest(block, result.dtype, shape):
        vectors = [_columns(array) for array in arrays]
        _quietly(_evaluate, result, block, vectors, shape)
    else:
        _fill(result, block, arrays, shape, threads)


def _place(result, values, shape):
    """Write entries to where they belong."""
    if len(shape) == 2 and result.flags.c_contiguous:
        result = result.reshape(*result.shape[:-2], prod(shape))
        for k, value in enumerate(values):
            result[..., k] = value
    else:
        for entry, value in zip(np.ndindex(shape), values):
            result[(..., *entry)] = value


def _fill(result, block, arrays, shape, threads):
    """Go through the leading axes of all arrays together, a cacheful at a time.

    NumPy holds no lock while it works on a block, so that threads share them.
    """
    leading = result.shape[: result.ndim - len(shape)]
    # a block may be written before the next one is read
    wide = [_unshared(array, result) for array in arrays]
    for k, array in enumerate(wide):
        if array.ndim > 1:  # one row for all stays one, and what depends on it a number
            wide[k] = np.broadcast_to(array, (*leading, array.shape[-1]))
    longest = _longest(block, result.dtype, shape) // _LANES * _LANES
    if threads > 1:  # longer blocks, as many for each: they wait less for one another
        rounds = -(-prod(leading) // (4 * longest * threads))
        longest = max(longest, -(-prod(leading) // (rounds * threads)))

    def work(places):
        with np.errstate(all="ignore"):
            for place in places:
                vectors = [_columns(a if a.ndim == 1 else a[place]) for a in wide]
                _evaluate(result[place], block, vectors, shape)

    places = list(_places(leading, longest))
    if threads == 1:
        work(places)
    else:
        # Freed at once; from then on the GNU C library keeps what threads free.
        np.empty(1 << 23, np.uint8)
        _share(lambda place: work([place]), places, threads)


def _places(shape, longest):
    """Where the blocks are: indices into the leading axes, at most `longest` points each.

    Blocks are equally long, so that none is short enough for another way to compute, and
    begin with a whole vector.
    """
    first, row = shape[0], prod(shape[1:])
    if row > longest:
        for k in range(first):
            for place in _places(shape[1:], longest):
                yield (k, *place)
    else:
        blocks, unit = -(-first // (longest // row)), _LANES if row == 1 else 1
        edges = [k * first // blocks // unit * unit for k in range(blocks)]
        for start, end in zip(edges, [*edges[1:], first]):
            yield (slice(start, end),)
