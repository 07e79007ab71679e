"""`hvp study screen` and `hvp study accuracy`: studies that need no study file."""

import argparse
from collections.abc import Callable
from typing import Any

from studies.commands import accuracy, screen

# A word after `study`: its arguments, what runs it, and a line of help.
SCENARIO_STUDIES: dict[
    str, tuple[Callable[[argparse.ArgumentParser], None], Callable[[argparse.Namespace], int], str]
] = {
    "accuracy": (accuracy.declare, accuracy.run, "what accuracy costs in time"),
    "screen": (screen.declare, screen.run, "which effects and fidelity levels the answers need"),
}


def add_scenario_studies(subparsers: Any) -> None:
    """As commands of their own, `study-screen` and its like."""
    for name, (declare, run, text) in SCENARIO_STUDIES.items():
        parser = subparsers.add_parser(f"study-{name}", help=text)
        declare(parser)
        parser.set_defaults(run=run)
