"""What holds between two runs whatever the scenario: each law changes a scenario and says how the
results have to answer. Powers of two change no digit of a binary number, so that most of the laws
of physics are exact to the last bit, on the board's words too."""

import random
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from drawing import Scenario
from run_files import Run

Change = Callable[[random.Random, Scenario, Run], Scenario | None]
Compare = Callable[[Run, Run], Iterator[str]]

FILES = ("frames.csv", "summary.json", "trace.json")
RANDOM = ("host.jitter", "host.wake_up")


@dataclass(frozen=True)
class Law:
    name: str
    change: Change  # None: the law does not speak of this scenario
    compare: Compare  # the run before, the changed one
    may_be_refused: bool = False  # the changed scenario


def first_difference(name: str, one: str, other: str) -> str:
    lines = zip(one.splitlines(), other.splitlines(), strict=False)
    for number, (a, b) in enumerate(lines, 1):
        if a != b:
            return f"{name}:{number}: {a[:160]} became {b[:160]}"
    return f"{name} has {one.count(chr(10))} lines, then {other.count(chr(10))}"


def same(*names: str) -> Compare:
    def compare(before: Run, after: Run) -> Iterator[str]:
        for name in names:
            one, other = before.text(name), after.text(name)
            if one != other:
                yield first_difference(name, one, other)

    return compare


def setting(scenario: Scenario, **values: str) -> Scenario:
    changed = scenario.copy()
    changed.values |= {name.replace("__", "."): value for name, value in values.items()}
    return changed


# The same scenario, written or looked at in another way.


def in_other_units(_: random.Random, scenario: Scenario, __: Run) -> Scenario:
    """Each plain SI unit becomes a prefixed one: the number moves its point and nothing else."""
    changed = scenario.copy()
    prefixes = {"s": ("us", -6), "m": ("mm", -3), "Pa": ("kPa", 3), "Hz": ("kHz", 3)}
    for name, value in changed.values.items():
        for unit, (prefixed, exponent) in prefixes.items():
            found = re.fullmatch(rf'"(-?\d+(?:\.\d+)?) {unit}"', value)
            if found:
                changed.values[name] = f'"{found[1]}e{-exponent} {prefixed}"'
    return changed


def another_seed(rng: random.Random, scenario: Scenario, _: Run) -> Scenario | None:
    drawn = any(name.startswith(RANDOM) for name in (*scenario.values, *scenario.effects))
    if drawn or "fault" in scenario.lists:
        return None
    return setting(scenario, seed=str(rng.randint(2, 10**9)))


def another_quantum(rng: random.Random, scenario: Scenario, _: Run) -> Scenario:
    return setting(scenario, host__quantum=f'"{rng.choice((1, 17, 400, 5000))} us"')


def fewer_frames(rng: random.Random, scenario: Scenario, _: Run) -> Scenario:
    return setting(scenario, frames=str(rng.randint(1, int(scenario.values["frames"]) - 1)))


def is_beginning(before: Run, after: Run) -> Iterator[str]:
    """What comes later does not change what was. The last frame is left out: with a pipeline its
    force comes without the work of the next one."""
    one, other = before.text("frames.csv").splitlines(), after.text("frames.csv").splitlines()
    whole = len(other) - 1
    if one[:whole] != other[:whole]:
        yield first_difference("frames.csv", "\n".join(one[:whole]), "\n".join(other[:whole]))


def looked_at(rng: random.Random, scenario: Scenario, _: Run) -> Scenario:
    """Other results are asked for."""
    changed = setting(
        scenario,
        output__trace_frames=str(rng.choice((0, 3, 10**6))),
        output__deformation_every_frames=str(rng.choice((0, 7))),
        probe__radius='"1 mm"',
        title='"another"',
    )
    if scenario.values.get("fidelity.numbers") != '"none"':
        changed.effects.add("spectrum")
    changed.take_out("output.trace_size")
    return changed


# Effects whose values are neutral.


