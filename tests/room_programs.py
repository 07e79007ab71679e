"""Checks that a room's tests run only programs that building the room builds.

Steps of ./hvp test build a room at a time: a program of another room is there or not, as chance has
it.

    python3 tests/room_programs.py BUILD
"""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

LINKED = re.compile(r" -o (\S+)")


def printed(*command: str) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def main() -> int:
    build = Path(sys.argv[1]).resolve()
    missing = set()
    for folder in sorted((build / "tests").iterdir()):
        if not (folder / "CTestTestfile.cmake").is_file():
            continue
        room = folder.name
        commands = printed("ninja", "-C", str(build), "-t", "commands", f"tests/{room}/all")
        built = {build / name for name in LINKED.findall(commands)}
        tests = printed("ctest", "--test-dir", str(folder), "--show-only=json-v1")
        for test in json.loads(tests)["tests"]:
            for word in test.get("command", []):
                path = Path(word)
                if build in path.parents and os.access(path, os.X_OK) and path not in built:
                    missing.add(f"tests/{room}/all does not build {path.relative_to(build)}")
    print("\n".join(sorted(missing)))
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
