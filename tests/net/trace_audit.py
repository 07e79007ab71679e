"""Holds trace.json against frames.csv and summary.json: what every core and bus did, and each
frame's critical path. Times are whole picoseconds since power-up."""

from collections import defaultdict
from collections.abc import Iterator
from itertools import pairwise
from typing import Any, NamedTuple

from ledger_audit import differ, spread
from run_files import PARTS, Run, ps

FRAMES, RESOURCES = 1, 2  # the two processes


class Slice(NamedTuple):
    name: str
    part: str
    lane: str
    start: int
    end: int
    arguments: dict[str, Any]


def slices_of(trace: list[dict[str, Any]], process: int) -> list[Slice]:
    """Of the process `hvp`, the frames' spans, or of `cores and buses`, the tenures."""
    lanes = {
        event["tid"]: str(event["args"]["name"])
        for event in trace
        if event["name"] == "thread_name"
    }
    return [
        Slice(
            event["name"],
            event["cat"],
            lanes.get(event["tid"], f"lane {event['tid']}"),
            event["ts"],
            event["ts"] + event["dur"],
            event["args"],
        )
        for event in trace
        if event["ph"] == "X" and event["pid"] == process
    ]


def by_lane(slices: list[Slice]) -> dict[str, list[Slice]]:
    lanes: dict[str, list[Slice]] = defaultdict(list)
    for slice_ in slices:
        lanes[slice_.lane].append(slice_)
    for lane in lanes.values():
        lane.sort(key=lambda s: (s.start, -s.end))
    return dict(lanes)


def is_cut(run: Run) -> bool:
    marks = ("the trace ends here", "set-up is not drawn further")
    return any(event["ph"] == "i" and event["name"].startswith(marks) for event in run.trace)


def lanes_do_not_overlap(spans: list[Slice], tenures: list[Slice]) -> Iterator[str]:
    for slices in (spans, tenures):
        for name, lane in by_lane(slices).items():
            open_until = [lane[0].end]
            for before, after in pairwise(lane):
                while open_until and open_until[-1] <= after.start:
                    open_until.pop()
                # Frames' slices may nest, tenures not even that.
                nested = slices is spans and bool(open_until) and after.end <= open_until[-1]
                if open_until and after.end > after.start and not nested:
                    yield f"on {name}, {after} begins before {before} is over"
                open_until.append(after.end)


def paths_are_whole(run: Run, spans: list[Slice]) -> Iterator[str]:
    begin = ps(run.summary["set_up_us"])
    frames = {frame.number: frame for frame in run.frames}
    by_frame: dict[int, list[Slice]] = defaultdict(list)
    for slice_ in spans:
        by_frame[slice_.arguments["frame"]].append(slice_)
    for number, of_frame in by_frame.items():
        if number not in frames:
            yield f"the trace has a frame {number}, frames.csv has not"
            continue
        frame = frames[number]
        of_frame.sort(key=lambda s: s.arguments["span"])
        by_id = {s.arguments["span"]: s for s in of_frame}
        path = [s for s in of_frame if s.arguments["critical"]]
        at, cause = begin + frame.born, -1
        times = dict.fromkeys(PARTS, 0)
        for span in path:
            yield from differ(f"frame {number}: the start of critical {span.name}", span.start, at)
            yield from differ(f"frame {number}: its cause", span.arguments["cause"], cause)
            at, cause = span.end, span.arguments["span"]
            times[span.part] += span.end - span.start
        yield from differ(
            f"frame {number}: the end of its path", at, begin + frame.born + frame.latency
        )
        yield from differ(f"frame {number}: its path by part", times, frame.parts)
        for span in of_frame:
            before = by_id.get(span.arguments["cause"])
            if before is not None and before.start > span.start:
                yield f"frame {number}: {span.name} begins before its cause {before.name}"


def every_frame_is_drawn(run: Run, spans: list[Slice]) -> Iterator[str]:
    wanted = run.settings["output"]["trace_frames"]
    drawn = {s.arguments["frame"] for s in spans}
    expected = {frame.number for frame in run.frames[:wanted]}
    yield from differ("the frames in the trace", sorted(drawn), sorted(expected))


def bus_time_agrees(run: Run, tenures: list[Slice]) -> Iterator[str]:
    """Whole only where all frames are drawn."""
    if run.settings["output"]["trace_frames"] < run.summary["frames_asked"]:
        return
    begin = ps(run.summary["set_up_us"])
    taken = [s for s in tenures if s.lane == "bus taken"]
    total = sum(s.end - s.start for s in taken)
    yield from differ("bus.busy_us", ps(run.summary["bus"]["busy_us"]), total)
    by: dict[str, int] = defaultdict(int)
    for tenure in taken:
        if tenure.end > begin:
            by[tenure.arguments["by"]] += tenure.end - max(tenure.start, begin)
    said = {
        line["initiator"]: ps(line["busy_us"])
        for line in run.summary["bus"]["utilisation"]["by_initiator"]
        if line["busy_us"] > 0  # untimed, nothing is drawn
    }
    yield from differ("bus.utilisation.by_initiator", said, dict(by))


def statistics_agree(run: Run, spans: list[Slice]) -> Iterator[str]:
    """What the summary counts of every span, where all frames are drawn."""
    if run.settings["output"]["trace_frames"] < run.summary["frames_asked"]:
        return
    on_bus: dict[str, list[int]] = defaultdict(list)
    by_phase: dict[tuple[str, str], dict[int, int]] = defaultdict(lambda: defaultdict(int))
    for span in spans:
        time = span.end - span.start
        if span.part == "bus":
            on_bus[span.name].append(time)
        if span.arguments["critical"]:
            by_phase[span.part, span.name][span.arguments["frame"]] += time
    said = run.summary["latency"]
    counts = {line["transaction"]: line["count"] for line in said["by_transaction"]}
    found = {name: len(times) for name, times in on_bus.items()}
    yield from differ("latency.by_transaction", counts, found)
    for line in said["by_transaction"]:
        what = f"latency.by_transaction {line['transaction']}"
        yield from spread(what, line, on_bus[line["transaction"]])
    for line in said["by_phase"]:
        what = f"latency.by_phase {line['part']} {line['phase']}"
        of_frames = by_phase[line["part"], line["phase"]]
        times = [of_frames.get(frame.number, 0) for frame in run.frames]
        yield from spread(what, line, times)
        yield from differ(f"{what}.frames", line["frames"], sum(time > 0 for time in times))
    for name, phase in (("release", "release"), ("wake_up", "wake-up")):
        if name in run.summary["jitter"]:
            of_frames = by_phase["host", phase]
            times = [of_frames.get(frame.number, 0) for frame in run.frames]
            yield from spread(f"jitter.{name}", run.summary["jitter"][name], times)


def complaints(run: Run) -> Iterator[str]:
    spans, tenures = slices_of(run.trace, FRAMES), slices_of(run.trace, RESOURCES)
    yield from lanes_do_not_overlap(spans, tenures)
    yield from paths_are_whole(run, spans)
    if not is_cut(run):
        yield from every_frame_is_drawn(run, spans)
        yield from bus_time_agrees(run, tenures)
        yield from statistics_agree(run, spans)
