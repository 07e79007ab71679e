"""Runs a small scene with every number of the scenario reference at both ends of its range.

The keys, their ranges and what they belong to are read from `hvp reference`, so that a new key is
tried as soon as it is declared. A run has to end by itself with exit status 0 or 1, or be refused
with status 2 and one line that says what the value contradicts; no result may hold an infinity or
something that is not a number, and no file may be left unfinished. A range that is open to one side
is tried with 1e300.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "net"))
import whole_files
from scenario_reference import UNITS, Key, Table, tables_of

TOP = Path(__file__).resolve().parents[2]
LONGEST_RUN_S = 60
HUGE = "1e300"
REFUSED = 2

# Pressed from the first tick, and looked at once a millisecond: half of the frames have contact.
SCENE = """\
frames = 20
[host.graphics]
rate = "1 kHz"
drawing_time = "100 us"
[object.mesh]
shape = "box"
nodes = 60
[[object.anchor]]
fraction = 0.2
[dynamics]
[solver]
iterations = 20
[probe]
start = ["10 mm", "10 mm", "50 mm"]
[[probe.motion]]
phase = "press"
to = ["10 mm", "10 mm", "40 mm"]
duration = "60 ms"
[reference]
[output]
deformation_every_frames = 10
pictures = false
remedies = false
"""

# What stands in a body's place.
WALL_SCENE = """\
frames = 20
[wall]
[device.dynamics]
[hand]
model = "custom"
[probe]
start = ["0 mm", "0 mm", "1 mm"]
[[probe.motion]]
phase = "press"
to = ["0 mm", "0 mm", "-1 mm"]
duration = "20 ms"
[output]
pictures = false
remedies = false
"""
OF_A_WALL = ("wall", "hand", "device.")

# Frames at the end of the range would simulate for hours, which is no fault.
WITHOUT = {"frames": ("100000000",)}

# What a table or a value of its needs elsewhere, and what an item of a list needs beside its key.
NEEDS = {
    "bus.protocol": ["fidelity.bus=approximately-timed"],
    "bus.traffic": ["fidelity.bus=approximately-timed"],
    "bus.graphics_traffic": ["fidelity.bus=approximately-timed"],
    "output.waveform": ["fidelity.accelerator=cycle-accurate"],
    "host.solver_rate": ["host.solver=cg"],
    "host.gpu": ["host.solver=inverse"],
    "host.gpu.latencies": ["host.solver=inverse"],
    "device.dac": ["device.amplifier=true", "device.motor=true"],
    "device.adc": ["device.amplifier=true", "device.motor=true"],
    "device.amplifier": ["device.motor=true"],
    '"joints"': ["device.kinematics=true"],
    '"surface"': [f"object.mesh.surface={TOP / 'scenarios' / 'surfaces' / 'bean.stl'}"],
    '"measured"': ["{table}.samples=samples.csv"],
    '"normal"': ["{table}.deviation=2 us"],
    '"lognormal"': ["{table}.median=5 us", "{table}.spread=2"],
    '"pareto"': [
        '{table}.distribution="measured"',
        "{table}.samples=samples.csv",
        "{table}.tail_from=1 us",
        "{table}.tail_scale=2 us",
        "{table}.tail_shape=0.1",
    ],
    '"late-dma"': ["transfer.method=dma"],
    '"truncated-dma"': ["transfer.method=dma"],
}
ITEMS = {
    "loads.point": {
        "position": '["0 mm", "0 mm", "50 mm"]',
        "force": '["0 N", "0 N", "-0.01 N"]',
    },
    "loads.pressure": {"pressure": '"10 Pa"', "region.kind": '"all"'},
    "loads.prescribed": {
        "displacement": '["0 m", "0 m", "-0.1 mm"]',
        "region.kind": '"half-space"',
        "region.point": '["0 m", "0 m", "49 mm"]',
        "region.normal": "[0, 0, -1]",
    },
    "object.region": {"radius": '"30 mm"'},
    "probe.motion": {
        "phase": '"press"',
        "to": '["10 mm", "10 mm", "40 mm"]',
        "duration": '"60 ms"',
    },
    "fault": {"kind": '"stuck-busy"', "frame": "5"},
}
REGIONS = {
    '"box"': {
        "low_corner": '["-60 mm", "-60 mm", "-60 mm"]',
        "high_corner": '["60 mm", "60 mm", "-20 mm"]',
    },
    '"sphere"': {"centre": '["0 mm", "0 mm", "-50 mm"]', "radius": '"45 mm"'},
}
SURFACES = {'"surface"': {"surface": f'"{TOP / "scenarios" / "surfaces" / "bean.stl"}"'}}
FAULTS = {
    '"late-dma"': {"delay": '"1 us"'},
    '"truncated-dma"': {"bytes": "4"},
    '"flip"': {"place": '"r"'},
}
# Where `place` decides which keys there are.
FLIPS = {place: {"kind": '"flip"'} for place in ('"x"', '"d"', '"matrix"')}

# What is said about an override that is put together wrongly here, or about a value outside its
# range: neither tries what was to be tried.
NOT_TRIED = re.compile(
    "TOML syntax|expected a (whole )?number|missing|belongs to|unknown|out of range|unit:"
)


@dataclass(frozen=True)
class Number:
    """A key that has one, or three of them."""

    table: str
    key: Key
    conditions: tuple[tuple[str, str], ...]  # of the table and of the key: key, value

    @property
    def full(self) -> str:
        return f"{self.table}.{self.key.name}" if self.table else self.key.name


@dataclass(frozen=True)
class Case:
    key: str
    value: str
    overrides: tuple[str, ...]


def numbers(tables: list[Table]) -> Iterator[Number]:
    for table in tables:
        for key in table.keys:
            if key.kind in ("number", "whole", "vector"):
                found = [condition for condition in (table.condition, key.condition) if condition]
                conditions = tuple((condition.key, condition.values[0]) for condition in found)
                yield Number(table.path, key, conditions)


def written(value: str, key: Key) -> str:
    unit = "" if key.kind == "whole" else UNITS[key.dimension]
    return f'"{value} {unit}"' if unit else value


def ends(key: Key) -> list[str]:
    """The smallest and the largest value that the reference names, as one component."""
    whole = key.kind == "whole"

    def end(bound: float | None, without: str) -> str:
        if bound is None:
            return without
        return str(int(bound)) if whole else repr(bound)

    least = end(key.low, "-9223372036854775808" if whole else f"-{HUGE}")
    most = end(key.high, "9223372036854775807" if whole else HUGE)
    if key.low_open:
        least = "1e-300"
    if key.high_open:
        most = "0.9999999999999999"
    return [written(least, key), written(most, key)]


def values(key: Key) -> Iterator[str]:
    zero = written("0", key)
    for end in ends(key):
        if key.kind != "vector":
            yield end
            continue
        yield f"[{end}, {end}, {end}]"
        if key.low is None or key.low < 0 or (key.low == 0 and not key.low_open):
            yield f"[{zero}, {zero}, {end}]"


def item_case(key: Number, value: str, listed: str) -> Case:
    """One item of a list in place of what the scene has: every key of it in one override."""
    fields = dict(ITEMS.get(listed, {}))
    inner = key.full.removeprefix(f"{listed}.")
    prefix = inner.rpartition(".")[0]
    prefix += "." if prefix else ""
    overrides = []
    if listed == "object.region" and key.conditions:  # of another shape
        fields = {}
    if prefix:  # a region
        fields = {name: text for name, text in fields.items() if not name.startswith(prefix)}
    for name, chosen in key.conditions:
        fields[name.removeprefix(f"{listed}.")] = chosen
        extra = {**REGIONS, **FAULTS, **FLIPS, **SURFACES}.get(chosen, {})
        fields.update({prefix + field: text for field, text in extra.items()})
        if not extra:
            overrides += NEEDS.get(chosen, [])
        if chosen == '"flip"' or chosen in FLIPS:
            overrides.append("fidelity.accelerator=cycle-accurate")
    if key.full == "fault.rate":
        del fields["frame"]
    fields[inner] = value
    item = ", ".join(f"{name} = {text}" for name, text in fields.items())
    overrides.append(f"{listed}=[{{{item}}}]")
    return Case(key.full, value, tuple(overrides))


def cases(keys: list[Number], lists: set[str]) -> Iterator[Case]:
    for key in keys:
        listed = next((name for name in lists if f"{key.full}.".startswith(f"{name}.")), None)
        for value in values(key.key):
            if value in WITHOUT.get(key.full, ()):
                continue
            if listed is not None:
                yield item_case(key, value, listed)
                continue
            overrides = [*NEEDS.get(key.table, []), *NEEDS.get(key.full, [])]
            if key.table == "object.mesh":
                overrides.append('object.mesh={shape = "box", nodes = 60}')
            for name, chosen in key.conditions:
                overrides.append(f"{name}={chosen}")
                if chosen == '"measured"' and not name.endswith("distribution"):
                    continue  # a host's model, which has a table of its own
                overrides += [need.format(table=key.table) for need in NEEDS.get(chosen, [])]
            yield Case(key.full, value, (*overrides, f"{key.full}={value}"))


def complaint(hvp: Path, scene: Path, case: Case) -> str:
    """What is wrong with the run, empty where nothing is. `scene` has one of a wall beside it."""
    if case.key.startswith(OF_A_WALL):
        scene = scene.with_name("wall.toml")
    with tempfile.TemporaryDirectory(prefix="hvp-extremes-") as folder:
        out = Path(folder) / "out"
        command = [str(hvp), "run", str(scene), "--out", str(out)]
        for override in case.overrides:
            command += ["--set", override]
        try:
            run = subprocess.run(
                command, capture_output=True, timeout=LONGEST_RUN_S, check=False, cwd=folder
            )
        except subprocess.TimeoutExpired:
            return f"took more than {LONGEST_RUN_S} s"
        said = run.stderr.decode(errors="replace")
        if run.returncode == REFUSED:
            refused_well = said.count("\n") == 1 and not NOT_TRIED.search(said)
            return "" if refused_well else f"was refused: {said}"
        if run.returncode not in (0, 1):
            return f"ended with status {run.returncode}: {said}"
        return "; ".join(whole_files.complaints(out, run.stdout.decode(errors="replace")))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("hvp", type=Path, help="the program")
    parser.add_argument("--only", default="", help="keys that start so")
    arguments = parser.parse_args()
    hvp: Path = arguments.hvp.resolve()
    page = subprocess.run([hvp, "reference"], capture_output=True, text=True, check=True)
    tables = tables_of(page.stdout)
    keys = [key for key in numbers(tables) if key.full.startswith(arguments.only)]
    lists = {table.path for table in tables if table.kind == "list"}
    tried = list(cases(keys, lists))
    if not tried:
        print("the reference has no such number", file=sys.stderr)
        return 1
    wrong = 0
    with tempfile.TemporaryDirectory(prefix="hvp-extremes-") as folder:
        scene = Path(folder) / "scene.toml"
        scene.write_text(SCENE)
        scene.with_name("wall.toml").write_text(WALL_SCENE)
        # Longer than what may be counted of a sample.
        (Path(folder) / "samples.csv").write_text("latency_us\n2\n3\n")
        with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
            results = pool.map(lambda case: complaint(hvp, scene, case), tried)
            for case, text in zip(tried, results, strict=True):
                if text:
                    wrong += 1
                    print(f"{case.key} = {case.value} {text}\n  {case.overrides}")
    print(f"{len(keys)} keys, {len(tried)} runs, {wrong} of them wrong")
    return 0 if wrong == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
