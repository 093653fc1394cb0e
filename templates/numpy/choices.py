def _where(condition, then, otherwise):
    """np.where(condition, then(), otherwise), which few orientations need: a count costs a tenth."""
    chosen = np.count_nonzero(condition)
    if chosen == 0:
        return otherwise
    return (
        then() if chosen == condition.size else np.where(condition, then(), otherwise)
    )
