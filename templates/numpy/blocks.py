def _longest(block, dtype, shape):
    """The number of orientations of a block: all that is alive at one time fits a cache."""
    held = block.__code__.co_nlocals + prod(shape)
    return max(min(_LONGEST, _CACHE // held) // dtype.itemsize, _SHORTEST)


def _columns(array, dtype):
    """The components of an array, each a contiguous copy in the given type."""
    if array.ndim < 3:
        return np.array(array.T, dtype, order="C")
    axes = (array.ndim - 1, *range(array.ndim - 1))
    return np.array(array.transpose(axes), dtype, order="C")


def _quiet():
    """A way to call functions without warnings: a context costs less than np.errstate."""
    if int(np.__version__.split(".")[0]) > 1:
        from contextvars import copy_context

        context = copy_context()
        context.run(np.seterr, all="ignore")
        return lambda function, *arguments: context.copy().run(function, *arguments)
    return np.errstate(all="ignore")(lambda function, *arguments: function(*arguments))


_quietly = _quiet()


def _compute(result, leading, block, arrays, shape, out, threads):
    """Fill the result by one call of the block, or by many."""
    count = prod(leading)
    if count <= _SHORTEST or count <= _longest(block, result.dtype, shape):
        vectors = [_columns(array, result.dtype) for array in arrays]
        _quietly(_evaluate, result, block, vectors, shape, False)
    else:
        inputs = [_unshared(array, out) for array in arrays]
        _fill(result, block, inputs, shape, threads)


def _place(result, values, shape, is_even):
    """Write entries to where they belong; they are arrays of one length each if all is even."""
    if len(shape) == 2 and result.flags.c_contiguous:
        result, shape = result.reshape(*result.shape[:-2], prod(shape)), shape[:1]
    if len(shape) == 1 and is_even and float not in map(type, values):
        result.T[...] = values
    elif len(shape) == 1:
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
    wide = [np.broadcast_to(a, (*leading, a.shape[-1])) for a in arrays]
    longest = _longest(block, result.dtype, shape)
    if threads > 1:  # longer blocks, as many for each: they wait less for one another
        rounds = -(-prod(leading) // (4 * longest * threads))
        longest = max(longest, -(-prod(leading) // (rounds * threads)))

    def work(places):
        with np.errstate(all="ignore"):
            for place in places:
                vectors = [_columns(array[place], result.dtype) for array in wide]
                _evaluate(result[place], block, vectors, shape, False)

    places = list(_places(leading, longest))
    if threads == 1:
        work(places)
    else:
        # Freed at once; from then on the GNU C library keeps what threads free.
        np.empty(1 << 23, np.uint8)
        _share(lambda place: work([place]), places, threads)


def _share(work, pieces, threads):
    """Do `work` on all pieces; threads, this one among them, take the next as they get free."""
    from collections import deque
    from concurrent.futures import wait
    from contextlib import suppress

    left = deque(pieces)

    def take():
        while left:
            try:
                piece = left.popleft()
            except IndexError:  # another took the last
                return
            try:
                work(piece)
            except BaseException:  # an interrupt too: nothing more is begun
                left.clear()
                raise

    others = []
    with suppress(RuntimeError):  # none are to be had while the interpreter ends
        for _ in range(min(threads, len(left)) - 1):
            others.append(_pool().submit(take))
    try:
        take()
    finally:  # nobody writes after the call is over
        others = [other for other in others if not other.cancel()]
        wait(others)
    for other in others:
        other.result()


_POOLS: dict[int, object] = {}


def _pool():
    """Threads that wait for work, which costs less than new ones; a forked process starts anew."""
    import os

    if os.getpid() not in _POOLS:
        from concurrent.futures import ThreadPoolExecutor

        _POOLS.setdefault(os.getpid(), ThreadPoolExecutor(os.cpu_count()))
    return _POOLS[os.getpid()]


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
