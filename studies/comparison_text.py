"""A comparison of runs as a terminal shows it."""

import string
import textwrap
from collections.abc import Sequence

from studies.comparison import Comparison, Names, Row
from studies.frame_comparison import FrameDifferences, Where
from studies.point import Value
from studies.text_table import cell

_INDENT = "  "
_LEAST_NAME = 34  # columns, of a key; values that leave less have lines of their own
_LONG_TABLE = 4  # settings: more that only some runs have are one line
_DIGITS = 4
_ALL_DIGITS = 17
_PS_US = 1e-6
_SMALL = 0.01  # of the worst frame: phases below are summed up

# Where a figure stands, by the first word of its name.
_SECTIONS = {
    "Time": ("deadline", "latency", "jitter", "load", "set_up_us", "frames_asked", "held"),
    "Force": ("force", "forces", "contact", "missed_contact", "strain"),
    "Accuracy": ("accuracy", "error_budget", "refinement", "condition"),
    "Energy and stiffness": ("loop", "stiffness"),
    "Stability": ("stability", "remedy", "driver", "faults"),
}
_REST = "Board, bus and body"


def letters(count: int) -> list[str]:
    """What the runs are called in tables: their folders are too long."""
    return list(string.ascii_uppercase[:count]) if count <= 26 else [str(n) for n in range(count)]  # noqa: PLR2004


def comparison_text(comparison: Comparison, width: int, *, everything: bool = False) -> str:
    """What differs, in lines of at most `width` where the words allow it; `everything`: all."""
    names = letters(len(comparison.runs))
    blocks = [_legend(comparison, names)]
    if comparison.same:
        blocks.append("The same: settings, figures, flags and every frame.")
    settings = comparison.settings if everything else _without_long_tables(comparison.settings)
    blocks.append(_table("Settings", _chosen(settings, everything), names, width))
    blocks += [_which(title, which, names) for title, which in _names_of(comparison, everything)]
    hidden = 0
    for title, rows in _sections(comparison.figures):
        chosen = _chosen(rows, everything)
        shown = [row for row in chosen if everything or not row.breakdown]
        hidden += len(chosen) - len(shown)
        blocks.append(_table(title, shown, names, width))
    blocks.append(_worst_frames(comparison, names, width, everything))
    blocks += [
        _frames(f"Frames of {names[0]} and {name}", differences, (names[0], name), width)
        for name, differences in zip(names[1:], comparison.frames, strict=True)
        if everything or differences.differ
    ]
    if not comparison.same or everything:
        blocks.append(_table("Host time", _chosen(comparison.performance, True), names, width))
    if hidden:
        blocks.append(f"{hidden} figures more differ, of parts, phases and transfers: --all")
    return "\n\n".join(block for block in blocks if block) + "\n"


def _legend(comparison: Comparison, names: Sequence[str]) -> str:
    lines = []
    wide = max(len(str(run.path)) for run in comparison.runs)
    for name, run in zip(names, comparison.runs, strict=True):
        lines.append(f"{name}  {str(run.path).ljust(wide)}  {run.summary.get('verdict', '')}")
        if run.partial:
            deadline = run.summary["deadline"]
            done = deadline["frames"] + deadline.get("skipped_ticks", 0)
            asked = run.summary.get("frames_asked")
            lines.append(f"   interrupted at frame {done} of {asked}: figures are of those")
    return "\n".join(lines)


def _chosen(rows: Sequence[Row], everything: bool) -> list[Row]:
    return [row for row in rows if everything or row.differs]


def _without_long_tables(settings: Sequence[Row]) -> list[Row]:
    """A long table that only some runs have is one row: of interest is that they have it."""
    tables: dict[tuple[str, tuple[bool, ...]], list[Row]] = {}
    for row in settings:
        having = tuple(value is not None for value in row.values)
        tables.setdefault((row.key.partition(".")[0], having), []).append(row)
    short = []
    for (table, having), rows in tables.items():
        if len(rows) > _LONG_TABLE and not all(having):
            words = tuple(f"{len(rows)} keys" if has else None for has in having)
            short.append(Row(f"[{table}]", "", words, (None,) * len(having)))
        else:
            short += rows
    return short


