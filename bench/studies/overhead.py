"""What a study of many runs costs beside them: asked are less than 5 ms a run, and memory that
does not grow with them.

    HVP_PROGRAM=build/bench/app/hvp python -m bench.studies.overhead [RUNS]

The runs only take the time of frames, a handful each on a small body, so that they are as short as
runs get, and one is under way at a time. On a machine that is at work elsewhere what is added holds
waiting for a processor too: the processor time of the driver alone stands beside it. The memory is
the driver's, while it runs and once the files are written; it begins with what the packages take.
"""

import os
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from studies.design import points_of
from studies.program import find_program
from studies.session import Session
from studies.store import Store
from studies.study_file import parse
from studies.study_results import Results, write_all

ASKED_MS = 5.0
MOST_RUNS = 10_000
SCENARIO = Path(__file__).resolve().parents[2] / "scenarios" / "thesis.toml"
# Times only, and nothing written that a study does not read.
STUDY = """
scenario = "{scenario}"
set = ["frames=5", "fidelity.numbers=none", "reference=false", "object.mesh.nodes=40"]
[[axis]]
key = "probe.radius"
from = "3 mm"
to = "4 mm"
steps = {runs}
"""


def main() -> int:
    """Print it all; 1 where a run costs more than is asked."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else MOST_RUNS
    file = Path("overhead.toml")
    study = parse(STUDY.format(scenario=SCENARIO, runs=runs), file)
    points = points_of(study, file)
    program = find_program()
    begin = _resident_mib()
    memory: dict[int, float] = {}

    def watch(done: int, _total: int) -> None:
        if done in (runs // 10, runs // 2, runs):
            memory[done] = _resident_mib()

    with tempfile.TemporaryDirectory(prefix="hvp-bench-") as folder:
        session = Session(program, Store(Path(folder) / "store"), workers=1)
        began = time.monotonic()
        processor = time.process_time()
        records = session.run(points, watch)
        added = time.monotonic() - began
        processor = time.process_time() - processor
        ends: Counter[str] = Counter()
        for record in records:
            added -= record.wall_s
            ends[record.status] += 1
        began = time.monotonic()
        results = Results(study, program, points, records)
        files = write_all(Path(folder) / "out", results, file.stem, ["./hvp study overhead.toml"])
        written = time.monotonic() - began
        sizes = [f"{path.name} {path.stat().st_size / 1e6:.2f} MB" for path in files]
    added_ms = added / runs * 1e3
    print(f"{runs} runs, {', '.join(f'{count} {end}' for end, count in ends.items())}")
    print(f"added to a run: {added_ms:.2f} ms; asked {ASKED_MS:g}")
    print(f"of that, processor time of the driver: {processor / runs * 1e3:.2f} ms")
    print(f"results: {written:.1f} s; {', '.join(sizes)}")
    after = ", ".join(f"{mib:.0f} after {done} runs" for done, mib in memory.items())
    print(
        f"memory, MiB: {begin:.0f} at first, {after}, {_resident_mib():.0f} with the files written"
    )
    print(f"load: {os.getloadavg()[0]:.1f}")
    return 0 if added_ms < ASKED_MS else 1


def _resident_mib() -> float:
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20


if __name__ == "__main__":
    sys.exit(main())
