"""The way from a key of a TOML file back to its line: tomllib does not keep it."""

import re
from collections.abc import Sequence


def line_of(text: str, location: Sequence[int | str]) -> int:
    """The line of a key, or of the nearest table around it that the text has; from 1.

    `location` is a path of names and indices, as ("axis", 1, "choice", 0, "set").
    """
    lines = text.splitlines()
    tables: list[str] = []
    begin = 0
    rest = list(location)
    while rest:
        index = rest[1] if len(rest) > 1 and isinstance(rest[1], int) else None
        headers = _headers(lines, [*tables, str(rest[0])], begin)
        if len(headers) <= (index or 0):
            break
        begin = headers[index or 0]
        tables.append(str(rest[0]))
        rest = rest[1:] if index is None else rest[2:]
    for number, line in enumerate(lines[begin:], start=begin + 1):
        if not rest or (tables and re.match(r"\s*\[", line)):
            break
        if re.match(rf"\s*[\"']?{re.escape(str(rest[0]))}[\"']?\s*(=|\.)", line):
            return number
    return begin or 1


def _headers(lines: Sequence[str], names: Sequence[str], begin: int) -> list[int]:
    """The lines below one that begin a table of that name."""
    name = r"\s*\.\s*".join(map(re.escape, names))
    return [
        number
        for number, line in enumerate(lines[begin:], start=begin + 1)
        if re.match(rf"\s*\[\[?\s*{name}\s*\]", line)
    ]
