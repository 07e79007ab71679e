"""Tissue models and who solves them: the families whose error is held against their cost.

A family is a law with a solver, and whether its matrix is renewed. Its members differ in what
accuracy is bought with: passes and iterations, words, how often is renewed, substeps.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product

from studies.accuracy.grid import ITERATIONS, MATRIX_BITS, METHOD, PASSES, VECTOR_BITS
from studies.point import Value

KIND = "object.model.kind"
SOLVER = "host.solver"
SUBSTEPS = "host.substeps"
RENEW = "object.model.matrix.renew_every"
SETTINGS = (PASSES, METHOD, ITERATIONS, MATRIX_BITS, VECTOR_BITS, RENEW, SUBSTEPS)

LINEAR = "linear"
SPRINGS = "mass-spring"
# Those whose forces are formed by elements, in the order of what they cure.
LAWS = (
    "corotational",
    "st-venant-kirchhoff",
    "neo-hookean-log",
    "neo-hookean-isochoric",
    "fung",
)
SOLVERS = ("board", "cholesky", "cg", "explicit")
_PASSES = (1, 2, 3)
_ITERATIONS = (8, 15, 30)
_NARROW = (12, 16)  # bits of the matrix and of the vectors: the thesis' own
_WIDE = (16, 20)
_RENEWALS = (10, 50)  # frames


@dataclass(frozen=True)
class Member:
    """One run's choice. `columns` are its settings; what does not apply to it is left out."""

    law: str
    solver: str
    columns: Mapping[str, Value]

    @property
    def way(self) -> str:
        """Who solves, and whether with a matrix that is renewed."""
        return f"{self.solver}, renewed" if self.columns.get(RENEW) else self.solver

    @property
    def family(self) -> str:
        """The law, who solves, and whether it is solved once a frame."""
        if self.solver == "explicit":
            return f"{self.law}, explicit steps"
        refined = self.columns.get(PASSES) or self.law != LINEAR
        once = "" if refined else ", one solve"
        host = "" if self.solver == "board" else "host "
        return f"{self.law}, {host}{self.way}{once}"

    @property
    def overrides(self) -> tuple[str, ...]:
        """For `--set`, whatever the scenario's own law and solver are."""
        linear = self.law == LINEAR and self.solver != "explicit"
        chosen = [
            "object.model=false" if linear else f"{KIND}={self.law}",
            f"{SOLVER}={self.solver}",
        ]
        if not self.columns.get(PASSES):
            chosen.append("refinement=false")
        # Zero is the program's own number of substeps, and no pass is no refinement.
        return (*chosen, *(f"{key}={value}" for key, value in self.columns.items() if value))


def members(small: bool) -> list[Member]:
    """All that are tried. `small` has a few of each kind of solver, to see that all goes well."""
    return list(_small() if small else _all())


def _small() -> Iterator[Member]:
    yield _linear("cg", 60, _NARROW)
    for law, passes in product((LINEAR, "corotational", "neo-hookean-log"), (1, 2)):
        yield _refined(law, passes, 15, _NARROW)
    yield Member("neo-hookean-log", "cholesky", {PASSES: 2})
    yield Member("neo-hookean-log", "explicit", {SUBSTEPS: 0})
    yield Member(SPRINGS, "explicit", {SUBSTEPS: 0})


def _all() -> Iterator[Member]:
    for words in (_NARROW, _WIDE):
        yield from (_linear("cg", iterations, words) for iterations in (30, 60, 120))
        yield from (_linear("jacobi-pcg", iterations, words) for iterations in (15, 30))
    for law in (LINEAR, *LAWS):
        for passes, iterations in product(_PASSES, _ITERATIONS):
            yield _refined(law, passes, iterations, _NARROW)
        for passes, iterations in ((2, 15), (3, 30)):
            yield _refined(law, passes, iterations, _WIDE)
    # The host refines increments of a law alone: a linear body it solves at once.
    yield Member(LINEAR, "cholesky", {})
    for iterations in (15, 30, 60):
        yield Member(LINEAR, "cg", {METHOD: "jacobi-pcg", ITERATIONS: iterations})
    for law, passes in product(LAWS, _PASSES):
        yield Member(law, "cholesky", {PASSES: passes})
        yield Member(law, "cg", {PASSES: passes, METHOD: "jacobi-pcg", ITERATIONS: 15})
    for law, frames in product(LAWS, _RENEWALS):
        for passes in (1, 2):
            yield _refined(law, passes, 15, _NARROW, renewed={RENEW: frames})
        yield Member(law, "cholesky", {PASSES: 1, RENEW: frames})
    for law, substeps in product((LINEAR, *LAWS, SPRINGS), (0, 8, 16)):
        yield Member(law, "explicit", {SUBSTEPS: substeps})


def _linear(method: str, iterations: int, words: tuple[int, int]) -> Member:
    return Member(LINEAR, "board", _board(method, iterations, words))


def _refined(
    law: str,
    passes: int,
    iterations: int,
    words: tuple[int, int],
    renewed: Mapping[str, Value] | None = None,
) -> Member:
    columns = {PASSES: passes, **_board("jacobi-pcg", iterations, words), **(renewed or {})}
    return Member(law, "board", columns)


def _board(method: str, iterations: int, words: tuple[int, int]) -> dict[str, Value]:
    return {
        METHOD: method,
        ITERATIONS: iterations,
        MATRIX_BITS: words[0],
        VECTOR_BITS: words[1],
    }
