"""How far a study is: one line on a terminal's standard error, and nothing elsewhere."""

import sys
import time
from collections.abc import Sequence

from studies.point import Point
from studies.session import Session
from studies.store import Records


class ProgressLine:
    """Called with how many are done and how many there will be."""

    def __init__(self, quiet: bool = False) -> None:
        self._shown = not quiet and sys.stderr.isatty()
        self._started = time.monotonic()
        self._at_start: int | None = None
        self._last = 0.0
        self.done = 0
        self.total = 0

    def __call__(self, done: int, total: int) -> None:
        """Say so, ten times a second at most."""
        self.done, self.total = done, total
        if self._at_start is None:
            self._at_start = done
        now = time.monotonic()
        if not self._shown or (now - self._last < 0.1 and done < total):  # noqa: PLR2004
            return
        self._last = now
        fresh = done - self._at_start
        left = ""
        if fresh and done < total:
            left = f", about {_readable((now - self._started) / fresh * (total - done))} left"
        print(f"\r\033[K{done} of {total} runs{left}", end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        """Wipe the line."""
        if self._shown:
            print("\r\033[K", end="", file=sys.stderr, flush=True)


def _readable(seconds: float) -> str:
    minute, hour = 60, 3600
    if seconds < minute:
        return f"{seconds:.0f} s"
    if seconds < hour:
        return f"{seconds / minute:.0f} min"
    return f"{seconds / hour:.1f} h"


def run_with_progress(session: Session, points: Sequence[Point], quiet: bool = False) -> Records:
    """The records of the points, with a line of progress; says what an interruption has left."""
    progress = ProgressLine(quiet)
    try:
        return session.run(points, progress)
    except KeyboardInterrupt:
        progress.end()
        print(f"{progress.done} of {progress.total} runs are kept; the same command goes on")
        raise
    finally:
        progress.end()
