def _exceptional(block, shape, *vectors):
    """One orientation where Python's floats raise an error and arrays give inf or NaN."""
    points = [np.array(vector, np.float64)[:, np.newaxis] for vector in vectors]
    with np.errstate(all="ignore"):
        values = block(*points)
    return _nested([float(np.ravel(value)[0]) for value in values], shape)


def _nested(values, shape):
    """Numbers in the tuples of a shape."""
    for length in reversed(shape[1:]):
        values = tuple(zip(*[iter(values)] * length))
    return tuple(values) if shape else values[0]


def _sin_cos(*angles):
    """Sines of angles in radians, then their cosines, within 1.1 eps.

    In double precision both follow from one tangent t of half the angle, as 2t/(1 + t²)
    and (1 - t²)/(1 + t²). The sine keeps its relative accuracy at multiples of pi. For
    few angles and in single precision NumPy's own sin and cos are the fastest.
    """
    size, count = angles[0].size, len(angles)
    if size * count < _FEW or angles[0].dtype is _SINGLE:
        if count == 2:  # without a list, a fiftieth of ten orientations less
            a, b = angles
            return _SINE(a), _SINE(b), _COSINE(a), _COSINE(b)
        values = []  # appending costs half of what map does
        for angle in angles:
            values.append(_SINE(angle))
        for angle in angles:
            values.append(_COSINE(angle))
        return values
    if count == 1:
        return _by_tangent(angles[0])
    if size < _MANY:  # one array of all angles saves calls
        sines, cosines = _by_tangent(np.array(angles))
    else:
        sines, cosines = zip(*map(_by_tangent, angles))
    return *sines, *cosines


def _by_tangent(angle):
    """Sine and cosine from the tangent of half the angle."""
    t = np.multiply(_HALF, angle)
    np.tan(t, out=t)
    cosine = t * t
    scale = _ONE + cosine
    np.subtract(_ONE, cosine, out=cosine)
    t += t
    t /= scale
    cosine /= scale
    return t, cosine


def _sin(angle):
    """The sine alone, as in `_sin_cos`."""
    if not _IS_WIDE or angle.size < _FEW or angle.dtype is _SINGLE:
        return np.sin(angle)
    t = np.tan(_HALF * angle)
    return (t + t) / (_ONE + t * t)


def _cos(angle):
    """The cosine alone, as in `_sin_cos`."""
    if not _IS_WIDE or angle.size < _FEW or angle.dtype is _SINGLE:
        return np.cos(angle)
    t = np.tan(_HALF * angle)
    square = t * t
    return (_ONE - square) / (_ONE + square)


def _sharp(cosine, angle):
    """The cosine for a divisor: within 5 eps of its own size, however small, by np.cos."""
    if angle.dtype is _SINGLE or angle.size < _FEW:
        return cosine
    return np.cos(angle, out=cosine, where=np.abs(cosine) < 0.25)
