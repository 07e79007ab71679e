"""The driver's suite on a board behind a socket and on the same board in the suite's process.

Both pass what they run, and where a case solves, the words of U are the same.

    compare_suite.py HVP OVER_SOCKET IN_PROCESS [--fault KIND] SCENARIO [--set KEY=VALUE]…
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from served import LIMIT_S, Served

Case = dict[str, Any]


def cases(command: list[str]) -> dict[str, Case]:
    done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, check=False)
    # The board's own warnings are between the cases.
    lines = [line for line in done.stdout.splitlines() if line.startswith('{"case"')]
    found = [json.loads(line) for line in lines]
    if not found or done.returncode not in (0, 1):
        raise SystemExit(f"{command[0]}: status {done.returncode}: {done.stderr}")
    return {case["case"]: case for case in found}


def main() -> int:
    hvp, over_socket, in_process, *rest = sys.argv[1:]
    fault: list[str] = []
    if rest[0] == "--fault":
        fault, rest = rest[:2], rest[2:]
    here = cases([in_process, *rest, *fault])
    with tempfile.TemporaryDirectory() as folder:
        socket = Path(folder) / "board"
        with Served(Path(hvp), rest, socket):
            there = cases([over_socket, str(socket), *fault])
    wrong = [f"{name}: only in one" for name in here.keys() ^ there.keys()]
    for name in here.keys() & there.keys():
        one, other = here[name], there[name]
        print(f"{name}: {other['result']} {other.get('reason', '')}")
        if other["result"] == "fail":
            wrong.append(f"{name}: {other['reason']}")
        elif one["result"] == other["result"] == "pass" and one.get("u") != other.get("u"):
            wrong.append(f"{name}: other words of U than in the process")
    print("\n".join(wrong))
    solved = sum("u" in case for case in there.values())
    return 1 if wrong or not (fault or solved) else 0


if __name__ == "__main__":
    sys.exit(main())
