"""Draws a scenario: a small body, a probe that presses it, and any of the other keys.

What a run needs to be short and to have something to say, the body, the probe's motion and the
regions that fit them, is drawn by rules of its own. Every other key comes from the reference, so
that one that is new is drawn without being named here. What contradicts something else is refused
by the program; `without` then takes out what the refusal names.
"""

import math
import random
import re
from dataclasses import dataclass
from pathlib import Path

from scenario import Item, Scenario, quantity, vector
from scenario_reference import Key, Table, si

TOP = Path(__file__).resolve().parents[2]
DEVICES = sorted(path.stem for path in (TOP / "devices").glob("*.toml"))
SURFACE = TOP / "scenarios" / "surfaces" / "bean.stl"

KEY_SHARE = 0.08  # of the keys that are drawn
EFFECT_SHARE = 0.15
SWITCH_SHARE = 0.25  # of the keys on whose value it hangs whether others are there
SWITCHED_SHARE = 0.5  # of those others
EXTREME_SHARE = 0.1  # of the numbers that are drawn from the whole range

# Bounds in SI units that keep a run short, and its numbers where a body and a hand have theirs.
BOUNDS = {
    "object.material.young_modulus": (1e3, 1e5),
    "object.material.poisson_ratio": (0.0, 0.49),
    "object.material.density": (100.0, 5000.0),
    "contact.patch_radius": (1e-3, 30e-3),
    "probe.radius": (1e-4, 30e-3),
    "contact.release_force": (1e-4, 1e-1),
    "contact.hand_over": (1e-3, 60e-3),
    "loads.gravity.acceleration": (0.1, 10.0),
    "solver.iterations": (5, 120),
    "solver.displacement_range": (5e-3, 50e-3),
    "solver.stop_residual": (1e-5, 1e-1),
    "solver.replace_residual_every": (1, 60),
    "refinement.passes": (1, 4),
    "dynamics.newmark_beta": (0.6, 1.2),
    "dynamics.newmark_gamma": (0.5, 0.6),
    "accelerator.clock": (20e6, 400e6),
    "accelerator.pipeline_clocks": (12, 60),
    "accelerator.packages_per_row": (1, 12),
    "accelerator.division_clocks": (68, 1000),
    "bus.traffic.period": (20e-6, 1e-2),
    "bus.traffic.start": (0.0, 0.1),
    "bus.traffic.bytes": (4, 8192),
    "bus.graphics_traffic.bytes": (0, 200000),
    "bus.protocol.delayed_read_clocks": (0, 200),
    "transfer.poll_interval": (2e-7, 1e-3),
    "transfer.dma.segment_bytes": (64, 8192),
    "host.sustained_rate": (5e7, 1e10),
    "host.solver_rate": (5e7, 1e11),
    "host.driver_word": (1e-10, 1e-7),
    "host.interrupt_latency": (0.0, 1e-4),
    "host.timeout": (2e-4, 2e-2),
    "host.quantum": (1e-6, 1e-2),
    "host.graphics.rate": (5.0, 1000.0),
    "host.graphics.drawing_time": (0.0, 2e-2),
    "host.graphics.triangle_time": (1e-9, 1e-5),
    "host.graphics.non_preemptible": (1e-6, 1e-3),
    "host.recovery.retries": (0, 4),
    "host.recovery.attempts": (1, 12),
    "host.recovery.back_off": (1, 8),
    "device.daq.sampling_delay": (0.0, 1e-4),
    "device.daq.output_delay": (0.0, 1e-4),
    "reference.every_frames": (1, 20),
    "spectrum.relative_width": (1e-4, 0.5),
    "output.deformation_every_frames": (10, 100),
    "output.trace_size": (1e5, 6.4e7),
    "output.waveform.first_frame": (0, 40),
    "output.waveform.frames": (1, 2),
    "fault.frame": (1, 60),
    "fault.rate": (1e-3, 0.2),
    "fault.frames": (0, 20),
    "fault.delay": (1e-6, 1e-3),
    "fault.bytes": (4, 256),
    "fault.clock": (0, 100_000),
    "fault.bit": (0, 11),
    "fault.node": (0, 30),
    "fault.partition": (0, 1),
    "fault.package": (0, 20),
    "fault.column": (0, 2),
    "fault.copy": (0, 0),
}
# What a table, or a value, needs elsewhere. Left out now and then, to be refused.
NEEDS = {
    "bus.protocol": {"fidelity.bus": '"approximately-timed"'},
    "bus.traffic": {"fidelity.bus": '"approximately-timed"'},
    "bus.graphics_traffic": {"fidelity.bus": '"approximately-timed"'},
    "output.waveform": {"fidelity.accelerator": '"cycle-accurate"'},
    "transfer.dma": {"transfer.method": '"dma"'},
    "bus.pcie": {"transfer.method": '"write-combined-io"'},
    "object.model": {"refinement.passes": "3"},
    "object.model.matrix": {"refinement.passes": "3"},
}
MEETS_NEEDS = 0.9
TEXTS = {"accelerator.device": DEVICES, "title": ["drawn", 'a "quoted" title', "Nähe, 力"]}
SAMPLES = "delay_us\n1\n2\n3.5\n20\n"
MEMORIES = ["auto", "M4K", "M512", "M-RAM", "M20K", "MLAB", "BRAM"]
STEPS = {"transfer.dma.segment_bytes": 4, "fault.bytes": 4}
POWERS_OF_TWO = ("nodes_per_clock", "direction_banks", "result_queue")  # of [accelerator]

