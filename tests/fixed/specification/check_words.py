"""Holds the solver against its specification in Python, word for word.

check_words.py SOLVER_WORDS KIND: the program that writes what the solver makes of random
input, and which input: `systems`, whose every word, scalar, count, flag and norm has to agree after
every iteration, or single rules where they decide: `bounds`, `inverses`, `quotients`.
"""

import json
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import fields
from typing import Any

from spec_matrix import Matrix, Preconditioner
from spec_solver import Iteration, Solver
from spec_words import Coefficient, Counts, Scalar, Settings

Json = dict[str, Any]


def settings_of(given: Json, matrix: Matrix) -> Settings:
    named = {f.name: given[f.name] for f in fields(Settings)}
    if given["static_scale"] == "matrix-norm":
        named["static_shift"] = matrix.static_shift()
    return Settings(**named)


def empty_solver(given: Json) -> Solver:
    matrix = Matrix([0], [], [])
    return Solver(Settings(**{f.name: given[f.name] for f in fields(Settings)}), matrix)


def parted(what: str, mine: object, given: object) -> str:
    return "" if mine == given else f"{what}: {mine} and {given}"


def coefficient_parted(what: str, mine: Coefficient, given: list[int]) -> str:
    """The exponent of zero says nothing."""
    if mine.mantissa == given[0] == 0:
        return ""
    return parted(what, [mine.mantissa, mine.exponent], given)


def iteration_difference(mine: Iteration, given: Json) -> str:
    found = [
        f"{name}, word {at}: {one} and {other}"
        for name, words in mine.vectors.items()
        for at, (one, other) in enumerate(zip(words, given[name], strict=True))
        if one != other
    ]
    found += [
        coefficient_parted("alpha", mine.alpha, given["alpha"]),
        parted("d_q", str(mine.d_q), given["d_q"]),
        parted("z_r", str(mine.z_r), given["z_r"]),
        coefficient_parted("beta", mine.beta, given["beta"]),
        parted("residual_exponent", mine.residual_exponent, given["residual_exponent"]),
        parted("direction_exponent", mine.direction_exponent, given["direction_exponent"]),
    ]
    return next(filter(None, found), "")


def report_difference(counts: Counts, norms: dict[str, float], given: Json) -> str:
    mine = {f.name: getattr(counts, f.name) for f in fields(Counts)} | norms
    mine["flags"] = sorted(counts.flags)
    expected = given | {"flags": sorted(given["flags"])}
    return next(filter(None, (parted(name, mine[name], expected[name]) for name in expected)), "")


def system(given: Json, seen: Counter[str]) -> str:
    matrix = Matrix(given["row_begin"], given["column"], given["value"])
    settings = settings_of(given["settings"], matrix)
    if settings.static_shift != given["settings"]["static_shift"]:
        return parted("m", settings.static_shift, given["settings"]["static_shift"])
    for contact in given["contacts"]:
        (matrix.set_contact if contact["set"] else matrix.restore)(contact["node"])
    solver = Solver(settings, matrix)
    history, norms = solver.solve(given["b"], given["guess"])
    seen[settings.method] += len(history)
    seen.update(solver.counts.flags)
    seen["restored" if any(not c["set"] for c in given["contacts"]) else "not restored"] += 1
    for number, (mine, other) in enumerate(zip(history, given["iterations"], strict=False), 1):
        where = iteration_difference(mine, other)
        if where:
            return f"iteration {number}, {where}"
    return (
        parted("iterations", len(history), len(given["iterations"]))
        or parted("x", solver.x, given["x"])
        or report_difference(solver.counts, norms, given["report"])
    )


def bound(given: Json, seen: Counter[str]) -> str:
    solver = empty_solver(given["settings"])
    terms = [(size, exponent) for size, exponent in given["terms"]]
    mine = solver.rescaling(terms, given["bits"], given["target"], given["available"])
    seen["up" if mine > 0 else "down" if mine < 0 else "as it is"] += 1
    return parted("shift", mine, given["shift"])


def inverse(given: Json, seen: Counter[str]) -> str:
    flags: set[str] = set()
    settings = empty_solver(given["settings"]).s
    mine = Preconditioner(settings, Matrix([0, 1], [0], given["block"]), flags)
    words = [word for row in mine.words[0] for word in row]
    seen.update(flags or {"definite"})
    return (
        parted("words", words, given["words"])
        or parted("shift", mine.w, given["shift"])
        or parted("flags", sorted(flags), sorted(given["flags"]))
    )


def quotient(given: Json, seen: Counter[str]) -> str:
    solver = empty_solver(given["settings"])
    n, d = Scalar(int(given["numerator"]), 0), Scalar(int(given["denominator"]), 0)
    mine = solver.quotient(n, d, solver.s.alpha_fraction_bits)
    shifted = solver.shifted_scalar(int(given["scalar"]), given["exponent"])
    counts = solver.counts
    seen[solver.s.coefficient_format] += 1
    seen["clamped or wrapped"] += counts.saturations + counts.wraps
    seen.update(counts.flags)
    return (
        coefficient_parted("coefficient", mine, given["coefficient"])
        or parted("shifted scalar", str(shifted), given["shifted"])
        or parted("saturations", counts.saturations, given["saturations"])
        or parted("wraps", counts.wraps, given["wraps"])
        or parted("flags", sorted(counts.flags), given["flags"])
    )


# How many of each, and what has to have come up so often among them for the comparison to count.
Judge = Callable[[Json, Counter[str]], str]
KINDS: dict[str, tuple[Judge, int, dict[str, int]]] = {
    "systems": (
        system,
        2000,
        {
            "cg": 1000,
            "jacobi-pcg": 1000,
            "block-jacobi-pcg": 1000,
            "chronopoulos-gear": 1000,
            "pipelined-cg": 1000,
            "restored": 50,
            "saturation": 100,
            "wrapped": 100,
            "negative-curvature": 100,
            "zero-diagonal": 50,
            "stagnation": 100,
            "divergence": 100,
            "scalar-overflow": 10,
        },
    ),
    "bounds": (bound, 20000, {"up": 1000, "down": 1000, "as it is": 1000}),
    "inverses": (
        inverse,
        5000,
        {"definite": 1000, "zero-diagonal": 100, "negative-curvature": 100},
    ),
    "quotients": (
        quotient,
        10000,
        {"own-shift": 1000, "fixed": 1000, "clamped or wrapped": 100, "scalar-overflow": 100},
    ),
}


def main() -> int:
    program, kind = sys.argv[1:]
    judge, count, expected = KINDS[kind]
    out = subprocess.run([program, kind, str(count)], check=True, capture_output=True, text=True)
    seen: Counter[str] = Counter()
    failed = 0
    lines = out.stdout.splitlines()
    for number, line in enumerate(lines):
        given = json.loads(line)
        where = judge(given, seen)
        if where:
            failed += 1
            print(f"{kind} {number}: {where} (the page's, the solver's)\n  {given['settings']}")
    print(f"{len(lines)} {kind}, {failed} differ; {dict(seen)}")
    thin = {what: seen[what] for what, least in expected.items() if seen[what] < least}
    if thin:
        print(f"too few to tell: {thin}")
    return 1 if failed or thin or len(lines) != count else 0


if __name__ == "__main__":
    sys.exit(main())