def _sections(figures: Sequence[Row]) -> list[tuple[str, list[Row]]]:
    found: dict[str, list[Row]] = {title: [] for title in (*_SECTIONS, _REST)}
    for row in figures:
        head = row.key.partition(".")[0].partition("[")[0]
        title = next((title for title, heads in _SECTIONS.items() if head in heads), _REST)
        found[title].append(row)
    return list(found.items())


def _texts(row: Row, *, changes: bool = True) -> list[str]:
    """The values of a row, with as many digits as tell them apart."""
    numbers = [value for value in row.values if isinstance(value, float)]
    digits = next(
        digits
        for digits in range(_DIGITS, _ALL_DIGITS + 1)
        if len({f"{number:.{digits}g}" for number in numbers}) == len(set(numbers))
        or digits == _ALL_DIGITS
    )
    texts = []
    for position, (value, change) in enumerate(zip(row.values, row.changes, strict=True)):
        texts.append(f"{value:.{digits}g}" if isinstance(value, float) else cell(value))
        if position and changes:
            texts.append(f"{100 * change:+.3g} %" if change else "")
    return texts


def _table(title: str, rows: Sequence[Row], names: Sequence[str], width: int) -> str:
    """A row a key, the values side by side. What is too wide for that stands in lines below."""
    if not rows:
        return ""
    each = [(row, _texts(row, changes=any(any(row.changes) for row in rows))) for row in rows]
    header = [names[0]]
    for name in names[1:]:
        header += [name] + ([""] if len(each[0][1]) > len(names) else [])
    units = max(len(row.unit) for row in rows)
    longest = max(12, (width - _LEAST_NAME) // len(names))
    fitting = [(row, texts) for row, texts in each if max(map(len, texts)) <= longest]
    columns = [
        max([len(head), *(len(texts[column]) for _, texts in fitting)])
        for column, head in enumerate(header)
    ]
    room = (
        width - len(_INDENT) - sum(column + 2 for column in columns) - (units + 2 if units else 0)
    )
    if room < len(title):
        room = 0
    fitting = [(row, texts) for row, texts in fitting if len(row.key) <= room]
    wide = max([len(title) - len(_INDENT), *(len(row.key) for row, _ in fitting)])
    lines = []
    if fitting:
        lines.append(_line(title.ljust(wide + len(_INDENT)), " " * units, header, columns))
    else:
        lines.append(title)
    for row, texts in each:
        if (row, texts) in fitting:
            lines.append(
                _line(_INDENT + row.key.ljust(wide), row.unit.ljust(units), texts, columns)
            )
        else:
            lines += _stacked(row, names, width)
    return "\n".join(lines)


def _line(name: str, unit: str, texts: Sequence[str], columns: Sequence[int]) -> str:
    cells = [text.rjust(column) for text, column in zip(texts, columns, strict=True)]
    return "  ".join([name, *([unit] if unit else []), *cells]).rstrip()


def _stacked(row: Row, names: Sequence[str], width: int) -> list[str]:
    texts = iter(_texts(row))
    lines = [_INDENT + row.key + (f", {row.unit}" if row.unit else "")]
    for position, name in enumerate(names):
        value = next(texts)
        change = next(texts) if position else ""
        lines += textwrap.wrap(
            f"{name}  {value}" + (f"  ({change})" if change else ""),
            width,
            initial_indent=2 * _INDENT,
            subsequent_indent=4 * _INDENT,
        )
    return lines


def _names_of(comparison: Comparison, everything: bool) -> list[tuple[str, Names]]:
    both = [("Effects", comparison.effects), ("Flags", comparison.flags)]
    return [(title, names) for title, names in both if everything or names.differs]


def _which(title: str, which: Names, names: Sequence[str]) -> str:
    """What every run has on one line, the rest by who has it."""
    lines = [title]
    for one in which.every:
        having = [name for name, its in zip(names, which.of_run, strict=True) if one in its]
        whose = "all" if len(having) == len(names) else "only " + ", ".join(having)
        lines.append(f"{_INDENT}{one.ljust(max(map(len, which.every)))}  {whose}")
    return "\n".join(lines)


def _worst_frames(
    comparison: Comparison, names: Sequence[str], width: int, everything: bool
) -> str:
    """The critical paths of the worst frames side by side; they sum to their latencies."""
    rows = comparison.attribution
    if not everything and not any(row.differs for row in rows):
        return ""
    count = len(names)
    sums = [sum(_us(row.values[run]) for row in rows) for run in range(count)]
    large = [
        row
        for row in rows
        if any(_us(row.values[run]) >= _SMALL * sums[run] > 0 for run in range(count))
    ]
    large.sort(key=lambda row: -max(map(_us, row.values)))
    small = [row for row in rows if row not in large]
    if small:
        large.append(_sum_row(f"other, {len(small)} phases", small, count))
    large.append(_sum_row("sum", rows, count))
    table = _table("Worst frame", large, names, width)
    frames = [run.summary["deadline"].get("worst_frame") for run in comparison.runs]
    which = ", ".join(f"{name}: {frame}" for name, frame in zip(names, frames, strict=True))
    return f"{table}\n{_INDENT}frame number {which}"


def _us(value: Value) -> float:
    return float(value) if isinstance(value, int | float) else 0.0


def _sum_row(key: str, rows: Sequence[Row], count: int) -> Row:
    # Times are whole picoseconds: more digits would show how a sum was rounded.
    sums = tuple(
        round(sum(_us(row.values[run]) for row in rows) / _PS_US) * _PS_US for run in range(count)
    )
    changes = tuple((one - sums[0]) / sums[0] if sums[0] else None for one in sums)
    return Row(key, "µs", sums, changes)


def _frames(title: str, differences: FrameDifferences, names: tuple[str, str], width: int) -> str:
    lines = [f"{what}: not compared" for what in differences.left_out]
    if differences.common:
        lines.append(_lengths(differences, names))
        if differences.forces_compared and differences.first_force is None:
            lines.append("every force is the same")
        if differences.first_force is not None and differences.largest_force is not None:
            lines.append("the force first differs in " + _at(differences.first_force, names, "N"))
            lines.append("and most in " + _at(differences.largest_force, names, "N"))
        if differences.largest_latency is None:
            lines.append("every latency is the same")
        else:
            lines.append(
                "the latency differs most in " + _at(differences.largest_latency, names, "µs")
            )
    wrapped = [
        textwrap.fill(line, width, initial_indent=_INDENT, subsequent_indent=2 * _INDENT)
        for line in lines
    ]
    return "\n".join([title, *wrapped])


def _lengths(differences: FrameDifferences, names: tuple[str, str]) -> str:
    if differences.frames == (differences.common, differences.common):
        return f"{differences.common} frames of the same ticks"
    here, there = differences.frames
    return (
        f"{names[0]} has {here} frames and {names[1]} {there}; "
        f"{differences.common} are of the same ticks and compared"
    )


def _at(where: Where, names: tuple[str, str], unit: str) -> str:
    frame = f"frame {where.frame}"
    if where.other_frame != where.frame:
        frame += f" of {names[0]} and {where.other_frame} of {names[1]}"
    probe = f", probe {where.probe}" if where.probe else ""
    difference = Row("", unit, where.values, (None, None))
    values = _texts(difference, changes=False)
    return (
        f"{frame} ({where.time_us * _PS_US:.6g} s{probe}): {values[0]} {unit} and "
        f"{values[1]} {unit}, apart by {where.difference:.4g} {unit}"
    )