# What is drawn by rules of its own.
OWN: tuple[str, ...] = ("frames", "output.pictures", "budget.period", "object.mesh", "probe.start")
OWN += ("device.model", "device.encoder.at")
# The laws are of a body and of a probe that goes where it is told: a device that forces move has
# latency in its motion, and a wall has no body. tests/plant_cases looks at those.
NOT_DRAWN: tuple[str, ...] = (
    "wall",
    "hand",
    "device.dynamics",
    "device.structure",
    "device.friction",
    "device.gravity",
)
NOT_DRAWN += ("device.kinematics", "device.dac", "device.adc", "device.amplifier", "device.motor")
NOT_DRAWN += ("device.limits",)
OWN_LISTS = (
    "object.anchor",
    "object.region",
    "loads.point",
    "loads.pressure",
    "loads.prescribed",
    "probe.motion",
)


def log_uniform(rng: random.Random, low: float, high: float) -> float:
    """Zero, or what is between; a lower end of zero stands for a thousandth of the upper one."""
    if low <= 0:
        if rng.random() < 1 / 8:
            return 0.0
        low = high / 1000
    return min(max(math.exp(rng.uniform(math.log(low), math.log(high))), low), high)


def default_number(key: Key) -> float:
    found = re.fullmatch(r'"?(-?[\d.]+(?:e[+-]?\d+)?)( [^"]+)?"?', key.default or "0")
    return si(found[1], found[2] or "") if found else 0.0


def draw_number(rng: random.Random, full: str, key: Key) -> float:
    low = key.low if key.low is not None else -1e6
    high = key.high if key.high is not None else 1e6
    bounds = BOUNDS.get(full)
    default = default_number(key)
    if bounds is not None:
        value = log_uniform(rng, *bounds)
    elif rng.random() < EXTREME_SHARE:
        value = rng.choice((low, high, log_uniform(rng, max(low, 0), high)))
    elif default > 0:
        value = log_uniform(rng, default / 4, default * 4)
    else:
        value = log_uniform(rng, max(low, 0), min(high, 1e-3 if key.kind == "number" else 16))
    if key.kind == "whole":
        step = STEPS.get(full, 1)
        if full.removeprefix("accelerator.") in POWERS_OF_TWO:
            value = 2 ** round(math.log2(max(value, 1)))
        return min(max(round(value / step) * step, math.ceil(low)), math.floor(high))
    value = float(f"{value:.6g}")
    if key.low_open and value <= low:
        value = low + 1e-6
    if key.high_open and value >= high:
        value = high * (1 - 1e-6)
    return min(max(value, low), high)


