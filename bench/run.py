"""Runs the benchmarks of a build, for a moment or in full, and keeps their figures.

    python3 bench/run.py --build build/release --moment       whether each of them runs
    python3 bench/run.py --build build/release --keep FOLDER  figures into FOLDER/MACHINE.json

Only ratios within one run mean something on a machine that others share: of each case the time over
the geometric mean of its program's cases is compared with that of the last run that was kept for a
machine of this name. A ratio that has become LARGEST_CHANGE times another one fails.
"""

import argparse
import json
import math
import platform
import subprocess
import sys
import tempfile
from pathlib import Path

LARGEST_CHANGE = 1.5
LONGEST_S = 1200
OWN_MAIN = (
    "bench_frame",
    "bench_platform",
    "bench_speed",
)  # print a table; how often is their argument
# A kernel's boot is no moment, and needs a guest that the step `linux` builds and tries.
NOT_FOR_A_MOMENT = ("bench_linux",)

Figures = dict[str, dict[str, float]]


def machine() -> str:
    for line in Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.partition(":")[2].strip().replace("/", " ")
    return platform.machine()


def programs(build: Path) -> list[Path]:
    found = sorted((build / "bench").glob("*/bench_*"))
    return [path for path in found if path.is_file() and path.stat().st_mode & 0o100]


def command_of(program: Path, moment: bool, output: Path) -> list[str]:
    if program.name in OWN_MAIN:
        return [str(program), "1" if moment else "5"]
    command = [str(program), f"--benchmark_out={output}", "--benchmark_out_format=json"]
    return [*command, "--benchmark_min_time=0.001"] if moment else command


def figures_of(output: Path) -> dict[str, float]:
    if not output.is_file():
        return {}
    cases = json.loads(output.read_text())["benchmarks"]
    return {
        case["name"]: float(case["cpu_time"])
        for case in cases
        if case.get("run_type", "iteration") == "iteration" and case.get("cpu_time", 0) > 0
    }


def ratios(figures: dict[str, float]) -> dict[str, float]:
    if not figures:
        return {}
    mean = math.exp(sum(math.log(time) for time in figures.values()) / len(figures))
    return {name: time / mean for name, time in figures.items()}


def changes(before: Figures, now: Figures) -> list[str]:
    lines = []
    for program, figures in now.items():
        common = before.get(program, {}).keys() & figures.keys()
        old = ratios({name: before[program][name] for name in common})
        for name, ratio in ratios({name: figures[name] for name in common}).items():
            if not 1 / LARGEST_CHANGE < ratio / old[name] < LARGEST_CHANGE:
                lines.append(f"{program} {name}: {ratio / old[name]:.2f} times what it was")
    return lines


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=Path, required=True)
    parser.add_argument("--moment", action="store_true")
    parser.add_argument("--keep", type=Path, help="the folder of figures by machine")
    arguments = parser.parse_args()
    chosen = programs(arguments.build)
    if not chosen:
        print(f"no benchmark is built in {arguments.build}")
        return 1
    failed = 0
    now: Figures = {}
    for program in chosen:
        if arguments.moment and program.name in NOT_FOR_A_MOMENT:
            print(f"left out: {program.name}: not for a moment; ./hvp bench runs it")
            continue
        with tempfile.TemporaryDirectory(prefix="hvp-bench-") as folder:
            output = Path(folder) / "figures.json"
            run = subprocess.run(
                command_of(program, arguments.moment, output),
                check=False,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                timeout=LONGEST_S,
            )
            now[program.name] = figures_of(output)
        cases = len(now[program.name])
        print(f"{program.name}: exit {run.returncode}, {cases} cases", flush=True)
        if run.returncode != 0 or (cases == 0 and program.name not in OWN_MAIN):
            failed += 1
            print(run.stdout, flush=True)
        elif not arguments.moment:
            print(run.stdout, flush=True)
    if arguments.keep:
        arguments.keep.mkdir(parents=True, exist_ok=True)
        kept = arguments.keep / f"{machine()}.json"
        before = json.loads(kept.read_text())["figures"] if kept.is_file() else {}
        lines = changes(before, now)
        print("\n".join(lines) if lines else "no ratio has changed by more than half")
        failed += len(lines)
        if not lines:
            text = json.dumps({"machine": machine(), "unit": "ns", "figures": now}, indent=1)
            kept.write_text(text + "\n")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
