"""The way from a key of a TOML file back to its line: tomllib does not keep it."""

import re
from collections.abc import Sequence


def line_of(text: str, location: Sequence[int | str]) -> int:
    """The line of a key, or of the nearest table around it that the text has; from 1.

    `location` is a path of names and indices, as ("axis", 1, "key").
    """
    names = [part for part in location if isinstance(part, str)]
    if not names:
        return 1
    index = next((part for part in location if isinstance(part, int)), 0)
    table_line, last = 1, 0
    lines = text.splitlines()
    is_table = len(location) > 1 or _header(lines, names[0], 0) is not None
    if is_table:
        start = _header(lines, names[0], index)
        if start is not None:
            table_line = last = start
    key = names[1] if is_table and len(names) > 1 else names[0]
    if is_table and len(names) == 1:
        return table_line
    for number, line in enumerate(lines[last:], start=last + 1):
        if re.match(rf"\s*[\"']?{re.escape(key)}[\"']?\s*(=|\.)", line):
            return number
        if is_table and number > last and re.match(r"\s*\[", line):
            break
    return table_line


def _header(lines: Sequence[str], name: str, index: int) -> int | None:
    found = [
        number
        for number, line in enumerate(lines, start=1)
        if re.match(rf"\s*\[\[?\s*{re.escape(name)}\s*\]", line)
    ]
    return found[index] if index < len(found) else None
