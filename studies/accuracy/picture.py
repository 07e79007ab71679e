"""Draws error over modelled time: every state a marker, resources as colour, the Pareto front."""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, ScalarFormatter

from studies.accuracy.answer import short
from studies.accuracy.design import ERROR, FORCE_ERROR, Design, front
from studies.whole_file import write_whole

_MARKERS = {"fits": "o", "late": "^", "beyond budget": "v", "breaks down": "X", "does not fit": "s"}
_DPI = 110


def draw(
    path: Path,
    title: str,
    designs: Sequence[Design],
    shares: Sequence[float | None],
    budget_us: float,
) -> None:
    """Two panels, displacement and force. `shares` is the device's fullest resource by design."""
    style: Any = {"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}
    with mpl.rc_context(style):
        figure = Figure(figsize=(10, 5), layout="constrained")
        known = [share for share in shares if share is not None] or [0.0, 1.0]
        scale = mpl.colors.Normalize(min(known), max(known))
        for axis, error, what in zip(
            figure.subplots(1, 2, sharex=True),
            (ERROR, FORCE_ERROR),
            ("displacement", "contact force"),
            strict=True,
        ):
            for state, marker in _MARKERS.items():
                for filled in (True, False):
                    chosen = [
                        (d.time_us, d.error(error), share)
                        for d, share in zip(designs, shares, strict=True)
                        if d.state == state
                        and d.error(error)
                        and d.time_us is not None
                        and (share is not None) == filled
                    ]
                    if chosen:
                        look: dict[str, Any] = (
                            {"c": [c[2] for c in chosen], "cmap": "viridis", "norm": scale}
                            if filled
                            else {"facecolors": "none"}
                        )
                        axis.scatter(
                            [(c[0] or 0) / 1000 for c in chosen],
                            [c[1] for c in chosen],
                            marker=marker,
                            s=34,
                            label=state,
                            edgecolors="#333333",
                            linewidths=0.6,
                            **look,
                        )
            best = front(designs, error)
            axis.step(
                [(d.time_us or 0) / 1000 for d in best],
                [d.error(error) for d in best],
                where="post",
                color="#D55E00",
                linewidth=1.2,
                label="Pareto front: fits, in time",
            )
            own = designs[0]
            if own.time_us is not None and own.error(error):
                axis.scatter(
                    [own.time_us / 1000],
                    [own.error(error)],
                    marker="*",
                    s=200,
                    facecolors="none",
                    edgecolors="black",
                    linewidths=1.3,
                    label="the scenario's own",
                )
            axis.axvline(budget_us / 1000, color="black", linestyle="--", label="budget")
            axis.set_xscale("log")
            axis.set_yscale("log")
            axis.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axis.xaxis.set_major_formatter(ScalarFormatter())
            axis.xaxis.set_minor_formatter(NullFormatter())
            axis.yaxis.set_major_formatter(FuncFormatter(lambda error, _: short(error)))
            axis.set_xlabel("worst latency of a frame [ms]")
            axis.set_title(
                f"error of a frame's own {what}, 95 % of those in contact, against the true model",
                fontsize=9,
            )
            axis.grid(color="#E4E4E4")
            axis.set_axisbelow(True)
        handles, labels = figure.axes[0].get_legend_handles_labels()
        unique = dict(zip(labels, handles, strict=True))
        figure.legend(unique.values(), unique.keys(), loc="outside lower center", ncols=4)
        bar = mpl.cm.ScalarMappable(norm=scale, cmap="viridis")
        figure.colorbar(bar, ax=figure.axes, label="fullest kind of resource, share of the device")
        figure.suptitle(title)
        data = io.BytesIO()
        figure.savefig(data, format="png", dpi=_DPI, metadata={"Software": None})
    write_whole(path, data.getvalue())
