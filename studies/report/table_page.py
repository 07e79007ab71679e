"""The report of a table of runs, as a search and a sweep have one."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import pandas as pd

from studies.point import Value
from studies.program import Program
from studies.report.study_page import Plot, write_study_report
from studies.results import Column


def write_table_report(  # noqa: PLR0913
    folder: Path,
    *,
    title: str,
    columns: Sequence[Column],
    rows: Sequence[Mapping[str, Value]],
    plots: list[Plot],
    words: list[str],
    command: str,
    program: Program,
) -> Path:
    """Write folder/report.html from what results.csv has."""
    return write_study_report(
        folder,
        title=title,
        frame=pd.DataFrame(
            [{column.name: row.get(column.name) for column in columns} for row in rows],
            columns=[column.name for column in columns],
        ),
        units={column.name: column.unit for column in columns if column.unit},
        helps={column.name: column.help for column in columns},
        plots=plots,
        words=words,
        commands=[command],
        versions={"hvp": program.version.removeprefix("hvp ")},
    )
