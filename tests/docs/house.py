"""Holds the house's own rules on what includes what, and that documents name files that exist.

The headers of app/results and app/draw reach neither SystemC nor Eigen's solvers, since what only
prints must not take part in compiling a simulation, and nor do the platform's settings. models/
includes nothing of vp/ or app/, and vp/ nothing of app/; some of their rooms have arrows of their
own. models/ starts no process and no thread. A path of a source in a document leads to a file.
"""

import re
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
INCLUDE = re.compile(r'^#include ([<"])([^>"]+)[>"]', re.MULTILINE)
HEAVY = re.compile(
    r"systemc|tlm|tlm_utils/.*|Eigen/(Sparse(Cholesky|LU|QR)|Sparse|Dense|Cholesky|QR|SVD)"
)
LIGHT_ROOMS = ("app/results", "app/draw")
LIGHT_HEADERS = ("vp/platform_settings.h",)
# The registers' trace is a module of the simulation.
WITH_SYSTEMC = {"app/results/board_records.h"}
# A room, and what it must not include.
ARROWS = {
    "models": ("vp/", "app/"),
    "vp": ("app/",),
    "driver": ("models/", "vp/", "app/"),
    # A record and its ledger know no module, the buses no board, and the board no host.
    "vp/frame": ("vp/bus/", "vp/pci/", "vp/pcie/", "vp/fpga/", "vp/host/", "vp/board/"),
    "vp/bus": ("vp/pci/", "vp/pcie/", "vp/fpga/", "vp/host/", "vp/board/"),
    "vp/pci": ("vp/pcie/", "vp/fpga/", "vp/host/", "vp/board/"),
    "vp/pcie": ("vp/pci/", "vp/fpga/", "vp/host/", "vp/board/"),
    "vp/fpga": ("vp/pci/", "vp/pcie/", "vp/host/", "vp/board/"),
    # Results are written for whoever computes them.
    "app/results": (
        *("app/solve/", "app/stability/", "app/record/"),
        *("app/run/", "app/explain/", "app/commands/"),
    ),
}
# A room, and all that it includes.
INCLUDES_ONLY = {"tables": ("tables/", "models/", "app/devices/", "app/mesh/", "app/scenario/")}
# What starts processes and threads, or speaks with them: not the mathematics.
PROCESSES = re.compile(
    r"sys/(wait|prctl|resource|socket)\.h|c?signal(\.h)?|poll\.h|thread|mutex|future"
)
PATH = re.compile(
    r"(?<![\w/.-])((?:models|vp|app|driver|tables|tests|bench)/[\w./*-]+\.(?:cpp|h|cmake|c|py|sv|sh)\b)"
)


@cache
def includes(path: Path) -> tuple[tuple[str, str], ...]:
    return tuple(INCLUDE.findall(path.read_text(encoding="utf-8")))


def way_to_a_heavy_header(path: Path, seen: frozenset[Path] = frozenset()) -> list[str]:
    """The headers from this one to one that it must not reach; empty where there is none."""
    for kind, name in includes(path):
        if kind == "<":
            if HEAVY.fullmatch(name):
                return [name]
            continue
        header = TOP / name
        if not header.is_file() or header in seen:
            continue
        way = way_to_a_heavy_header(header, seen | {path})
        if way:
            return [name, *way]
    return []


def sources(room: str) -> list[Path]:
    return sorted(p for p in (TOP / room).rglob("*") if p.suffix in {".h", ".c", ".cpp"})


def heavy_headers() -> Iterator[str]:
    headers = [path for room in LIGHT_ROOMS for path in sources(room) if path.suffix == ".h"]
    for path in [*headers, *(TOP / name for name in LIGHT_HEADERS)]:
        name = str(path.relative_to(TOP))
        way = [] if name in WITH_SYSTEMC else way_to_a_heavy_header(path)
        if way:
            yield f"{name} reaches {way[-1]}: {' -> '.join(way)}"


def includes_against_the_arrows() -> Iterator[str]:
    for room, others in ARROWS.items():
        for path in sources(room):
            for kind, name in includes(path):
                if kind == '"' and name.startswith(others):
                    yield f"{path.relative_to(TOP)} includes {name}, against the arrows"
    for room, rooms in INCLUDES_ONLY.items():
        for path in sources(room):
            for kind, name in includes(path):
                if kind == '"' and not name.startswith(rooms):
                    yield f"{path.relative_to(TOP)} includes {name}, against the arrows"


def processes_of_models() -> Iterator[str]:
    for path in sources("models"):
        for kind, name in includes(path):
            if kind == "<" and PROCESSES.fullmatch(name):
                yield f"{path.relative_to(TOP)} includes <{name}>: models/ starts nothing"


def lost_paths() -> Iterator[str]:
    for page in [TOP / "README.md", TOP / "CONTRIBUTING.md", *sorted((TOP / "docs").rglob("*.md"))]:
        for name in PATH.findall(page.read_text(encoding="utf-8")):
            if not any(TOP.glob(name)):
                yield f"{page.relative_to(TOP)} names {name}, which is not there"


def main() -> int:
    found = [
        *heavy_headers(),
        *includes_against_the_arrows(),
        *processes_of_models(),
        *lost_paths(),
    ]
    print("\n".join(found) if found else "what includes what is as the house has it")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
