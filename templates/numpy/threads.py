def _check_threads(threads):
    if type(threads) is not int or threads < 1:
        raise ValueError(f"threads: got {threads!r}; expected a whole number from 1 up")


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
