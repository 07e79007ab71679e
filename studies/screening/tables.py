"""A screening as rows of results.csv, and as text for a terminal."""

import math
from collections.abc import Mapping
from pathlib import Path

from studies.point import Value
from studies.results import Column
from studies.screening.answers import Influence, Tolerances
from studies.screening.changes import Change
from studies.screening.found import One, Screening
from studies.screening.timing import Cost
from studies.text_table import text_table

COLUMNS = (
    Column("kind", "", "one: a single change; pair: two at once; recommended: the set as a whole"),
    Column("change", "", "an effect switched over, or a fidelity key with its level"),
    Column("with", "", "what had to change too, by the declared needs"),
    Column("status", "", "held, not held or refused"),
    Column("message", "", "why it was refused or crashed"),
    Column("exercised", "", "why the change had no occasion to act; empty where it had one"),
    Column("worst", "", "change of the worst latency or load, relative to it"),
    Column("p99", "", "change of the latency of 99 % of the frames, relative to it"),
    Column("misses", "", "change of the share of frames that are late or skipped"),
    Column("force", "", "largest difference of a frame's force, of the run's largest force"),
    Column("force_rms", "", "rms over the frames of that difference, of the largest force"),
    Column("displacement", "", "of the largest strain, and of the tip's way in a closed loop"),
    Column("accuracy", "", "difference of the errors against the true model"),
    Column("stability", "", "of the stiffness that the loop holds and of its port's energy"),
    Column("flags", "", "flags that came (+) and went (-)"),
    Column("lost", "", "answers that the run does not give any more"),
    Column("unshared_frames", "", "frames that only one of both runs has: not compared"),
    Column("address", "", "of the run's record in the store"),
)
RECOMMENDED = "recommended.toml"
TIMING_COLUMNS = ("change", "wall_s", "least_s", "most_s", "simulate_s", "per_simulated_s")
_SHOWN = ("worst", "p99", "misses", "force", "displacement", "accuracy", "stability")
_PER_CENT = 100


def rows(screening: Screening) -> list[dict[str, Value]]:
    """A row a run, in the order of the declarations."""
    found = [
        {"kind": "one"}
        | _what((one.change,), one.change.along)
        | {
            "status": one.record.status,
            "message": one.record.message if not one.record.done else "",
            "exercised": one.idle,
            "address": one.record.address,
        }
        | _figures(one.influence)
        for one in screening.ones
    ]
    found += [
        {"kind": "pair"}
        | _what(pair.changes, ())
        | {
            "status": pair.record.status,
            "message": pair.record.message if not pair.record.done else "",
            "address": pair.record.address,
            "worst": pair.latency,
            "p99": pair.p99,
            "force": pair.force,
        }
        for pair in screening.pairs
    ]
    best = screening.recommendation
    found.append(
        {"kind": "recommended"}
        | _what(best.changes, ())
        | {"status": best.run.record.status, "address": best.run.record.address}
        | _figures(best.influence)
    )
    return found


def screening_text(
    scenario: Path, found: Screening, tolerances: Tolerances, costs: Mapping[str, Cost]
) -> str:
    """The recommendation first, then what it rests on."""
    run = found.exercised
    lines = [
        f"Screening of {scenario}",
        "",
        *recommendation_words(found, tolerances, costs),
        "",
        f"Exercised: {run.words()}.",
    ]
    if run.contact == 0:
        lines.append("No contact: what any change does to force and displacement is not exercised.")
    if run.frames < _PER_CENT:
        lines.append(f"99 % of {run.frames} frames are all but the worst: p99 says little.")
    if found.base.closed:
        lines.append(
            "Closed loop: a change moves the trajectory, so frames of equal number differ by that "
            "too, and by more the longer the run."
        )
    for title, ones in (
        ("Moves an answer", [o for o in found.ones if o.matters(tolerances)]),
        ("Within every tolerance", [o for o in found.ones if _within(o, tolerances)]),
    ):
        if ones:
            lines += ["", f"{title} (shares; wall: time of the run, this machine)", ""]
            lines.append(_table(ones, costs))
    idle = [one for one in found.ones if one.idle]
    if idle:
        lines += ["", "Not exercised (says nothing about their influence)", ""]
        lines += [f"  {one.change.name}: {one.idle}" for one in idle]
    if found.pairs:
        lines += ["", "Pairs: what two do beyond the sum of both (shares)", ""]
        lines.append(
            text_table(
                ("change", "and", "worst", "p99", "force"),
                [
                    (p.changes[0].name, p.changes[1].name, p.latency, p.p99, p.force)
                    for p in found.pairs
                ],
            )
        )
    if found.unpaired:
        lines.append(f"Not paired, as they move less: {', '.join(found.unpaired)}.")
    refused = [one for one in found.ones if not one.record.done]
    if refused or found.choices.untried:
        lines += ["", "Not tried", ""]
        lines += [f"  {name}: {why}" for name, why in found.choices.untried.items()]
        lines += [f"  {one.change.name}: {one.record.message}" for one in refused]
    return "\n".join(lines) + "\n"


