"""Mistakes in a driver, and what the platform says of each: in the process, and in a Linux kernel.

BUILD has `release`, `linux/plain` and `linux/kasan+lockdep`. Prints docs/driver-bugs.md."""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

TOP = Path(__file__).resolve().parents[1]

_HEAD = """\
# Mistakes in a driver, and who names them

Each is one mistake in a driver that is right without it. Made by
`./hvp tables driver-bugs > docs/driver-bugs.md`; the rules are in
[driver-rules.md](driver-rules.md).

## In the process

`tests/app/board/driver_rules_test.cpp`, with `hvp_board_options.check`. The last column has the
accesses to the BAR between the mistake and its name; a mistake in memory is named at the board's
own access to it.

| mistake | rule | accesses later |
|---|---|---|
"""

_LINUX = """\

## In a Linux kernel

`tests/linux/module_bugs.py`: a line of the module or of the driver's core is another, with
`hvp linux --check driver,dma`. `dma` is a warning about what the kernel has mapped
([DMA that is checked](linux.md#dma-that-is-checked)).

| mistake | named by |
|---|---|
"""


_CHECKED = """\

## In a Linux kernel that looks for more

The same with `hvp linux --check kasan,lockdep` ([a kernel that looks for
more](linux.md#a-kernel-that-looks-for-more)): what only the kernel itself can see. It complains on
its console; the report and `checks` of `summary.json` name it. `./hvp test --long linux` runs
these.

| mistake | named by |
|---|---|
"""


def in_process(build: Path) -> list[str]:
    program = str(build / "release/tests/app/board/test_driver_rules")
    test = "All/DriverMistake.IsNamed/"
    listed = subprocess.run(
        [program, "--gtest_list_tests", f"--gtest_filter={test}*"],
        capture_output=True,
        text=True,
        check=True,
    )
    names = [
        line.split("#")[0].strip().removeprefix("IsNamed/")
        for line in listed.stdout.splitlines()
        if line.startswith("  ")
    ]
    lines = []
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            said = Path(folder) / f"{name}.json"
            # A process has one board.
            subprocess.run(
                [program, f"--gtest_filter={test}{name}", f"--gtest_output=json:{said}"],
                capture_output=True,
                check=False,
            )
            case = json.loads(said.read_text())["testsuites"][0]["testsuite"][0]
            rule = "**unnamed**" if "failures" in case else f"`{case['rule']}`"
            lines.append(f"| {name.replace('_', ' ')} | {rule} | {case.get('later', '')} |")
    return lines


def in_linux(build: Path, variant: str, *words: str) -> list[str]:
    script = str(TOP / "tests" / "linux" / "module_bugs.py")
    guest = build / "linux" / variant
    command = [sys.executable, "-B", script, str(build / "release/app/hvp"), str(guest)]
    done = subprocess.run(
        [*command, str(guest / "variants"), "--lines", *words],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        raise SystemExit(f"driver_bugs.py: {done.stderr[-600:]}")
    return done.stdout.splitlines()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", type=Path)
    build: Path = parser.parse_args().build.resolve()
    print(_HEAD + "\n".join(in_process(build)))
    print(_LINUX + "\n".join(in_linux(build, "plain")))
    print(_CHECKED + "\n".join(in_linux(build, "kasan+lockdep", "--checked")))
    return 0


if __name__ == "__main__":
    sys.exit(main())
