"""Draws errors of tissue models over frame time: a line a family, a row of panels a scene."""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, ScalarFormatter

from studies.accuracy.answer import short
from studies.accuracy.families import LAWS, LINEAR, SPRINGS
from studies.accuracy.measured import Measured, front
from studies.accuracy.mesh_error import MeshError
from studies.plot import COLOURS
from studies.whole_file import write_whole

# People tell forces apart that differ by so much: Pang, Tan, Durlach, Perception & Psychophysics
# 49(6), 1991, for a pinch between two fingers.
NOTICEABLE = (0.07, 0.10)
NORM = "p95"  # as a scenario's budget.force_error is judged

_COLOUR = dict(zip((LINEAR, *LAWS, SPRINGS), COLOURS, strict=True))
_Dash = Literal["-", "--", "-.", ":"] | tuple[int, tuple[float, ...]]
_LOOK: dict[str, tuple[str, _Dash]] = {
    "board": ("o", "-"),
    "board, renewed": ("P", (0, (6, 1, 1, 1))),
    "cholesky": ("s", "--"),
    "cholesky, renewed": ("X", (0, (2, 1))),
    "cg": ("D", "-."),
    "explicit": ("^", ":"),
}
_DPI = 110
_ROW_IN = 3.6


def draw(
    path: Path,
    scenes: Sequence[tuple[str, Sequence[Measured], MeshError]],
    period_us: float,
) -> None:
    """Two panels a scene, displacement and force; the mesh's own error and what can be noticed are
    bands. Equal arguments make equal bytes."""
    style: Any = {"font.size": 9, "axes.spines.top": False, "axes.spines.right": False}
    with mpl.rc_context(style):
        size = (11, 1.6 + _ROW_IN * len(scenes))
        figure = Figure(figsize=size, layout="constrained")
        panels = figure.subplots(len(scenes), 2, sharex=True, squeeze=False)
        for row, (name, measured, mesh) in zip(panels, scenes, strict=True):
            for axis, what in zip(row, ("displacement", "force"), strict=True):
                _curves(axis, measured, f"{what}_{NORM}")
                _axes(axis, f"{name}: {what}", period_us)
                if what == "force":
                    axis.axhspan(*NOTICEABLE, color="#E69F00", alpha=0.35, linewidth=0)
                _mesh(axis, mesh, what)
        for axis in panels[-1]:
            axis.set_xlabel("worst latency of a frame [ms]")
        figure.legend(handles=_handles(scenes), loc="outside lower center", ncols=4, frameon=False)
        figure.suptitle(
            "What accuracy costs, across models: error within which 95 % of the frames in contact "
            "are, against the true law on the same mesh"
        )
        data = io.BytesIO()
        figure.savefig(data, format="png", dpi=_DPI, metadata={"Software": None})
    write_whole(path, data.getvalue())


def _curves(axis: Axes, measured: Sequence[Measured], norm: str) -> None:
    families: dict[str, list[Measured]] = {}
    for one in measured:
        families.setdefault(one.member.family, []).append(one)
    for of in families.values():
        member = of[0].member
        marker, line = _LOOK[member.way]
        colour = _COLOUR[member.law]
        known = [m for m in of if m.drawn and m.error(norm) and m.worst_us]
        for filled in (True, False):
            # Hollow: not on this board in this time.
            chosen = [m for m in known if (m.state == "fits") == filled]
            axis.scatter(
                [(m.worst_us or 0) / 1000 for m in chosen],
                [m.error(norm) or 0.0 for m in chosen],
                marker=marker,
                s=16,
                facecolors=colour if filled else "none",
                edgecolors=colour,
                linewidths=0.7,
                alpha=0.7,
            )
        best = front(of, norm)
        axis.plot(
            [(m.worst_us or 0) / 1000 for m in best],
            [m.error(norm) or 0.0 for m in best],
            color=colour,
            linestyle=line,
            linewidth=1.2,
        )


def _mesh(axis: Axes, mesh: MeshError, what: str) -> None:
    if what == "force" and mesh.band is not None:
        # Its lower end may be zero, which a logarithmic axis does not have.
        low = max(mesh.band[0], axis.get_ylim()[0])
        axis.axhspan(low, mesh.band[1], facecolor="none", edgecolor="#D4D4D4", hatch="//", lw=0)
        axis.axhline(mesh.band[1], color="#999999", linewidth=3, alpha=0.7)
    elif what == "displacement" and mesh.displacement:
        axis.axhline(mesh.displacement, color="#999999", linewidth=3, alpha=0.7)


def _axes(axis: Axes, title: str, period_us: float) -> None:
    axis.axvline(period_us / 1000, color="black", linestyle="--", linewidth=0.8)
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.xaxis.set_major_formatter(ScalarFormatter())
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.yaxis.set_major_formatter(FuncFormatter(lambda error, _: short(error)))
    axis.set_title(title, fontsize=9)
    axis.grid(color="#E4E4E4")
    axis.set_axisbelow(True)


def _handles(scenes: Sequence[tuple[str, Sequence[Measured], MeshError]]) -> list[Any]:
    present = [m.member for _, measured, _ in scenes for m in measured]
    laws = [law for law in _COLOUR if any(member.law == law for member in present)]
    ways = [way for way in _LOOK if any(m.way == way for m in present)]
    return [
        *(Line2D([], [], color=_COLOUR[law], linewidth=3, label=law) for law in laws),
        *(
            Line2D([], [], color="black", marker=_LOOK[s][0], linestyle=_LOOK[s][1], label=_who(s))
            for s in ways
        ),
        Line2D([], [], color="black", linestyle="--", linewidth=0.8, label="period"),
        Line2D(
            [], [], color="black", marker="o", markerfacecolor="none", linestyle="",
            label="hollow: late, or does not fit",
        ),
        Patch(color="#E69F00", alpha=0.35, label="just noticeable force, 7 to 10 %"),
        Patch(facecolor="none", edgecolor="#BBBBBB", hatch="//", label="the mesh's own error"),
    ]  # fmt: skip


def _who(way: str) -> str:
    if way.startswith("board"):
        return way
    return "host, explicit steps" if way == "explicit" else f"host, {way}"
