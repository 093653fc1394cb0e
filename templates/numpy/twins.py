def _in_a_row(twin):
    """A scalar twin that gives its numbers in one list."""
    return lambda *given: _numbers(twin(*given))


def _numbers(value):
    if type(value) is not tuple:
        return [value]
    return [number for part in value for number in _numbers(part)]
