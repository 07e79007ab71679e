"""The checks of a run's force, formed again from frames.csv at every frame.

What the program keeps of the past is a ring of samples some milliseconds apart; here is every
frame. Values are compared within what that makes of them, and flags where they are clear of their
thresholds.
"""

import math
from bisect import bisect_right
from collections.abc import Iterator
from itertools import pairwise

from run_files import Frame, Run

STEP = 0.10  # of the largest force, from frame to frame
NOTICED = 0.10  # of the force, while a contact is handed over
SPANS = {"within_30_ms_rel": 30 * 10**9, "within_100_ms_rel": 100 * 10**9}  # ps
NO_FORCE_N = 4e-4
CLEAR = 0.15  # of a threshold, on either side

Vector = tuple[float, ...]


def minus(a: Vector, b: Vector) -> Vector:
    return tuple(x - y for x, y in zip(a, b, strict=True))


def second_difference(now: Vector, middle: Vector, first: Vector) -> float:
    return math.hypot(*(a - 2 * b + c for a, b, c in zip(now, middle, first, strict=True)))


def forces_of(frames: list[Frame]) -> list[Vector]:
    return [frame.force for frame in frames if frame.force is not None]


def largest_step(forces: list[Vector]) -> float:
    """Of the largest force."""
    largest = max(math.hypot(*force) for force in forces)
    steps = [math.hypot(*minus(b, a)) for a, b in pairwise(forces)]
    return max(steps, default=0.0) / largest if largest > 0 else 0.0


# Between two samples of the program's past, which are frames: a frame more at the most.
SAMPLE = 2 * max(SPANS.values()) // 62


def handed_over(frames: list[Frame], forces: list[Vector], span: int, rest: int = 0) -> float:
    """The largest change within the span that neither the trend nor the tip explains, of spans
    that begin by so much after the first touch."""
    times = [frame.born for frame in frames]
    worst = 0.0
    touched = handed = -1
    for i, frame in enumerate(frames):
        before = frames[i - 1].contact_node if i > 0 else -1
        if frame.contact_node < 0:
            touched = handed = -1
            continue
        if before < 0:
            touched, handed = i, -1
        elif frame.contact_node != before:
            handed = i
        began = times[i] - 2 * span
        if handed < 0 or times[touched] + rest > began or times[handed] <= began:
            continue
        middle = bisect_right(times, times[i] - span) - 1
        first = bisect_right(times, began) - 1
        if first < 0 or middle == first:
            continue
        force = max(math.hypot(*forces[k]) for k in (i, middle, first))
        way = math.hypot(*minus(frame.tip, frames[touched].tip))
        if force <= NO_FORCE_N or way == 0:
            continue
        change = second_difference(forces[i], forces[middle], forces[first]) / force
        explained = second_difference(frame.tip, frames[middle].tip, frames[first].tip) / way
        worst = max(worst, change - explained)
    return worst


def clear_of(value: float, threshold: float) -> bool:
    return abs(value - threshold) > CLEAR * threshold


METRES = {"m": 1.0, "mm": 1e-3, "um": 1e-6}


def metres(text: str) -> float:
    value, unit = text.split()
    return float(value) * METRES[unit]


def touched_from_afar(run: Run) -> Iterator[str]:
    """No gap between a tip and the surface it presses on is longer than the body."""
    proxy = run.summary["contact"]["proxy"]
    if proxy is None:
        return
    mesh = run.settings["object"]["mesh"]
    if mesh["shape"] == "surface":
        return
    size = mesh.get("size") or 3 * [mesh["radius"]]
    longest = 2 * math.hypot(*(metres(text) for text in size))
    if proxy["largest_gap_m"] > longest:
        yield f"a proxy was {proxy['largest_gap_m']} m from its tip, on a body of {longest} m"


def complaints(run: Run) -> Iterator[str]:
    yield from touched_from_afar(run)
    said = run.summary.get("force")
    forces = forces_of(run.frames)
    if said is None or len(forces) != len(run.frames) or "forces" in run.summary:
        return
    step = largest_step(forces)
    if abs(step - said["step"]["of_largest_rel"]) > 1e-6 * max(step, 1e-9):
        yield f"force.step.of_largest_rel is {said['step']['of_largest_rel']}, of all frames {step}"
    # Of a proxy the tip's way is from the surface, which no file has.
    glides = run.summary["contact"]["proxy"] is not None
    spans = {} if glides else SPANS
    changes = {key: handed_over(run.frames, forces, span) for key, span in spans.items()}
    for key, change in changes.items():
        # The force rises from the first touch as fast as it ever does: the sample that the program
        # looks back to may be from before it.
        frame = run.frames[1].born - run.frames[0].born if len(run.frames) > 1 else 0
        later = handed_over(run.frames, forces, SPANS[key], SAMPLE + frame)
        told = said["handed_over"][key]
        room = 0.25 * max(change, told) + 0.02
        if not later - room <= told <= change + room:
            yield f"force.handed_over.{key} is {told}, of all frames {later} to {change}"
        changes[key] = told
    if not all(clear_of(value, NOTICED) for value in (step, *changes.values())):
        return
    first = run.frames[0]
    begins = first.contact_node >= 0 and math.hypot(*forces[0]) > NO_FORCE_N
    largest_change = step * max(math.hypot(*force) for force in forces)
    steps = step > STEP and largest_change > NO_FORCE_N
    expected = steps or begins or any(change > NOTICED for change in changes.values())
    if glides and not expected and any(said["handed_over"][key] > NOTICED for key in SPANS):
        return
    if expected != ("force-step" in run.summary["stability"]["flags"]):
        yield f"force-step is not what all frames say: step {step}, {changes}, begins {begins}"
