"""What a session adds to each run: asked are less than 5 ms, and memory that does not grow.

    HVP_PROGRAM=build/release/app/hvp python -m bench.studies.overhead [RUNS]

The runs only take the time of frames, a handful each, so that they are as short as runs get, and
one is under way at a time. On a machine that is at work elsewhere what is added holds waiting for a
processor too: the processor time of the driver alone stands beside it. The memory is the driver's,
at a tenth of the runs and at the end.
"""

import os
import resource
import sys
import tempfile
import time
from pathlib import Path

from studies.point import Point
from studies.program import find_program
from studies.session import Session
from studies.store import Store

ASKED_MS = 5.0
MOST_RUNS = 10_000
SCENARIO = Path(__file__).resolve().parents[2] / "scenarios" / "thesis.toml"
# Times only, and nothing written that a study does not read.
SHORT = ("frames=5", "fidelity.numbers=none", "reference=false", "output.pictures=false")


def main() -> int:
    """Print both; 1 where a run costs more than is asked."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else MOST_RUNS
    points = [Point(SCENARIO, (*SHORT, f'probe.radius="{3 + n / runs} mm"')) for n in range(runs)]
    memory: list[float] = []

    def watch(done: int, _total: int) -> None:
        if done in (max(runs // 10, 1), runs):
            # KiB on Linux; the highest so far.
            memory.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)

    with tempfile.TemporaryDirectory(prefix="hvp-bench-") as folder:
        session = Session(find_program(), Store(Path(folder)), workers=1)
        began = time.monotonic()
        processor = time.process_time()
        session.addresses(points)
        resolved = time.monotonic()
        records = session.run(points, watch)
        ended = time.monotonic()
        processor = time.process_time() - processor
    assert all(record.done for record in records), records[0].message
    # run() resolves once more; that is part of what it adds.
    inside = sum(record.wall_s for record in records)
    added_ms = (ended - resolved - inside) / runs * 1e3
    print(
        f"{runs} runs: {inside / runs * 1e3:.2f} ms each, {added_ms:.2f} ms added; asked {ASKED_MS}"
    )
    print(f"of that, resolving and addressing: {(resolved - began) / runs * 1e3:.2f} ms")
    print(f"processor time of the driver: {processor / runs * 1e3:.2f} ms each")
    print(f"memory: {memory[0]:.0f} MiB at a tenth, {memory[-1]:.0f} MiB at the end")
    print(f"load: {os.getloadavg()[0]:.1f}")
    return 0 if added_ms < ASKED_MS else 1


if __name__ == "__main__":
    sys.exit(main())
