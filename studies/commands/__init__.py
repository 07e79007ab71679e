"""A module a command: its arguments, and what it does with them."""

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING

from studies.commands.questions import add_questions

if TYPE_CHECKING:
    Subparsers = argparse._SubParsersAction[argparse.ArgumentParser]

# What adds a command to the command line, in the order of `--help`.
COMMANDS: list[Callable[["Subparsers"], None]] = [add_questions]
