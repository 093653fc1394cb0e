def _fill(result, block, arrays, shape, threads):
    """Go through the leading axes of all arrays together, a cacheful at a time.

    NumPy holds no lock while it works on a block, so that threads share them.
    """
    leading = result.shape[: result.ndim - len(shape)]
    wide = [np.broadcast_to(a, (*leading, a.shape[-1])) for a in arrays]
    inputs = [np.moveaxis(a, -1, 0) for a in wide]
    outputs = [result[(..., *entry)] for entry in np.ndindex(shape)]
    held = block.__code__.co_nlocals + prod(shape)  # values alive at one time
    longest = min(_LONGEST, _CACHE // held) // result.itemsize
    if threads > 1:  # longer blocks, as many for each: they wait less for one another
        rounds = -(-prod(leading) // (4 * longest * threads))
        longest = max(longest, -(-prod(leading) // (rounds * threads)))

    def apart(array, place):
        return np.array(array[(slice(None), *place)], result.dtype, order="C")

    def work(places):
        with np.errstate(all="ignore"):
            for place in places:
                components = [c for array in inputs for c in apart(array, place)]
                for output, value in zip(outputs, block(*components)):
                    output[place] = value

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


_POOLS = {}


def _pool():
    """Threads that wait for work, which costs less than new ones; a forked process starts anew."""
    import os

    if os.getpid() not in _POOLS:
        from concurrent.futures import ThreadPoolExecutor

        _POOLS.setdefault(os.getpid(), ThreadPoolExecutor(os.cpu_count()))
    return _POOLS[os.getpid()]


def _places(shape, longest):
    """Where the blocks are: indices into the leading axes, at most `longest` points each."""
    first, row = shape[0], prod(shape[1:])
    if row > longest:
        for k in range(first):
            for place in _places(shape[1:], longest):
                yield (k, *place)
    else:
        blocks = -(-first * row // longest)
        step = -(-first // blocks)
        for k in range(0, first, step):
            yield (slice(k, k + step),)
