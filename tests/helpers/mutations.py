"""Files with some bytes changed."""

from __future__ import annotations

import numpy as np


def mutated(content: bytes, rng: np.random.Generator) -> bytes:
    """One to four bytes or stretches of a file changed."""
    some = bytearray(content)
    for _ in range(rng.integers(1, 5)):
        at = int(rng.integers(len(some) or 1))
        length = int(rng.integers(1, 20))
        kind = rng.integers(6)
        if kind == 0:
            some[at : at + 1] = rng.bytes(1)
        elif kind == 1:
            del some[at : at + length]
        elif kind == 2:
            some[at:at] = some[at : at + length]
        elif kind == 3:
            some[at : at + length] = rng.bytes(length)
        elif kind == 4:
            del some[at:]
        else:
            words = (b"nan", b"-1", b"1e999", b"99999999999", b"\xff\xfe", b"\0", b"/", b"\n")
            some[at : at + 3] = words[rng.integers(len(words))]
    return bytes(some)
