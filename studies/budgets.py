"""The budgets that a run's figures are held against, by name: pictures draw them as a line."""

from collections.abc import Iterable

from studies.point import Value

LATENCY = "deadline.budget_us"
_PERIOD = "deadline.period_us"
_BUDGETS = {
    "load.worst_us": _PERIOD,
    "accuracy.force_of_frame.p95": "error_budget.force.limit_rel",
    "accuracy.displacement_of_frame.p95": "error_budget.displacement.limit_rel",
    **dict.fromkeys(
        (
            "deadline.worst_us",
            "deadline.p50_us",
            "deadline.p99_us",
            "deadline.p999_us",
            "latency.best_us",
            "latency.mean_us",
        ),
        LATENCY,
    ),
}


def budget_of(metric: str) -> str | None:
    """The figure that has a metric's budget; none where it has none."""
    if metric.startswith("latency.percentiles."):
        return LATENCY
    return _BUDGETS.get(metric)


def one_value(values: Iterable[Value]) -> float | None:
    """The number that all have that have one; none where there are several, or nobody has any."""
    found = set(values) - {None}
    value = found.pop() if len(found) == 1 else None
    return float(value) if isinstance(value, int | float) else None
