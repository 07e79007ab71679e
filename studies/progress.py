"""How far a study is, on standard error: one line on a terminal that changes, elsewhere one now and
then."""

import sys
import time
from collections.abc import Sequence

from studies.point import Point
from studies.session import Session
from studies.store import Records

# Between two looks, in seconds: of a person at a terminal, and of a log that somebody reads later.
_ON_TERMINAL = 0.1
_IN_LOG = 30.0


class ProgressLine:
    """Called with how many are done and how many there will be."""

    def __init__(self, quiet: bool = False) -> None:
        self._shown = not quiet
        self._terminal = sys.stderr.isatty()
        self._pause = _ON_TERMINAL if self._terminal else _IN_LOG
        self._started = time.monotonic()
        self._at_start: int | None = None
        # A terminal has its line at once, a log only where there is something to wait for.
        self._last = 0.0 if self._terminal else self._started
        self.done = 0
        self.total = 0

    def __call__(self, done: int, total: int) -> None:
        """Say so, as often as somebody looks."""
        self.done, self.total = done, total
        if self._at_start is None:
            self._at_start = done
        now = time.monotonic()
        last_on_terminal = self._terminal and done == total
        if not self._shown or (now - self._last < self._pause and not last_on_terminal):
            return
        self._last = now
        fresh = done - self._at_start
        left = ""
        if fresh and done < total:
            left = f", about {_readable((now - self._started) / fresh * (total - done))} left"
        text = f"{done} of {total} runs{left}"
        if self._terminal:
            print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)
        else:
            print(text, file=sys.stderr, flush=True)

    def end(self) -> None:
        """Wipe the line."""
        if self._shown and self._terminal:
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
