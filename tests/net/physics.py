"""Laws of loads and matter. A power of two changes no digit of a binary number, so that most of
them are exact to the last bit, on the board's words too; where one is not, its tolerance has its
reason."""

import math
import random
import re
from collections.abc import Iterator
from pathlib import Path

from deformation_step import array
from laws import Law, glides
from run_files import Frame, Run
from scenario import Scenario, vector


def times(value: str, factor: float) -> str:
    """Each number of the value."""

    def scaled(found: re.Match[str]) -> str:
        return repr(float(found[0]) * factor)

    return re.sub(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?=[ \"\],]|$)", scaled, value)


def scaled(scenario: Scenario, factors: dict[str, tuple[float, str]]) -> Scenario:
    """Each of the keys times its factor; one that is not there gets its default times that."""
    changed = scenario.copy()
    for name, (factor, default) in factors.items():
        value = changed.values.get(name, default)
        if value:
            changed.values[name] = times(value, factor)
    return changed


def in_lists(scenario: Scenario, factors: dict[str, float]) -> None:
    for listed, items in scenario.lists.items():
        for item in items:
            for name in item:
                factor = factors.get(f"{listed}.{name}")
                if factor is not None:
                    item[name] = times(item[name], factor)


def tables_of(scenario: Scenario) -> set[str]:
    return {name.rpartition(".")[0] for name in scenario.values} | scenario.effects


def of_the_port(
    scenario: Scenario, stiffness: float, damping: float
) -> dict[str, tuple[float, str]]:
    """What the host has between body and device, where the scenario names it."""
    factors: dict[str, tuple[float, str]] = {}
    there = tables_of(scenario)
    if "host.virtual_coupling" in there:
        factors["host.virtual_coupling.stiffness"] = (stiffness, '"800 N/m"')
        factors["host.virtual_coupling.damping"] = (damping, '"5 N s/m"')
        factors["host.virtual_coupling.expected_stiffness"] = (stiffness, "")
    if "host.passivity" in there:
        factors["host.passivity.largest_damping"] = (damping, '"20 N s/m"')
        factors["host.passivity.largest_force"] = (stiffness, '"8.5 N"')
    return factors


# Twice would do, but for solver.matrix_scaling, which takes the root of the diagonal.
STIFFER = 4


def stiffer(_: random.Random, scenario: Scenario, __: Run) -> Scenario | None:
    """As many times E, density and all loads: the same motion under as many times the forces. A
    diagonal of one has no unit and does not grow."""
    if scenario.values.get("contact.diagonal") == '"one"':
        return None
    # After a proxy's force, refinement ends where nobody feels what is left, in newtons.
    if glides(scenario) and "refinement" in tables_of(scenario):
        return None
    factors = {
        "object.material.young_modulus": (STIFFER, '"10 kPa"'),
        "object.material.density": (STIFFER, '"1000 kg/m3"'),
        "contact.release_force": (STIFFER, ""),
    }
    changed = scaled(scenario, factors | of_the_port(scenario, STIFFER, STIFFER))
    listed = ("loads.point.force", "loads.pressure.pressure")
    of_regions = ("object.region.young_modulus", "object.region.density")
    in_lists(changed, dict.fromkeys(listed + of_regions, STIFFER))
    return changed


def of_a_force(column: str) -> bool:
    return column.endswith(("_N", "_J"))


def as_many_times_the_force(before: Run, after: Run) -> Iterator[str]:
    """To the last bit, and all else the same."""
    one, other = before.rows, after.rows
    if len(one) != len(other):
        yield f"frames.csv has {len(one)} lines, then {len(other)}"
    for a, b in zip(one, other, strict=False):
        for column, old in a.items():
            new = b[column]
            if of_a_force(column) and old:
                if STIFFER * float(old) != float(new):
                    yield f"frame {a['frame']}: {column} of {old} became {new}, not {STIFFER} times"
                    return
            elif old != new:
                yield f"frame {a['frame']}: {column} of {old} became {new}"
                return


# On the host the solution is exact to rounding, and none of these tables belongs to it.
HOST = ("host.solver",)
OF_THE_BOARD = ("accelerator", "transfer", "refinement", "fault", "bus.pcie", "solver")
RENEWED = "object.model.matrix"  # of the board's words


def is_linear(scenario: Scenario) -> bool:
    if "object.model" not in scenario.effects:
        return True
    relaxes = bool(scenario.lists.get("object.model.prony"))
    return scenario.values.get("object.model.kind") == '"linear"' and not relaxes


def on_the_host(_: random.Random, scenario: Scenario) -> Scenario:
    changed = scenario.copy()
    for name in (*OF_THE_BOARD, "fidelity.accelerator", "fidelity.numbers", "output.waveform"):
        # A body that is not linear is solved by increments, whoever solves.
        if name != "refinement" or is_linear(scenario):
            changed.take_out(name)
    changed.take_out(RENEWED)
    changed.values["host.solver"] = '"cholesky"'
    return changed


LENGTHS = (
    "object.mesh.size",
    "object.mesh.radius",
    "object.mesh.surface_unit",
    "contact.patch_radius",
    "probe.start",
)
PLACED = (
    "object.anchor.",
    "object.region.",
    "loads.pressure.region.",
    "loads.prescribed.region.",
    "loads.point.",
    "loads.prescribed.",
)
PLACES = ("position", "displacement", "point", "low_corner", "high_corner", "centre", "radius")


def twice_as_large(_: random.Random, scenario: Scenario, __: Run) -> Scenario:
    """Twice all lengths at the same E: four times the force. A quarter of the density keeps the
    time in which the body swings; its weight then needs twice the gravity."""
    factors = dict.fromkeys(LENGTHS, (2.0, ""))
    factors["object.material.density"] = (1 / 4, '"1000 kg/m3"')
    factors["contact.release_force"] = (4, "")
    factors["probe.radius"] = (2, '"3 mm"')
    factors |= of_the_port(scenario, 2, 2)
    if "host.passivity" in tables_of(scenario):
        factors["host.passivity.largest_force"] = (4, '"8.5 N"')
    if "loads.gravity" in scenario.effects:
        standard = '["0 m/s2", "0 m/s2", "-9.80665 m/s2"]'
        factors["loads.gravity.acceleration"] = (2, standard)
    if "device.encoder" in scenario.effects:
        factors["device.encoder.resolution"] = (2, '"55 um"')
    changed = scaled(scenario, factors)
    lengths = {prefix + name: 2.0 for prefix in PLACED for name in PLACES}
    lengths["object.region.density"] = 1 / 4
    in_lists(changed, lengths | {"probe.motion.to": 2, "loads.point.force": 4})
    return changed


# The tip is read in whole nanometres, of at least 0.2 mm of a press; in a dynamic body what is
# rounded off it shakes the held nodes.
STATIC_REL = 1e-4
DYNAMIC_REL = 1e-2
# Where a body is not linear a frame has more passes while they change what can be felt, which does
# not grow with the body.
NONLINEAR_REL = 0.1


def largest(frames: list[Frame]) -> float:
    return max((math.hypot(*frame.force) for frame in frames if frame.force), default=0.0)


def four_times_the_force(before: Run, after: Run) -> Iterator[str]:
    scale = 4 * largest(before.frames)
    tolerance = DYNAMIC_REL if "dynamics" in before.settings else STATIC_REL
    if "model" in before.settings["object"]:
        tolerance = NONLINEAR_REL
    for old, new in zip(before.frames, after.frames, strict=False):
        if old.contact_node != new.contact_node:
            yield f"frame {old.number}: contact {old.contact_node} became {new.contact_node}"
            return
        if old.force is None or new.force is None:
            continue
        off = math.dist([4 * f for f in old.force], new.force)
        if off > tolerance * scale:
            yield f"frame {old.number}: {old.force} N became {new.force} N, not four times that"
            return


# Nothing touches: what the loads alone do.


def untouched(rng: random.Random, scenario: Scenario) -> Scenario:
    """The probe stays away, and there are loads."""
    changed = scenario.copy()
    away = vector((0.0, 0.0, 1.0))
    changed.values["probe.start"] = away
    hold = {"phase": '"hold"', "to": away, "duration": '"1 s"'}
    changed.lists["probe.motion"] = [hold]
    changed.values["output.deformation_every_frames"] = "20"
    down = tuple(round(rng.uniform(-5, 5), 4) for _ in range(3))
    changed.values["loads.gravity.acceleration"] = vector(down, "acceleration")
    changed.effects.add("loads.gravity")
    if changed.values.get("fidelity.numbers") == '"none"':
        changed.take_out("fidelity.numbers")
    # Loads the other way are displacements the other way for a linear body alone.
    for name in ("object.model", "object.model.prony"):
        changed.take_out(name)
    # What wraps or starts somewhere else by what it has seen is not the same both ways.
    changed.take_out("solver.overflow")
    changed.take_out("fault")
    return changed


def opposite_loads(_: random.Random, scenario: Scenario, __: Run) -> Scenario:
    changed = scaled(scenario, {"loads.gravity.acceleration": (-1, "")})
    keys = ("loads.point.force", "loads.pressure.pressure", "loads.prescribed.displacement")
    in_lists(changed, dict.fromkeys(keys, -1.0))
    return changed


def steps(run: Run) -> list[Path]:
    return sorted(run.folder.glob("deformation_*.vtu"))


def opposite_displacement(before: Run, after: Run) -> Iterator[str]:
    """To the last bit: words have a sign and a magnitude as far as rounding goes. Where the search
    for a contact takes longer one way, a slow host drops other frames."""
    if [frame.born for frame in before.frames] != [frame.born for frame in after.frames]:
        return
    for one, other in zip(steps(before), steps(after), strict=True):
        pairs = zip(array(one, "displacement"), array(other, "displacement"), strict=True)
        for at, (a, b) in enumerate(pairs):
            if a != -b:
                yield f"{one.name}: component {at % 3} of node {at // 3}, {a} m, became {b} m"
                return


LOADS_AND_MATTER = (
    Law("stiffness", stiffer, as_many_times_the_force),
    Law("lengths", twice_as_large, four_times_the_force, prepare=on_the_host, keeps=HOST),
    Law("opposite", opposite_loads, opposite_displacement, prepare=untouched),
)
