"""Recomputes from a run's files what its summary says: each check yields what does not agree."""

import math
from collections import Counter
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

from run_files import PARTS, Frame, Run, ps

# Printed as doubles of microseconds: sums of a thousand of them agree to far better than this.
ROUNDING_REL = 1e-9
LOWEST_OCTAVE = 64  # ps; what is shorter is not parted further


def close(a: float, b: float, scale: float = 0.0) -> bool:
    return abs(a - b) <= ROUNDING_REL * max(abs(a), abs(b), scale)


def differ(what: str, said: object, found: object) -> Iterator[str]:
    if said != found:
        yield f"{what} is {said}, the files say {found}"


def differ_mean(what: str, said_us: float, times: list[int]) -> Iterator[str]:
    mean = sum(times) / len(times) / 1e6
    if not close(said_us, mean):
        yield f"{what} is {said_us}, the files say {mean}"


def percentile(times: list[int], share: float) -> int:
    return sorted(times)[max(math.ceil(share * len(times)), 1) - 1]


def histogram(what: str, said: list[dict[str, Any]], times: list[int]) -> Iterator[str]:
    ordered = sorted(times)
    counted = 0
    for bin_ in said:
        low, high = ps(bin_["from_us"]), ps(bin_["below_us"])
        inside = sum(low <= time < high for time in ordered)
        counted += bin_["frames"]
        if inside != bin_["frames"]:
            yield f"{what} has {bin_}, the files say {inside} frames"
    yield from differ(f"the sum of {what}", counted, len(times))


def spread(what: str, said: dict[str, float], times: list[int]) -> Iterator[str]:
    """Worst and mean are exact; a percentile is the upper end of a bin, one part in 64 wide."""
    yield from differ(f"{what}.worst_us", ps(said["worst_us"]), max(times))
    yield from differ_mean(f"{what}.mean_us", said["mean_us"], times)
    for name, share in (("p50_us", 0.5), ("p99_us", 0.99)):
        exact = percentile(times, share)
        if not exact <= ps(said[name]) <= exact * (1 + 1 / 64) + 1:
            yield f"{what}.{name} is {said[name]}, the files say {exact / 1e6}"


def frames_add_up(run: Run) -> Iterator[str]:
    period = ps(run.summary["deadline"]["period_us"])
    before = -1
    for frame in run.frames:
        name = f"frame {frame.number}"
        if frame.number <= before:
            yield f"{name} comes after {before}"
        before = frame.number
        yield from differ(f"{name}: born_us", frame.born, frame.number * period)
        yield from differ(f"{name}: the sum of parts", sum(frame.parts.values()), frame.latency)
        in_time = frame.latency <= frame.deadline and frame.status == "HVP_OK"
        yield from differ(f"{name}: in_time", frame.in_time, in_time)
        for part, time in frame.parts.items():
            if time < 0:
                yield f"{name}: {part}_us is negative"


def deadline(run: Run) -> Iterator[str]:
    said, frames = run.summary["deadline"], run.frames
    times = [frame.latency for frame in frames]
    yield from differ("deadline.frames", said["frames"], len(frames))
    done = len(frames) + said["skipped_ticks"]
    yield from differ("frames and skipped ticks", done, run.summary["frames_asked"])
    yield from differ("deadline.worst_us", ps(said["worst_us"]), max(times))
    first_worst = next(f.number for f in frames if f.latency == max(times))
    yield from differ("deadline.worst_frame", said["worst_frame"], first_worst)
    for name, share in (("p50_us", 0.5), ("p99_us", 0.99)):
        yield from differ(f"deadline.{name}", ps(said[name]), percentile(times, share))
    misses = sum(not frame.in_time for frame in frames) + said["skipped_ticks"]
    yield from differ("deadline.misses", said["misses"], misses)
    yield from differ("deadline.held", said["held"], misses == 0)
    late = [f.latency - f.deadline for f in frames if f.latency > f.deadline]
    if bool(late) != (said["lateness"] is not None):
        yield f"deadline.lateness is {said['lateness']}, {len(late)} forces are late"
    elif late:
        yield from spread("deadline.lateness", said["lateness"], late)
        counts = Counter(time.bit_length() for time in late)
        found = sorted((1 << (bits - 1), count) for bits, count in counts.items())
        octaves = [(ps(o["from_us"]), o["frames"]) for o in said["lateness"]["octaves"]]
        if min(late) >= LOWEST_OCTAVE:
            yield from differ("deadline.lateness.octaves", octaves, found)


def load(run: Run) -> Iterator[str]:
    said, frames = run.summary["load"], run.frames
    period = ps(run.summary["deadline"]["period_us"])
    yield from differ("load.worst_us", ps(said["worst_us"]), max(f.load for f in frames))
    over = sum(f.load > period for f in frames) + run.summary["deadline"]["skipped_ticks"]
    yield from differ("load.misses", said["misses"], over)
    yield from differ("load.held", said["held"], over == 0)


