"""Chooses the rooms of tests/ whose tests a run under the sanitizers looks at.

A room's tests depend on the folders whose headers they include, on what those include, and so on;
where they run the program, on all of it. Of each room two stamps are kept once its tests have
passed: one of its own files and those of the room of the mathematics that it is named after, and
one of all that it depends on. Chosen are

  - rooms that read input or drive the platform, where something that they depend on has changed;
  - rooms whose own files have changed;
  - of those where only something further down has changed, a share that the commit's name chooses,
    another one with every commit.

On a new machine nothing has a stamp: a room's own files then count as changed where one of the last
commits touched them.

    python3 tests/rooms.py STAMPS choose     the rooms, a line each; last those that run the program
    python3 tests/rooms.py STAMPS passed ROOM…
"""

import argparse
import hashlib
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

TOP = Path(__file__).resolve().parents[1]
INCLUDE = re.compile(rb'^#include "([^"]+)"', re.MULTILINE)
SOURCES = {".c", ".cpp", ".h", ".py", ".sv", ".rdl", ".toml", ".txt"}
ALWAYS = ("files", "driver", "vp", "app", "fuzz", "serve", "linux")
IN_TURN = (
    *("stability", "statistics", "random", "sparse", "mesh", "fem", "tissue", "fixed", "accel"),
    *("link", "host", "collision", "plant", "fit", "hard_cases", "plant_cases", "tables"),
)
# These run the built program, so that all of it is beneath them, and these the board alone.
WITH_THE_PROGRAM = ("app", "serve", "plant_cases")
WITH_THE_BOARD = ("linux",)
SHARES = 3
RECENT_COMMITS = 30


def git(*arguments: str) -> str:
    """What git prints; nothing outside a clone."""
    run = subprocess.run(
        ["git", "-C", str(TOP), *arguments], check=False, capture_output=True, text=True
    )
    return run.stdout if run.returncode == 0 else ""


@cache
def files_of(folder: str) -> tuple[Path, ...]:
    paths = (TOP / folder).rglob("*")
    return tuple(sorted(p for p in paths if p.is_file() and p.suffix in SOURCES))


@cache
def includes_of(folder: str) -> frozenset[str]:
    """The folders whose headers the files of a folder include."""
    found = set()
    for path in files_of(folder):
        for name in INCLUDE.findall(path.read_bytes()):
            header = TOP / name.decode()
            if header.is_file():
                found.add(str(header.parent.relative_to(TOP)))
    return frozenset(found)


def beneath(room: str) -> set[str]:
    """The folders that a room's tests depend on, its own among them."""
    reached: set[str] = set()
    waiting = [f"tests/{room}"]
    if room in WITH_THE_PROGRAM + WITH_THE_BOARD:
        waiting += ["app", "vp", "driver"]
    while waiting:
        folder = waiting.pop()
        if folder not in reached:
            reached.add(folder)
            waiting += includes_of(folder)
    return reached


def own(room: str) -> set[str]:
    return {f"tests/{room}"} | {
        f"{house}{room}"
        for house in ("models/", "vp/", "app/", "")
        if (TOP / house / room).is_dir()
    }


def stamp(room: str, kind: str, folders: set[str]) -> str:
    content = hashlib.sha256()
    for folder in sorted(folders):
        for path in files_of(folder):
            content.update(f"{path.relative_to(TOP)}\n".encode())
            content.update(path.read_bytes())
    return f"{room}-{kind}-{content.hexdigest()[:32]}"


def lately_touched(room: str) -> bool:
    names = git("log", f"-{RECENT_COMMITS}", "--format=", "--name-only").splitlines()
    return any(name.startswith(tuple(f"{folder}/" for folder in own(room))) for name in names)


def choose(stamps: Path) -> list[str]:
    commit = int(git("rev-parse", "HEAD").strip() or "0", 16)
    chosen = []
    for place, room in enumerate((*ALWAYS, *IN_TURN)):
        if (stamps / stamp(room, "all", beneath(room))).exists():
            continue
        known = any(stamps.glob(f"{room}-own-*"))
        if known:
            changed = not (stamps / stamp(room, "own", own(room))).exists()
        else:
            changed = lately_touched(room)
        if room in ALWAYS or changed or place % SHARES == commit % SHARES:
            chosen.append(room)
    # From nothing there is time for a few rooms, from another one on with every commit.
    turn = commit % max(1, len(chosen))
    chosen = chosen[turn:] + chosen[:turn]
    return sorted(chosen, key=lambda room: room in WITH_THE_PROGRAM)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("stamps", type=Path, help="the folder where what passed is noted")
    parser.add_argument("command", choices=("choose", "passed"))
    parser.add_argument("room", nargs="*")
    arguments = parser.parse_args()
    if arguments.command == "choose":
        print("\n".join(choose(arguments.stamps)))
        return 0
    arguments.stamps.mkdir(parents=True, exist_ok=True)
    for room in arguments.room:
        (arguments.stamps / stamp(room, "own", own(room))).touch()
        (arguments.stamps / stamp(room, "all", beneath(room))).touch()
    return 0


if __name__ == "__main__":
    sys.exit(main())
