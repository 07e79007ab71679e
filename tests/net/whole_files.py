"""What no folder of results may hold: a file that was left unfinished, and an infinity or what is
not a number in any text."""

import re
from collections.abc import Iterator
from pathlib import Path

TEXTS = (".csv", ".json", ".toml", ".pvd", ".log")
NOT_FINITE = re.compile(r"(?<![A-Za-z_])-?(?:inf|nan)(?![A-Za-z_])", re.IGNORECASE)


def not_finite(text: str) -> str:
    """The first such number with what is around it, empty where there is none."""
    # Hardly a file has these letters, and the expression takes twenty times as long to say so.
    small = text.lower()
    if "inf" not in small and "nan" not in small:
        return ""
    found = NOT_FINITE.search(text)
    return "" if found is None else text[max(0, found.start() - 60) : found.end() + 10]


def complaints(folder: Path, printed: str) -> Iterator[str]:
    """Of what a run left there and printed."""
    texts = [("the terminal", printed)]
    for path in sorted(folder.rglob("*")):
        if ".part" in path.name:
            yield f"left {path.name}"
        elif path.suffix in TEXTS:
            texts.append((path.name, path.read_text(encoding="utf-8")))
    for name, text in texts:
        found = not_finite(text)
        if found:
            yield f"has no finite number in {name}: …{found!r}"