def latency(run: Run) -> Iterator[str]:
    said, frames = run.summary["latency"], run.frames
    times = [frame.latency for frame in frames]
    yield from differ("latency.best_us", ps(said["best_us"]), min(times))
    yield from differ_mean("latency.mean_us", said["mean_us"], times)
    for name, share in (("p50", 0.5), ("p90", 0.9), ("p99", 0.99), ("p99_9", 0.999), ("worst", 1)):
        us = said["percentiles"][f"{name}_us"]
        yield from differ(f"latency.percentiles.{name}_us", ps(us), percentile(times, share))
    yield from histogram("latency.histogram", said["histogram"], times)
    for line in said["by_part"]:
        what = f"latency.by_part {line['part']}"
        of_part = [frame.parts[line["part"]] for frame in frames]
        yield from spread(what, line, of_part)
        yield from histogram(what, line["histogram"], of_part)
    named = {line["part"] for line in said["by_part"]}
    for part in PARTS:
        if part not in named and any(frame.parts[part] for frame in frames):
            yield f"latency.by_part has no {part}"
    for name in ("by_part", "by_phase"):
        total = sum(line["mean_us"] for line in said[name])
        if not close(total, said["mean_us"]):
            yield f"the means of latency.{name} sum to {total}, the mean is {said['mean_us']}"
    changes = [abs(b.latency - a.latency) for a, b in pairwise(frames)]
    if changes:
        yield from spread("jitter.frame_to_frame", run.summary["jitter"]["frame_to_frame"], changes)


def attribution(run: Run) -> Iterator[str]:
    said, number = run.summary["attribution"], run.summary["deadline"]["worst_frame"]
    worst = next(frame for frame in run.frames if frame.number == number)
    yield from differ("the sum of attribution", sum(ps(line["us"]) for line in said), worst.latency)
    for part in PARTS:
        total = sum(ps(line["us"]) for line in said if line["part"] == part)
        yield from differ(f"attribution of {part}", total, worst.parts[part])


def ticks_without_force(frames: list[Frame], ticks: int) -> int:
    """The longest row of them: held forces, and ticks that had no frame."""
    new = {frame.number for frame in frames if frame.status == "HVP_OK"}
    longest = row = 0
    for tick in range(ticks):
        row = 0 if tick in new else row + 1
        longest = max(longest, row)
    return longest


def driver(run: Run) -> Iterator[str]:
    said = run.summary["driver"]
    held = sum(frame.status != "HVP_OK" for frame in run.frames)
    yield from differ("driver.held_frames", said["held_frames"], held)
    longest = ticks_without_force(run.frames, run.summary["frames_asked"])
    yield from differ("driver.longest_hold_ticks", said["longest_hold_ticks"], longest)
    counts = [frame.saturations for frame in run.frames]
    if None not in counts:
        total = sum(count for count in counts if count is not None)
        yield from differ("stability.saturations", run.summary["stability"]["saturations"], total)


def accuracy(run: Run) -> Iterator[str]:
    said = run.summary["accuracy"]
    for name in ("displacement", "force"):
        mean, worst = said[f"{name}_rel"], said[f"{name}_worst_rel"]
        if mean is not None and (worst is None or worst < mean * (1 - ROUNDING_REL)):
            yield f"accuracy.{name}_worst_rel is {worst}, less than the mean {mean}"
    if said["frames"] is not None and said["frames"] > len(run.frames):
        yield f"accuracy.frames is {said['frames']} of {len(run.frames)}"


def forces(run: Run) -> Iterator[str]:
    for frame, row in zip(run.frames, run.rows, strict=True):
        if frame.force is not None and not close(float(row["force_N"]), math.hypot(*frame.force)):
            yield f"frame {frame.number}: force_N is {row['force_N']}, the force {frame.force}"


def contact(run: Run) -> Iterator[str]:
    nodes = [-1, *(frame.contact_node for frame in run.frames)]
    changes = sum(old != new for old, new in pairwise(nodes))
    yield from differ("contact.changes", run.summary["contact"]["changes"], changes)


def errors_are_flagged(run: Run) -> Iterator[str]:
    """No run is beyond what its scenario tolerates without a word. A refined one heads for the
    true model and not for that of its words."""
    said, flags = run.summary["accuracy"], run.summary["stability"]["flags"]
    if "reference" not in run.settings or flags:
        return
    tolerated = run.settings["reference"]
    model = run.settings.get("object", {}).get("model", {}).get("kind", "linear")
    if tolerated.get("model", "own") not in ("own", model):
        return  # the distance of two models, which no tolerance of the solver's bounds
    models = {"": "tolerance", "_quantised": "solver_tolerance"}
    if "refinement" in run.settings:
        del models["_quantised"]
    for name, key in models.items():
        for what in ("displacement", "force"):
            error = said[f"{what}_rel{name}"]
            if error is not None and error > tolerated[key]:
                yield f"accuracy.{what}_rel{name} is {error}, reference.{key} {tolerated[key]}"


def utilisation(run: Run) -> Iterator[str]:
    said = run.summary["bus"]["utilisation"]
    users = said["by_initiator"]
    shares = math.fsum(user["share"] for user in users)
    if not close(shares, said["share"]):
        yield f"bus.utilisation.share is {said['share']}, its initiators have {shares}"
    busy = math.fsum(user["busy_us"] for user in users)
    for user in users:
        if not close(user["share"] * busy, user["busy_us"] * shares):
            yield f"bus.utilisation: the share of {user} is not that of its time"
    for name in ("share", "worst_frame_share"):
        if not 0 <= said[name] <= 1 + ROUNDING_REL:
            yield f"bus.utilisation.{name} is {said[name]}"


def status(run: Run) -> Iterator[str]:
    """0 when every budget held, else 1."""
    held = run.summary["deadline"]["held"] and run.summary["load"]["held"]
    if not held:
        yield from differ("the exit status", run.status, 1)


CHECKS = (
    frames_add_up,
    deadline,
    load,
    latency,
    attribution,
    driver,
    accuracy,
    forces,
    contact,
    errors_are_flagged,
    utilisation,
    status,
)


def complaints(run: Run) -> Iterator[str]:
    if not run.frames:
        yield "frames.csv has no frame"
        return
    for check in CHECKS:
        yield from check(run)
