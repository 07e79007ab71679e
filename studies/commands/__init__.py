"""A module a command: its arguments, and what it does with them."""

import argparse
import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    Subparsers = argparse._SubParsersAction[argparse.ArgumentParser]

# Command: its module here, what adds it to the command line, and its line of `--help`, in that
# page's order. A module is imported where its command is called: pandas, SciPy and matplotlib
# take a second and a half together, and most commands need one of them or none.
COMMANDS: dict[str, tuple[str, str, str]] = {
    "study": ("study", "add_study", "run a scenario over axes of its keys"),
    "study screen": ("screen", "add_screen", "which effects and fidelity levels the answers need"),
    "study accuracy": ("accuracy", "add_accuracy", "what accuracy costs in time"),
    "study solvers": ("solvers", "add_solvers", "who should solve: the board or a core"),
    "sweep": ("sweep", "add_sweep", "run a scenario with every value of a key"),
    "compare": ("compare", "add_compare", "what differs between runs"),
    "report": ("report", "add_report", "a run as one page for a browser"),
    "questions": ("questions", "add_questions", "write the pages of docs/questions/ from runs"),
    "task": ("task", "add_task", "run a share of what --slurm has written"),
}


def add_command(name: str, subparsers: "Subparsers") -> None:
    """Add one with its arguments."""
    module, function, _ = COMMANDS[name]
    getattr(importlib.import_module(f"studies.commands.{module}"), function)(subparsers)
