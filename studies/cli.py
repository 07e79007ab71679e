"""The command line of what is Python here. `./hvp` hands study, sweep, compare and report to it."""

import argparse
import signal
import sys
from collections.abc import Sequence
from typing import NoReturn

from studies import errors
from studies.commands import COMMANDS, add_command


class _Parser(argparse.ArgumentParser):
    """One line for wrong usage, as the program itself prints."""

    def error(self, message: str) -> NoReturn:
        print(f"{self.prog}: {message}; {self.prog} --help lists what it takes", file=sys.stderr)
        sys.exit(errors.WRONG_INPUT)


def parser(words: Sequence[str] = ()) -> argparse.ArgumentParser:
    """The command line: the command that the words begin with whole, the others by their names."""
    top: argparse.ArgumentParser = _Parser(
        prog="hvp", description="Questions that take more than one run."
    )
    subparsers = top.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, (_, _, text) in COMMANDS.items():
        if words[:1] == [name]:
            add_command(name, subparsers)
        else:
            subparsers.add_parser(name, help=text)
    return top


def main(arguments: Sequence[str]) -> int:
    """Run a command; returns the exit status."""
    words = list(arguments)
    # Two words that are a command of their own.
    if " ".join(words[:2]) in COMMANDS and len(words) > 1:
        words[:2] = [" ".join(words[:2])]
    chosen = parser(words).parse_args(words)
    chosen.words = list(arguments)
    try:
        status: int = chosen.run(chosen)
        sys.stdout.flush()
    except errors.InputError as error:
        print(error, file=sys.stderr)
        return errors.WRONG_INPUT
    except errors.StudyError as error:
        print(f"hvp: {error}", file=sys.stderr)
        return errors.FAILED
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        print(f"hvp: {where}{error.strerror or error}", file=sys.stderr)
        return errors.FAILED
    except KeyboardInterrupt:
        # As the program does: a shell's loop ends too.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        signal.raise_signal(signal.SIGINT)
        return 128 + signal.SIGINT
    return status
