def _in_order(name, value, xp):
    """The argument with its columns in the order of the components, if they have names.

    Names may come from a table, a mapping, a structured array, named tuples, or the last
    axis of an array of xarray.
    """
    row = value
    while type(row) in (list, tuple) and row:
        row = row[0]
    if type(row) in (float, int):
        return value
    names = _names_of(row)
    if not any(isinstance(each, (str, tuple)) for each in names):
        return value
    components = _COMPONENTS[name]
    if any(names.count(component) != 1 for component in components):
        raise ValueError(
            f"{name}: the columns are named {', '.join(map(str, names))}; expected each of "
            f"{', '.join(components)} once, in any order, or an array without names"
        )
    is_labelled = hasattr(value, "dims") and not hasattr(value, "keys")
    if is_labelled or isinstance(value, (list, tuple)):
        order = xp.asarray([names.index(component) for component in components])
        return xp.asarray(value)[..., order]
    columns = [xp.asarray(value[component]) for component in components]
    return xp.stack(xp.broadcast_arrays(*columns), axis=-1)


def _names_of(value):
    """The names along the last axis; none if it has only positions."""
    for attribute in ("_fields", "column_names", "keys", "columns"):
        names = getattr(value, attribute, None)
        if names is not None:
            return list(names() if callable(names) else names)
    if getattr(value, "dims", None) and value.dims[-1] in value.coords:
        return value.coords[value.dims[-1]].values.tolist()
    return list(getattr(getattr(value, "dtype", None), "names", None) or ())
