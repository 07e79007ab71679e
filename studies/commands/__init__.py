"""A module a command: its arguments, and what it does with them."""

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING

from studies.commands.compare import add_compare
from studies.commands.questions import add_questions
from studies.commands.report import add_report
from studies.commands.scenario_studies import add_scenario_studies
from studies.commands.study import add_study
from studies.commands.sweep import add_sweep
from studies.commands.task import add_task

if TYPE_CHECKING:
    Subparsers = argparse._SubParsersAction[argparse.ArgumentParser]

# What adds a command to the command line, in the order of `--help`.
COMMANDS: list[Callable[["Subparsers"], None]] = [
    add_study,
    add_scenario_studies,
    add_sweep,
    add_compare,
    add_report,
    add_questions,
    add_task,
]
