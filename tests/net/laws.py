"""What holds between two runs whatever the scenario: each law changes a scenario and says how the
results have to answer. These are of writing, of time and of what is not there."""

import random
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from run_files import Run
from scenario import Scenario

Change = Callable[[random.Random, Scenario, Run], Scenario | None]
Compare = Callable[[Run, Run], Iterator[str]]
Prepare = Callable[[random.Random, Scenario], Scenario]

FILES = ("frames.csv", "summary.json", "trace.json")
# The effects that draw their times.
RANDOM = (
    *("host.jitter", "host.wake_up", "host.interrupt_latencies"),
    *("bus.read_latencies", "bus.pcie.root_complex_latencies"),
)


@dataclass(frozen=True)
class Law:
    name: str
    change: Change  # None: the law does not speak of this scenario
    compare: Compare  # the run before, the changed one
    may_be_refused: bool = False  # the changed scenario
    prepare: Prepare | None = None  # the scenario before, where not every one can be asked
    keeps: tuple[str, ...] = ()  # keys of what was prepared that may not be refused


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


def glides(scenario: Scenario) -> bool:
    """The body yields to a probe of its size, which a node does not know."""
    return scenario.values.get("contact.kind", '"proxy"') != '"node"'


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
    """No fewer than its faults need."""
    frames = int(scenario.values["frames"])
    needed = [
        int(fault.get("frame", "-1")) + int(fault.get("count", "1"))
        for fault in scenario.lists.get("fault", [])
    ]
    needed.append(int(scenario.values.get("output.waveform.first_frame", "-1")) + 1)
    fewest = max([1, *needed])
    return setting(scenario, frames=str(rng.randint(fewest, max(fewest, frames - 1))))


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
        title='"another"',
    )
    if not glides(scenario):
        changed = setting(changed, probe__radius='"1 mm"')
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
    Law("iterations", more_iterations, no_shorter, may_be_refused=True),
)