def draw_value(rng: random.Random, full: str, key: Key) -> str:
    if key.kind == "choice":
        return f'"{rng.choice(key.choices)}"'
    if key.kind == "boolean":
        return rng.choice(("true", "false"))
    if key.kind == "text":
        texts = TEXTS.get(full, MEMORIES if full.endswith("_memory") else ["auto"])
        return "'" + rng.choice(texts) + "'"
    if key.kind == "file":
        return "'" + ("samples.csv" if key.name == "samples" else str(SURFACE)) + "'"
    if key.kind == "vector":
        size = draw_number(rng, full, key)
        return vector(tuple(round(rng.uniform(-size, size), 6) for _ in range(3)), key.dimension)
    number = draw_number(rng, full, key)
    return str(int(number)) if key.kind == "whole" else quantity(number, key.dimension)


def draw_keys(
    rng: random.Random, table: Table, share: float, taken: Item, switches: set[str]
) -> Item:
    """Of one table or item: what is required, and a share of the rest, under relative names."""
    chosen: Item = {}
    for key in table.keys:
        full = f"{table.path}.{key.name}" if table.path else key.name
        if full.startswith(OWN) or full in taken:
            continue
        condition = key.condition
        if condition is not None:
            inner = condition.key.removeprefix(f"{table.path}.")
            now = chosen.get(inner, taken.get(condition.key))
            default = next((k.default for k in table.keys if k.name == inner), None)
            if (now or default) not in condition.values:
                continue
        if condition is not None:
            wanted = max(share, SWITCHED_SHARE)
        else:
            wanted = max(share, SWITCH_SHARE) if full in switches else share
        if key.default is None or rng.random() < wanted:
            chosen[key.name] = draw_value(rng, full, key)
    return chosen


@dataclass(frozen=True)
class Body:
    """Half its width along each axis, about its centre."""

    shape: str
    half: tuple[float, float, float]
    centre: tuple[float, float, float]

    def on_surface(self, rng: random.Random, axis: int, sign: int, off: float) -> list[float]:
        """Where the outward axis through it meets the surface, aside by up to `off` of a half."""
        aside = [rng.uniform(-off, off) for _ in range(3)]
        point = [aside[i] * self.half[i] for i in range(3)]
        height = 1.0
        if self.shape == "sphere":
            height = math.sqrt(1 - sum(aside[i] ** 2 for i in range(3) if i != axis))
        point[axis] = sign * self.half[axis] * height
        return [point[i] + self.centre[i] for i in range(3)]


def bean(unit: float) -> Body:
    """Of the surface file, by its corners; `unit` in metres."""
    numbers = re.findall(r"vertex\s+(\S+)\s+(\S+)\s+(\S+)", SURFACE.read_text(encoding="ascii"))
    by_axis = [[float(vertex[axis]) * unit for vertex in numbers] for axis in range(3)]
    x, y, z = ((max(c) - min(c)) / 2 for c in by_axis)
    cx, cy, cz = ((max(c) + min(c)) / 2 for c in by_axis)
    return Body("surface", (x, y, z), (cx, cy, cz))


def draw_body(rng: random.Random, scenario: Scenario) -> Body:
    shape = rng.choice(("box", "box", "sphere", "sphere", "surface"))
    scenario.values["object.mesh.shape"] = f'"{shape}"'
    scenario.values["object.mesh.nodes"] = str(rng.randint(60, 180))
    if shape == "box":
        size = tuple(round(rng.uniform(40e-3, 120e-3), 4) for _ in range(3))
        scenario.values["object.mesh.size"] = vector(size)
        return Body(shape, (size[0] / 2, size[1] / 2, size[2] / 2), (0, 0, 0))
    if shape == "sphere":
        radius = round(rng.uniform(20e-3, 80e-3), 4)
        scenario.values["object.mesh.radius"] = quantity(radius, "length")
        return Body(shape, (radius, radius, radius), (0, 0, 0))
    scenario.values["object.mesh.nodes"] = str(rng.randint(150, 220))
    scenario.values["object.mesh.surface"] = f"'{SURFACE}'"
    unit = rng.choice((1e-3, round(rng.uniform(0.5e-3, 2e-3), 6)))
    scenario.values["object.mesh.surface_unit"] = quantity(unit, "length")
    return bean(unit)


