"""The board against the host's own solver, in double precision."""

import math
import random
from collections.abc import Iterator

from deformation_step import array
from laws import Law
from physics import on_the_host, steps
from run_files import Run
from scenario import Scenario

GOOD_WORDS = 2 / 3  # the share of scenarios whose words and iterations are enough


def compared_with_the_host(rng: random.Random, scenario: Scenario) -> Scenario:
    """Static, and nothing takes time but the converters, so that both see the same tips."""
    changed = scenario.copy()
    for name in ("dynamics", "fault", "host", "bus", "fidelity", "transfer", "accelerator.several"):
        changed.take_out(name)
    # A capability is the board's, and the truth is that of a linear body.
    for name in ("function", "object.model", "object.model.prony", "reference.model"):
        changed.take_out(name)
    for part in ("accelerator", "bus", "host"):
        changed.values[f"fidelity.{part}"] = '"untimed"'
    for name in ("host.graphics.rate", "host.graphics.drawing_time"):
        if name in scenario.values:
            changed.values[name] = scenario.values[name]
    if rng.random() < GOOD_WORDS:
        changed.take_out("solver")
        changed.take_out("refinement")
        changed.values["solver.method"] = rng.choice(('"cg"', '"jacobi-pcg"'))
        changed.values["solver.vector_bits"] = str(rng.randint(18, 28))
        changed.values["solver.matrix_bits"] = str(rng.randint(14, 24))
        changed.values["solver.matrix_scaling"] = '"diagonal"'
        changed.values["accelerator.device"] = '"AGI027"'
    changed.effects.add("reference")
    changed.values["reference.every_frames"] = "1"
    changed.values["output.deformation_every_frames"] = "1"
    return changed


def solved_by_the_host(rng: random.Random, scenario: Scenario, _: Run) -> Scenario:
    return on_the_host(rng, scenario)


# The two do the same sums in another order.
REPORT_REL = 1e-6
REPORT_ABS = 1e-12


def distances(pairs: list[tuple[tuple[float, ...], tuple[float, ...]]]) -> tuple[float, float]:
    """Mean and worst of the distance from the second, as `accuracy` counts them: over what is not
    zero, relative to the largest."""
    scale = max((math.hypot(*exact) for _, exact in pairs), default=0.0)
    off = [math.dist(found, exact) for found, exact in pairs if any(found) or any(exact)]
    if not off or scale == 0:
        return 0.0, 0.0
    return sum(off) / len(off) / scale, max(off) / scale


def agrees_with_the_report(before: Run, after: Run) -> Iterator[str]:
    """What the run says of its own error is its distance from the host's solution. That is exact
    as long as no contact begins on a body that is displaced already: the place that it then takes
    hangs on what the board had found until there, and each such contact adds as much again. Nodes
    with a prescribed displacement are in the files and, removed from the system, not in the error:
    they are part of the largest displacement, by which the distance is divided."""
    pairs = list(zip(before.frames, after.frames, strict=True))
    if any((old.contact_node, old.tip) != (new.contact_node, new.tip) for old, new in pairs):
        return
    accuracy, flags = before.summary["accuracy"], before.summary["stability"]["flags"]
    changes = before.summary["contact"]["changes"]
    both = list(zip(steps(before), steps(after), strict=True))
    u = [(array(old, "displacement"), array(new, "displacement")) for old, new in both]
    forces = [(old.force or (), new.force or ()) for old, new in pairs]
    untouched_until = next((f.number for f in before.frames if f.contact_node >= 0), len(u))
    loaded = any(any(found) for found, _ in u[:untouched_until])
    prescribed = bool(before.settings["loads"]["prescribed"])
    said = {
        name: (accuracy[f"{name}_rel"] or 0.0, accuracy[f"{name}_worst_rel"] or 0.0)
        for name in ("displacement", "force")
    }
    room = (1 + changes) * (said["displacement"][1] + said["force"][1])
    for name, found in (("displacement", distances(u)), ("force", distances(forces))):
        for what, reported, distance in zip(("mean", "worst"), said[name], found, strict=True):
            exact = changes <= 1 and (changes == 0 or not loaded) and not prescribed
            off = abs(distance - reported) > REPORT_REL * distance + REPORT_ABS
            if (exact and off) or (not exact and not flags and distance > room + REPORT_ABS):
                yield f"{what} error of the {name}: reported {reported}, from the host {distance}"


AGAINST_THE_HOST = Law(
    "host",
    solved_by_the_host,
    agrees_with_the_report,
    prepare=compared_with_the_host,
    keeps=("fidelity.accelerator", "fidelity.bus", "fidelity.host"),
)
