"""How much faster two local workers finish a study than one: asked are 1.8 times, of runs that take
about a second each.

    HVP_PROGRAM=build/bench/app/hvp python -m bench.studies.two_workers [RUNS] [REPETITIONS]

Each way is tried so many times, in turns, so that a machine that slows down slows both; the best of
each is compared. A machine whose other processors are at work measures those.
"""

import os
import sys
import tempfile
import time
from pathlib import Path

from studies.point import Point
from studies.program import Program, find_program
from studies.session import Session
from studies.store import Store

ASKED = 1.8
SCENARIO = Path(__file__).resolve().parents[2] / "scenarios" / "thesis.toml"
FRAMES = 1000  # about a second, in the company of double precision


def seconds(program: Program, workers: int, runs: int) -> tuple[float, float]:
    """Of a study from an empty store; and the longest of its runs."""
    points = [
        Point(SCENARIO, (f"frames={FRAMES}", f"probe.radius={3 + n / 100} mm")) for n in range(runs)
    ]
    with tempfile.TemporaryDirectory(prefix="hvp-bench-") as folder:
        session = Session(program, Store(Path(folder)), workers=workers)
        began = time.monotonic()
        records = session.run(points)
        took = time.monotonic() - began
        assert all(record.done for record in records), "every run has figures"
        return took, max(record.wall_s for record in records)


def main() -> int:
    """Print the ratio; 1 where it is below what is asked."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 8
    repetitions = int(sys.argv[2]) if len(sys.argv) > 2 else 3  # noqa: PLR2004
    program = find_program()
    took: dict[int, list[float]] = {1: [], 2: []}
    for _ in range(repetitions):
        for workers, times in took.items():
            total, longest = seconds(program, workers, runs)
            times.append(total)
            print(f"{workers} at once: {runs} runs in {total:.2f} s, longest {longest:.2f} s")
    ratio = min(took[1]) / min(took[2])
    load = os.getloadavg()[0]
    print(f"two workers are {ratio:.2f} times one; asked {ASKED}; load before the end {load:.1f}")
    return 0 if ratio >= ASKED else 1


if __name__ == "__main__":
    sys.exit(main())