def draw_region(rng: random.Random, body: Body, sign: int, deep: float) -> Item:
    """The part of the body that lies below (-1) or above (1), `deep` of its height."""
    kind = rng.choice(("lowest-fraction", "lowest-fraction", "half-space", "box", "sphere"))
    z = body.centre[2] + sign * body.half[2] * (1 - 2 * deep)
    item = {"kind": f'"{kind}"'}
    low = [c - 1.1 * h for c, h in zip(body.centre, body.half, strict=True)]
    high = [c + 1.1 * h for c, h in zip(body.centre, body.half, strict=True)]
    if kind == "lowest-fraction":
        item |= {"fraction": repr(round(deep, 3)), "direction": f"[0, 0, {-sign}]"}
    elif kind == "half-space":
        item |= {"point": vector((0.0, 0.0, z)), "normal": f"[0, 0, {-sign}]"}
    elif kind == "box":
        (high if sign < 0 else low)[2] = z
        item |= {"low_corner": vector(tuple(low)), "high_corner": vector(tuple(high))}
    else:
        end = body.centre[2] + sign * body.half[2]
        reach = 2 * deep * body.half[2] + 0.6 * max(body.half[:2])
        item |= {
            "centre": vector((body.centre[0], body.centre[1], end)),
            "radius": quantity(reach, "length"),
        }
    return item


def draw_part(rng: random.Random, body: Body) -> Item:
    """An upper part of the body with a material of its own."""
    item = draw_region(rng, body, 1, rng.uniform(0.2, 0.6))
    while item["kind"] == '"lowest-fraction"':
        item = draw_region(rng, body, 1, rng.uniform(0.2, 0.6))
    item["shape"] = item.pop("kind")
    item["young_modulus"] = quantity(10 ** rng.uniform(3, 6), "pressure")
    item["density"] = quantity(rng.uniform(500, 3000), "density")
    if rng.random() < 1 / 2:
        item["poisson_ratio"] = repr(round(rng.uniform(0, 0.45), 3))
    return item


def in_region(item: Item) -> Item:
    return {f"region.{key}": value for key, value in item.items()}


def draw_probe(rng: random.Random, scenario: Scenario, body: Body, seconds: float) -> None:
    axis, sign = rng.choice(((2, 1), (2, 1), (2, 1), (0, 1), (1, -1)))
    on = body.on_surface(rng, axis, sign, 0.4)
    at = list(on)
    # Not on it: whether that touches hangs on how the place is rounded.
    at[axis] += sign * rng.choice((1e-3, rng.uniform(1e-3, 0.1))) * body.half[axis]
    scenario.values["probe.start"] = vector(tuple(at))
    deep = rng.uniform(0.02, 0.2) * body.half[axis]
    motion: list[Item] = []

    def stroke(phase: str, share: float) -> None:
        duration = quantity(round(seconds * share, 6), "time")
        motion.append({"phase": f'"{phase}"', "to": vector(tuple(at)), "duration": duration})

    if rng.random() < 1 / 2:
        stroke("hold", rng.uniform(0.02, 0.1))
    at[axis] = on[axis] - sign * deep
    stroke("press", rng.uniform(0.2, 0.4))
    if rng.random() < 1 / 2:
        side = (axis + rng.choice((1, 2))) % 3
        at[side] += rng.uniform(-0.4, 0.4) * body.half[side]
        stroke("slide", rng.uniform(0.2, 0.4))
    if rng.random() < 1 / 3:
        at[axis] = on[axis] + sign * 0.1 * body.half[axis]
        stroke("release", rng.uniform(0.1, 0.3))
    scenario.lists["probe.motion"] = motion


