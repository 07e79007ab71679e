"""The thesis' Tables 4.1 and 4.2 and what this solver has beside them, from their page in docs/."""

import re
from functools import cache
from pathlib import Path

from studies.errors import StudyError

PAGE = Path(__file__).resolve().parents[2] / "docs" / "thesis-tables.md"

# Error by number of iterations.
Column = dict[int, float]

# By method: the heading of its table on the page, its row of the thesis, and its rows of this
# solver and of double precision there, and in the table of a load that is random itself.
_SMOOTH = {"CG": "Table 4.1", "Jacobi-PCG": "Table 4.2"}
_SHORT = {"CG": "CG", "Jacobi-PCG": "PCG"}
_RANDOM = "A random load"


@cache
def thesis(method: str) -> Column:
    """What the thesis has measured: about 1000 nodes, a smooth load, from zero."""
    return _row(_SMOOTH[method], f"thesis, {_SHORT[method]}")


@cache
def smooth(method: str, who: str = "**this solver, {}**") -> Column:
    """What this solver, or double precision, has in the thesis' set-up."""
    return _row(_SMOOTH[method], who.format(_SHORT[method]))


@cache
def random_load(method: str) -> Column:
    """What this solver has there under a load that is random itself."""
    return _row(_RANDOM, f"this solver, {_SHORT[method]}")


def _row(section: str, name: str) -> Column:
    """Throws StudyError where the page has no such row."""
    text = PAGE.read_text(encoding="utf-8")
    part = re.search(rf"^## {re.escape(section)}.*?(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)
    lines = [line.strip("|").split("|") for line in (part[0] if part else "").splitlines()]
    rows = {cells[0].strip(): [cell.strip() for cell in cells[1:]] for cells in lines}
    counts = next((cells for cells in rows.values() if cells[:1] == ["30"]), None)
    if counts is None or name not in rows:
        raise StudyError(f"{PAGE.name}: expected a row {name} below {section}")
    return {
        int(count): float(error)
        for count, error in zip(counts, rows[name], strict=True)
        if count.isdigit()
    }
