"""Coordinates that are continuous along a trajectory.

`rigidsym` writes the functions that a module needs behind its kernels. Samples are on the first
axis; a sample that is not finite is passed over and comes as NaN.
"""

import numpy as np


def _unwrapped_quaternion(q):
    """Of each quaternion and its negative the one nearer to the sample before."""
    samples, lost = _samples(q)
    return _with_gaps(samples * _signs(samples)[..., np.newaxis], lost)


def _unwrapped_axis_angle(q):
    """Axis and angle, the axis without a turn of more than a quarter from sample to sample."""
    samples, lost = _samples(q)
    axis, angle = samples[..., :3], samples[..., 3]
    axis = _filled(axis, (angle == 0.0)[..., np.newaxis])
    signs = _signs(axis)
    angle = signs * angle
    angle = angle + _whole_turns(angle)
    parts = (axis * signs[..., np.newaxis], angle[..., np.newaxis])
    return _with_gaps(np.concatenate(parts, axis=-1), lost)


def _unwrapped_rotation_vector(q):
    """Rotation vectors, whose length goes on beyond half a turn."""
    samples, lost = _samples(q)
    length = np.sqrt((samples * samples).sum(axis=-1))
    none = length == 0.0
    axis = samples / np.where(none, 1.0, length)[..., np.newaxis]
    axis = _filled(axis, none[..., np.newaxis])
    signs = _signs(axis)
    turns = _whole_turns(signs * length)
    return _with_gaps(samples + axis * (signs * turns)[..., np.newaxis], lost)


def _unwrapped_modified_rodrigues(q):
    """Of each set and its shadow the one whose quaternion is nearer to that before."""
    samples, lost = _samples(q)
    square = (samples * samples).sum(axis=-1, keepdims=True)
    quaternion = np.concatenate((1.0 - square, 2.0 * samples), axis=-1) / (1.0 + square)
    is_shadow = _signs(quaternion)[..., np.newaxis] < 0.0
    divisor = np.where(square == 0.0, np.nan, square)
    return _with_gaps(np.where(is_shadow, -samples / divisor, samples), lost)


def _unwrapped_euler(q, quarters):
    """Euler angles in the nearer of the two sets of each rotation.

    The middle angle is 0 or half a turn at the poles if the outer axes are the same
    (`quarters` = 0), and a quarter turn, up or down, if they differ (±1). At the pole that is
    `quarters` quarter turns, the rotation determines only the sum of the outer angles, and at
    the other one only their difference.
    """
    samples, lost = _samples(q)
    first, middle, third = np.moveaxis(samples, -1, 0)
    pole = 0.5 * np.pi * quarters
    limit = 16.0 * np.finfo(samples.dtype).eps
    bent = 0.5 * (middle - pole)
    is_low, is_high = np.abs(np.sin(bent)) < limit, np.abs(np.cos(bent)) < limit
    is_pole = is_low | is_high
    total, difference = _filled(first + third, is_high), _filled(first - third, is_low)
    first = np.where(is_pole, 0.5 * (total + difference), first)
    third = np.where(is_pole, 0.5 * (total - difference), third)
    angles = np.stack((first, middle, third))
    # Away from poles these are all sets but for whole turns; at a pole they are the same up to
    # half a turn of both outer angles, which half the sum or the difference leaves undecided.
    other = np.stack((first - np.pi, 2.0 * pole - middle, third - np.pi))
    angles = np.where(_is_other(angles, other), other, angles)
    angles = np.stack([angle + _whole_turns(angle) for angle in angles], axis=-1)
    return _with_gaps(angles.astype(samples.dtype), lost)


def _is_other(given, other):
    """Where the shorter way leads to the other set, from sample to sample."""
    count = np.arange(given.shape[1]).reshape(-1, *[1] * (given.ndim - 2))
    none = np.zeros(given.shape[1:], bool)
    there = _after(none, _way(given, other) < _way(given, given))
    back = _after(none, _way(other, given) < _way(other, other))
    # If only one of the two changes the set, a step ends in one set wherever it began.
    last = np.maximum.accumulate(np.where(there ^ back, count, 0), axis=0)
    changes = np.cumsum(there & back, axis=0)
    since = changes - np.take_along_axis(changes, last, axis=0)
    return np.take_along_axis(there, last, axis=0) ^ (since % 2 == 1)


def _way(start, end):
    """The square of the way to the next sample, each angle the shorter way round."""
    steps = end[:, 1:] - start[:, :-1]
    return ((steps - 2.0 * np.pi * np.round(steps / (2.0 * np.pi))) ** 2).sum(axis=0)


def _samples(q):
    """The samples as floats, their gaps filled, and where the gaps are."""
    if q.ndim < 2:
        raise ValueError(f"q: got shape {q.shape}; expected (m, ..., n)")
    array = q if q.dtype.char == "f" else q.astype(np.float64)
    lost = ~np.isfinite(array).all(axis=-1)
    return _filled(array, lost[..., np.newaxis]), lost


def _filled(values, gap):
    """The values, in a gap those before it on the first axis, at the start those after."""
    if not gap.any():
        return values
    gap = np.broadcast_to(gap, values.shape)
    count = np.arange(len(values)).reshape(-1, *[1] * (values.ndim - 1))
    place = np.maximum.accumulate(np.where(gap, -1, count), axis=0)
    place = np.where(place < 0, np.argmin(gap, axis=0), place)
    return np.take_along_axis(values, place, axis=0)


def _after(first, others):
    """What holds for the first sample, and for the others."""
    return np.concatenate((first[:1], others), axis=0)


def _whole_turns(angle):
    """What makes steps of an angle along the first axis half a turn at most."""
    turns = np.round(np.diff(angle, axis=0) / (2.0 * np.pi))
    return -2.0 * np.pi * _after(np.zeros_like(angle), np.cumsum(turns, axis=0))


def _signs(vectors):
    """The signs that leave no obtuse angle between a vector and the one before it."""
    turned = (vectors[1:] * vectors[:-1]).sum(axis=-1) < 0.0
    changes = np.cumsum(turned, axis=0) % 2
    ones = np.ones(vectors.shape[:-1], vectors.dtype)
    return _after(ones, (1 - 2 * changes).astype(vectors.dtype))


def _with_gaps(result, lost):
    """The result, NaN where the samples were lost."""
    return np.where(lost[..., np.newaxis], np.nan, result)
