"""A study with a scheduler as a process of its own, so that a test can kill it:

scale_driver.py PROGRAM SCENARIO STORE SCHEDULER KEY=VALUE…
"""

import sys
from pathlib import Path

from studies.carry_dask import DaskCarrier
from studies.errors import FAILED, StudyError
from studies.point import Point
from studies.program import Program
from studies.session import Session
from studies.store import Store


def main() -> int:
    """Run a point for each setting; the exit status is that of a study."""
    program, scenario, store, scheduler, *settings = sys.argv[1:]
    points = [Point(Path(scenario), ("frames=20", setting)) for setting in settings]
    carrier = DaskCarrier(scheduler, connect_s=5)
    try:
        Session(Program(Path(program)), Store(Path(store)), carrier=carrier).run(points)
    except StudyError as error:
        print(f"hvp: {error}", file=sys.stderr)
        return FAILED
    return 0


if __name__ == "__main__":
    sys.exit(main())