def with_neutral_effects(_: random.Random, scenario: Scenario, __: Run) -> Scenario | None:
    """Delays of zero, weights and forces of zero, masters that come after the end."""
    changed = scenario.copy()
    there = {*scenario.values, *scenario.effects}
    if not any(name.startswith("host.jitter") for name in there):
        changed.values |= {
            "host.jitter.distribution": '"constant"',
            "host.jitter.mean": '"0 s"',
        }
    if not any(name.startswith("host.wake_up") for name in there):
        changed.values |= {
            "host.wake_up.distribution": '"constant"',
            "host.wake_up.mean": '"0 s"',
        }
    if scenario.values.get("fidelity.host") == '"untimed"':
        changed.take_out("host.jitter")
        changed.take_out("host.wake_up")
    if not any(name.startswith("loads.gravity") for name in there):
        changed.values["loads.gravity.acceleration"] = '["0 m/s2", "0 m/s2", "0 m/s2"]'
    bus = scenario.values.get("fidelity.bus")
    if bus == '"approximately-timed"' and not any(n.startswith("bus.traffic") for n in there):
        changed.values["bus.traffic.start"] = '"10 s"'
    return changed if changed != scenario else None


# Physics.


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


def twice_as_stiff(_: random.Random, scenario: Scenario, __: Run) -> Scenario | None:
    """Twice E, density and all loads: the same motion under twice the forces. A diagonal of one
    has no unit and does not grow."""
    if scenario.values.get("contact.diagonal") == '"one"':
        return None
    changed = scaled(
        scenario,
        {
            "object.material.young_modulus": (2, '"10 kPa"'),
            "object.material.density": (2, '"1000 kg/m3"'),
            "contact.release_force": (2, ""),
        },
    )
    in_lists(changed, {"loads.point.force": 2, "loads.pressure.pressure": 2})
    return changed


FORCES = slice(11, 15)  # columns of frames.csv


def twice_the_force(before: Run, after: Run) -> Iterator[str]:
    """To the last bit, and all else the same."""
    one = [line.split(",") for line in before.text("frames.csv").splitlines()]
    other = [line.split(",") for line in after.text("frames.csv").splitlines()]
    if len(one) != len(other):
        yield f"frames.csv has {len(one)} lines, then {len(other)}"
    for a, b in zip(one[1:], other[1:], strict=False):
        if a[: FORCES.start] + a[FORCES.stop :] != b[: FORCES.start] + b[FORCES.stop :]:
            yield first_difference("frames.csv", ",".join(a), ",".join(b))
            return
        for old, new in zip(a[FORCES], b[FORCES], strict=True):
            if old and 2 * float(old) != float(new):
                yield f"frame {a[0]}: a force of {old} N became {new} N, not twice that"
                return


# Time.


def more_iterations(rng: random.Random, scenario: Scenario, before: Run) -> Scenario | None:
    if before.summary["accelerator"] is None:
        return None
    now = before.settings["solver"]["iterations"]
    return setting(scenario, solver__iterations=str(now + rng.randint(1, 40)))


def no_shorter(before: Run, after: Run) -> Iterator[str]:
    """The longest solve. One that a residual or a breakdown ends takes no more, either."""
    one, other = (run.summary["accelerator"]["solve_cycles"] for run in (before, after))
    may_end = before.settings["solver"]["stop_residual"] > 0
    may_end |= before.settings["fidelity"]["accelerator"] in (
        "approximately-timed",
        "cycle-accurate",
    )
    if other < one or (other == one and not may_end):
        yield f"a solve took {one} clocks, with more iterations {other}"


LAWS = (
    Law("resolved", lambda *_: None, same()),
    Law("units", in_other_units, same(*FILES)),
    Law("seed", another_seed, same("frames.csv", "trace.json")),
    Law("quantum", another_quantum, same(*FILES)),
    Law("beginning", fewer_frames, is_beginning),
    Law("looked-at", looked_at, same("frames.csv"), may_be_refused=True),
    Law("neutral", with_neutral_effects, same("frames.csv"), may_be_refused=True),
    Law("stiffness", twice_as_stiff, twice_the_force),
    Law("iterations", more_iterations, no_shorter, may_be_refused=True),
)