def draw_loads(rng: random.Random, scenario: Scenario, body: Body) -> None:
    if rng.random() < EFFECT_SHARE:
        force = tuple(round(rng.uniform(-0.02, 0.02), 5) for _ in range(3))
        at = body.on_surface(rng, 2, 1, 0.6)
        point = {"position": vector(tuple(at)), "force": vector(force, "force")}
        scenario.lists["loads.point"] = [point]
    if rng.random() < EFFECT_SHARE:
        pressure = {"pressure": quantity(round(rng.uniform(-50, 50), 3), "pressure")}
        region = in_region(draw_region(rng, body, 1, rng.uniform(0.2, 0.5)))
        scenario.lists["loads.pressure"] = [pressure | region]
    if rng.random() < EFFECT_SHARE / 2:
        moved = tuple(round(rng.uniform(-1e-3, 1e-3), 6) for _ in range(3))
        region = in_region(draw_region(rng, body, 1, 0.1))
        scenario.lists["loads.prescribed"] = [{"displacement": vector(moved)} | region]


def draw(rng: random.Random, tables: list[Table]) -> Scenario:
    scenario = Scenario(files={"samples.csv": SAMPLES})
    frames = rng.randint(50, 200)
    period = rng.choice((1e-3, 2e-3, 2e-3, round(rng.uniform(2e-4, 4e-3), 6)))
    scenario.values |= {"frames": str(frames), "budget.period": quantity(period, "time")}
    scenario.values["output.pictures"] = "false"
    body = draw_body(rng, scenario)
    scenario.lists["object.anchor"] = [draw_region(rng, body, -1, rng.uniform(0.1, 0.3))]
    if rng.random() < EFFECT_SHARE:
        scenario.lists["object.region"] = [draw_part(rng, body)]
    draw_probe(rng, scenario, body, frames * period)
    draw_loads(rng, scenario, body)
    # The graphics process' rate first: at 33 Hz most frames of a short run know no contact.
    if rng.random() < 2 / 3:
        scenario.values["host.graphics.rate"] = quantity(float(rng.randint(50, 1000)), "frequency")
        scenario.values["host.graphics.drawing_time"] = quantity(rng.uniform(0, 2e-3), "time")
    switches = {key.condition.key for table in tables for key in table.keys if key.condition}
    for table in tables:
        if table.path.startswith(OWN_LISTS) or table.path == "object.mesh":
            continue
        if table.path in NOT_DRAWN:
            continue
        prefix = f"{table.path}." if table.path else ""
        if table.kind == "list":
            if rng.random() < EFFECT_SHARE:
                scenario.lists[table.path] = [draw_keys(rng, table, 1 / 2, {}, switches)]
            continue
        if table.kind == "effect":
            share = 1 / 2 if table.path == "reference" else EFFECT_SHARE
            if rng.random() >= (1 / 3 if table.path == "dynamics" else share):
                continue
            scenario.effects.add(table.path)
            if rng.random() < MEETS_NEEDS:
                scenario.values |= NEEDS.get(table.path, {})
        share = 1 / 3 if table.kind == "effect" else KEY_SHARE
        for name, value in draw_keys(rng, table, share, scenario.values, switches).items():
            scenario.values[prefix + name] = value
    if scenario.values.get("fidelity.accelerator") == '"cycle-accurate"':
        scenario.values["frames"] = str(rng.randint(30, 60))  # 25 of them take a second
    return scenario


def without(scenario: Scenario, refusal: str, key: str) -> Scenario | None:
    """The scenario without what was refused: what the message is about, what it names, or the next
    best key of the same room. None where nothing of that can be left out."""
    left = scenario.copy()
    names = [name for name in left.names() if not name.startswith(OWN)]
    about = [name for name in names if name == key or key.startswith(f"{name}.")]
    said = [name for name in names if re.search(rf"(?<![\w.]){re.escape(name)}(?!\w)", refusal)]
    room = key.partition(".")[0]
    near = [name for name in names if name.startswith(f"{room}.")]
    for name in (*about, *said, *near):
        if name.startswith(("probe.motion", "object.anchor")):
            continue
        left.take_out(name)
        return left
    return None