def recommendation_words(
    found: Screening, tolerances: Tolerances, costs: Mapping[str, Cost]
) -> list[str]:
    """The answer in words: what can go, what that changes, what it saves."""
    best = found.recommendation
    kept = ", ".join(
        f"{answer} {tolerance:.3g}"
        for answer, tolerance in tolerances.items()
        if tolerance is not None
    )
    if not best.changes:
        words = ["Recommended: the scenario as it is; nothing can be left out within tolerances."]
    else:
        words = [f"Recommended: {', '.join(change.name for change in best.changes)}."]
        i = best.influence
        moved = ", ".join(
            f"{name} {value:.2g}"
            for name, value in (
                ("worst latency", i.latency),
                ("p99", i.p99),
                ("misses", i.misses),
                ("force", i.force),
                ("displacement", i.displacement),
                ("accuracy", i.accuracy),
                ("stability", i.stability),
            )
            if value is not None
        )
        words.append(f"Run as a whole, from {RECOMMENDED}, it differs by: {moved} (shares).")
        if i.lost:
            words.append(f"It no longer answers: {', '.join(i.lost)}, which was not asked for.")
    words.append(f"Tolerances: {kept}.")
    if "scenario" in costs and "recommended" in costs and best.changes:
        a, b = costs["scenario"], costs["recommended"]
        words.append(
            f"Measured on this machine: {a.wall_s:.3g} s ({a.least_s:.3g} to {a.most_s:.3g}) "
            f"before, {b.wall_s:.3g} s ({b.least_s:.3g} to {b.most_s:.3g}) after, "
            f"{a.wall_s / b.wall_s:.2f} times as fast; median of {min(a.repeats, b.repeats)}."
        )
    words += [f"Stays: {name}: {why}." for name, why in best.rejected.items()]
    return words


def timing_csv(costs: Mapping[str, Cost]) -> str:
    """Wall-clock times, apart from the results, whose bytes do not depend on the machine."""
    lines = [",".join(TIMING_COLUMNS)]
    lines += [
        ",".join(
            [
                f'"{name}"',
                *(
                    f"{value:.6g}"
                    for value in (c.wall_s, c.least_s, c.most_s, c.simulate_s, c.per_simulated_s)
                ),
            ]
        )
        for name, c in costs.items()
    ]
    return "\n".join(lines) + "\n"


def _within(one: One, tolerances: Tolerances) -> bool:
    return one.record.done and not one.matters(tolerances) and not one.idle


def _table(ones: list[One], costs: Mapping[str, Cost]) -> str:
    table = []
    for one in ones:
        figures = _figures(one.influence)
        cost = costs.get(one.change.name)
        along = f" (with {', '.join(c.name for c in one.change.along)})" if one.change.along else ""
        notes = " ".join(
            [
                *([one.influence.verdict] if one.influence and one.influence.verdict else []),
                *([str(figures["flags"])] if figures.get("flags") else []),
                *([f"loses {figures['lost']}"] if figures.get("lost") else []),
                *(["no frame differs"] if one.influence and one.influence.same_frames else []),
            ]
        )
        table.append(
            (
                one.change.name + along,
                *(figures.get(name) for name in _SHOWN),
                cost.wall_s if cost else None,
                notes,
            )
        )
    return text_table(("change", *_SHOWN, "wall [s]", ""), table)


def _what(changes: tuple[Change, ...], along: tuple[Change, ...]) -> dict[str, Value]:
    return {
        "change": " + ".join(change.name for change in changes),
        "with": " + ".join(change.name for change in along),
    }


def _figures(found: Influence | None) -> dict[str, Value]:
    if found is None:
        return {}
    return {
        "worst": _finite(found.latency),
        "p99": _finite(found.p99),
        "misses": _finite(found.misses),
        "force": _finite(found.force),
        "force_rms": _finite(found.force_rms),
        "displacement": _finite(found.displacement),
        "accuracy": _finite(found.accuracy),
        "stability": _finite(found.stability),
        "flags": " ".join(found.flags),
        "lost": " ".join(found.lost),
        "unshared_frames": found.unshared,
    }


def _finite(value: float | None) -> float | None:
    """Nothing where there was nothing before that a change could be measured by."""
    return value if value is not None and math.isfinite(value) else None
