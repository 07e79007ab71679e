"""Runs every hard case of the plant (tables/plant_cases/), as it is and with each of its remedies.

Whatever comes of it is a number; energy adds up, and does not come from nowhere without a flag; a
device that does not come to rest has one; and a remedy is named by a flag's text and leaves what
the case says.
"""

import argparse
import json
import math
import re
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).resolve().parents[2] / "tables" / "plant_cases"))
from cases import GROUPS
from loop_run import LoopRun, run
from plant_case import ACTIVE, CYCLE, Case

IMBALANCE = 1e-9
# Of models/plant/loop_quality.cpp.
LEAST_J = 1e-6
LEAST_SHARE = 1e-3


def numbers_of(value: Any) -> Iterator[float]:
    if isinstance(value, dict):
        for item in value.values():
            yield from numbers_of(item)
    elif isinstance(value, list):
        for item in value:
            yield from numbers_of(item)
    elif isinstance(value, float):
        yield value


def is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return text.startswith("HVP_") or text == ""


def energy_faults(loop: dict[str, Any], flags: list[str]) -> Iterator[str]:
    energy = loop["energy"]
    if not abs(energy["imbalance_rel"]) < IMBALANCE:
        yield f"energy does not add up: {energy['imbalance_rel']:g} of what was moved"
    # More than was moved: springs and kinetic energy are in the works that made them.
    most = 2 * sum(abs(e) for part in ("in_J", "lost_J") for e in energy[part].values())
    least = energy["port"]["least_J"]
    if -least > max(LEAST_J, LEAST_SHARE * most) and ACTIVE not in flags:
        yield f"{-least:g} J from nowhere, and no {ACTIVE}"
    if -least <= LEAST_J and ACTIVE in flags and len(flags) == 1:
        yield f"{ACTIVE} for {-least:g} J"


def faults(result: LoopRun) -> Iterator[str]:
    """What no run may have."""
    if not all(math.isfinite(number) for number in numbers_of(result.summary)):
        yield "summary.json: not a number, or infinite"
    for frame in result.frames:
        wrong = [f"{key} = {cell}" for key, cell in frame.items() if not is_number(cell)]
        if wrong:
            yield f"frames.csv, frame {frame['frame']}: {wrong[0]}"
            break
    for loop in result.loops:
        yield from energy_faults(loop, result.flags)
        if (loop["oscillation"] is not None) != (CYCLE in result.flags) and len(result.loops) == 1:
            yield f"{CYCLE} and loop.oscillation contradict each other"
    if not result.flags and not result.rests:
        yield f"{result.ending()}, and no flag"
    if not result.flags and result.moves_in_the_end():
        yield "its positions do not come to rest, and no flag"


def named(remedy: str, said: str) -> bool:
    """Whether the program names this key, or one above it, beside a flag."""
    key = re.sub(r"\[\d+\]", "", remedy.partition("=")[0])
    texts = " ".join(re.findall(r"remedy: (.*)", said))
    spoken = {
        "wall.stiffness": "softer wall" if "softer wall" in texts else key,
        "wall.sides": "motion inside the device's workspace",
        "probe.motion.to": "shallower motion",
        "device.encoder.counts_per_turn": "device.encoder",
        "device.encoder.resolution": "device.encoder",
        "device.friction.force": "device.friction",
        "device.amplifier.bandwidth": "device.amplifier",
        "device.amplifier.current_limit": "larger device",
        "host.delay.time": "host.delay",
        "frames": "",  # so that the time stays
    }.get(key, key)
    return spoken in texts


def check(case: Case, program: Path) -> Iterator[str]:
    first = run(program, case.settings)
    if case.refused or first.refusal:
        if not case.refused or "expected" not in first.refusal:
            yield f"refused: {first.refusal}"
        return
    yield from faults(first)
    if set(first.flags) != case.flags:
        yield f"flags {first.flags}, expected {sorted(case.flags)}"
    helped = not case.remedies
    for remedy in case.remedies:
        result = run(program, (*case.settings, *remedy.settings))
        name = f"with {', '.join(remedy.settings)}: "
        if result.refusal:
            yield name + result.refusal
            continue
        yield from (name + fault for fault in faults(result))
        if set(result.flags) != remedy.left:
            yield name + f"flags {result.flags}, expected {sorted(remedy.left)}"
        helped = helped or (not result.flags and result.rests)
        for setting in remedy.settings:
            if not named(setting, first.said):
                yield name + "no flag's text names that"
    if not helped:
        yield "no remedy leaves it without flags and at rest"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", type=Path, help="hvp")
    program = parser.parse_args().program.resolve()
    cases = [case for group in GROUPS.values() for case in group]
    with ThreadPoolExecutor(2) as pool:
        results = list(pool.map(lambda case: list(check(case, program)), cases))
    wrong = 0
    for case, found in zip(cases, results, strict=True):
        for fault in found:
            print(f"{case.name}: {fault}")
        wrong += bool(found)
    print(json.dumps({"cases": len(cases), "wrong": wrong}))
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
