"""How far a study is, on a terminal's last line."""

import sys

from studies.session import Progress


def progress_line() -> Progress | None:
    """Writes to stderr where that is a terminal; nothing else has a use for it."""
    if not sys.stderr.isatty():
        return None

    def show(done: int, total: int) -> None:
        end = "\r\033[K" if done == total else ""
        print(f"\r\033[K{done} of {total} runs{end}", end="", file=sys.stderr, flush=True)

    return show
