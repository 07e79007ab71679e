"""Displacements on two meshes of one body, and how far they are apart."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from studies.report.vtu import read_vtu

Array = npt.NDArray[Any]
_CORNERS = 4
_AT_ONCE = 100  # points, so that some ten thousand elements take tens of megabytes


@dataclass(frozen=True)
class Field:
    """Nodes of the body at rest, elements by their nodes, and the nodes' displacements."""

    points: Array
    elements: Array
    displacements: Array

    @staticmethod
    def read(path: Path) -> "Field":
        """A step that a run wrote. Throws InputError."""
        arrays = read_vtu(path, {"Points", "connectivity", "displacement"})
        elements = arrays["connectivity"].reshape(-1, _CORNERS)
        return Field(arrays["Points"], elements, arrays["displacement"])

    @property
    def centres(self) -> Array:
        """Of the elements."""
        return np.asarray(self.points[self.elements].mean(axis=1))

    @property
    def volumes(self) -> Array:
        """Of the elements."""
        return np.asarray(np.abs(np.linalg.det(self._edges)) / 6)

    @property
    def _edges(self) -> Array:
        corners = self.points[self.elements]
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
            values = self.displacements[self.elements[best]]
            found[start : start + _AT_ONCE] = np.einsum("ij,ijk->ik", all_four, values)
        return found


def difference(own: Field, finer: Field) -> float:
    """|u - v| over |v| in the body of the first, by its elements' centres and volumes."""
    there = finer.at(own.centres)
    here = own.displacements[own.elements].mean(axis=1)
    volumes = own.volumes[:, None]
    apart = float((volumes * (here - there) ** 2).sum())
    size = float((volumes * there**2).sum())
    return float(np.sqrt(apart / size)) if size else 0.0
