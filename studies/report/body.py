"""The surface of a run's body at some of its steps, as a page draws it in three dimensions."""

import base64
import re
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from studies.report.vtu import read_vtu

# Of the displacements in a page, bytes before base64. More steps than fit are thinned out.
MOST_BYTES = 1_000_000
_STEP = re.compile(r"deformation_(\d+)\.vtu")
# The faces of a tetrahedron, each opposite a corner, seen from outside counterclockwise.
_FACES = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])
_WANTED = {"displacement", "time_s", "frame", "probe_position_m", "contact_force_N"}


def boundary(tetrahedra: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """The triangles that one tetrahedron alone has, in the order of the mesh."""
    faces = tetrahedra[:, _FACES].reshape(-1, 3)
    _, first, count = np.unique(
        np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
    )
    outer: npt.NDArray[Any] = faces[np.sort(first[count == 1])]
    return outer


def read_body(run: Path, worst_frame: int | None) -> dict[str, Any] | None:
    """What a page needs of the steps; None where the run has none. Throws InputError.

    The step that is shown first is the one of the largest contact force.
    """
    steps = sorted(path for path in run.glob("deformation_*.vtu") if _STEP.fullmatch(path.name))
    if not steps:
        return None
    mesh = read_vtu(steps[0], {"Points", "connectivity"})
    triangles = boundary(mesh["connectivity"].reshape(-1, 4))
    nodes, faces = np.unique(triangles, return_inverse=True)
    most = max(1, MOST_BYTES // (len(nodes) * 12))
    if len(steps) > most:
        steps = [steps[round(at)] for at in np.linspace(0, len(steps) - 1, most)]
    read = [read_vtu(step, _WANTED) for step in steps]
    moved = np.stack([step["displacement"][nodes] for step in read]).astype("<f4")
    forces = [float(np.linalg.norm(step["contact_force_N"])) for step in read]
    largest = np.linalg.norm(moved, axis=2).max(axis=1)
    labels = [
        f"frame {int(step['frame'][0])}, {step['time_s'][0]:.4g} s: displaced by up to"
        f" {far * 1e3:.3g} mm, {force:.3g} N on the probe"
        for step, force, far in zip(read, forces, largest, strict=True)
    ]
    return {
        "rest": _packed(mesh["Points"][nodes].astype("<f4")),
        "moved": _packed(moved),
        "faces": _packed(faces.astype("<u4")),
        "probe": [[float(part) for part in step["probe_position_m"].flat][:3] for step in read],
        "labels": labels,
        "shown": int(np.argmax(forces)),
        "nodes": len(nodes),
        "triangles": len(triangles),
        "worst_frame": worst_frame,
        "figure": _figure(float(largest.max()) * 1e3),
    }


def _figure(largest_mm: float) -> dict[str, Any]:
    body = {
        "type": "mesh3d",
        "cmin": 0,
        "cmax": largest_mm or 1,
        "colorscale": "Viridis",
        "reversescale": True,
        "flatshading": True,
        "colorbar": {"title": {"text": "displacement / mm"}, "len": 0.8},
        "name": "body",
        "hovertemplate": "%{x:.3g}, %{y:.3g}, %{z:.3g} mm<extra></extra>",
    }
    probe = {
        "type": "scatter3d",
        "mode": "markers",
        "marker": {"size": 6, "color": "bad"},
        "name": "probe",
    }
    axes = {
        f"{axis}axis": {"title": {"text": f"{axis} / mm"}, "showbackground": False}
        for axis in "xyz"
    }
    scene = {"aspectmode": "data", "camera": {"eye": {"x": 1.3, "y": 1.3, "z": 0.7}}} | axes
    layout = {"scene": scene, "margin": {"l": 0, "r": 0, "t": 0, "b": 0}, "uirevision": "kept"}
    return {"id": "body-plot", "data": [body, probe], "layout": layout}


def _packed(array: npt.NDArray[Any]) -> str:
    return base64.b64encode(array.tobytes()).decode("ascii")
