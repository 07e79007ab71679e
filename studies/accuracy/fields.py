"""Displacements on two meshes of one body, and how far they are apart."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from studies.report.vtu import read_vtu

Array = npt.NDArray[Any]
_CORNERS = 4
# The ends of the edges in whose middles a quadratic tetrahedron has its other nodes (VTK's order).
_EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
_AT_ONCE = 100  # points, so that some ten thousand elements take tens of megabytes


@dataclass(frozen=True)
class Field:
    """Nodes of the body at rest, elements by their four or ten nodes, and the nodes'
    displacements. Elements have straight sides."""

    points: Array
    elements: Array
    displacements: Array

    @staticmethod
    def read(path: Path) -> "Field":
        """A step that a run wrote. Throws InputError."""
        arrays = read_vtu(path, {"Points", "connectivity", "offsets", "displacement"})
        nodes_each = arrays["offsets"].reshape(-1)[0]
        elements = arrays["connectivity"].reshape(-1, nodes_each)
        return Field(arrays["Points"], elements, arrays["displacement"])

    @property
    def centres(self) -> Array:
        """Of the elements."""
        return np.asarray(self.points[self._corners].mean(axis=1))

    @property
    def volumes(self) -> Array:
        """Of the elements."""
        return np.asarray(np.abs(np.linalg.det(self._edges)) / 6)

    @property
    def at_centres(self) -> Array:
        """Displacements at the elements' centres."""
        centre = np.full((len(self.elements), _CORNERS), 1 / _CORNERS)
        return self._interpolated(self.elements, centre)

    @property
    def _corners(self) -> Array:
        return np.asarray(self.elements[:, :_CORNERS])

    def _interpolated(self, elements: Array, barycentric: Array) -> Array:
        """At a place in each of these elements."""
        shape = barycentric
        if elements.shape[1] > _CORNERS:
            corners = barycentric * (2 * barycentric - 1)
            middles = [4 * barycentric[:, a] * barycentric[:, b] for a, b in _EDGES]
            shape = np.concatenate([corners, np.stack(middles, axis=1)], axis=1)
        return np.asarray(np.einsum("ij,ijk->ik", shape, self.displacements[elements]))

    @property
    def _edges(self) -> Array:
        corners = self.points[self._corners]
        return np.asarray(corners[:, 1:] - corners[:, :1])

    def at(self, places: Array) -> Array:
        """Displacements there: of the element that holds the place, or that it is least outside
        of, as two meshes' surfaces differ."""
        inverse = np.linalg.inv(self._edges)
        first = self.points[self.elements[:, 0]]
        found = np.empty_like(places)
        for start in range(0, len(places), _AT_ONCE):
            chunk = places[start : start + _AT_ONCE]
            offsets = chunk[:, None, :] - first[None, :, :]
            weights = np.matmul(offsets[:, :, None, :], inverse[None])[:, :, 0, :]
            inside = np.minimum(weights.min(axis=2), 1 - weights.sum(axis=2))
            best = inside.argmax(axis=1)
            chosen = weights[np.arange(len(chunk)), best]
            all_four = np.concatenate([1 - chosen.sum(axis=1, keepdims=True), chosen], axis=1)
            found[start : start + _AT_ONCE] = self._interpolated(self.elements[best], all_four)
        return found


def difference(own: Field, finer: Field) -> float:
    """|u - v| over |v| in the body of the first, by its elements' centres and volumes."""
    there = finer.at(own.centres)
    here = own.at_centres
    volumes = own.volumes[:, None]
    apart = float((volumes * (here - there) ** 2).sum())
    size = float((volumes * there**2).sum())
    return float(np.sqrt(apart / size)) if size else 0.0
