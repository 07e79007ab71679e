"""The command that repeats what was asked for, as a shell takes it where that was called."""

import argparse
import os
import shlex
from collections.abc import Sequence

# How results are brought about: none of their bytes hangs on these.
_WITH_VALUE = ("--jobs", "--scheduler")
_ALONE = ("--quiet", "--retry")


def shell_line(words: Sequence[str]) -> str:
    """A command of hvp, which is named as it was called: `./hvp` says so in HVP_COMMAND."""
    return shlex.join([os.environ.get("HVP_COMMAND") or "./hvp", *words])


def repeating(words: Sequence[str]) -> str:
    """The words of a command without what does not change its results. Folders and files are named
    as they were, so that it repeats from the folder in which it was called."""
    kept: list[str] = []
    rest = iter(words)
    for word in rest:
        if word in _WITH_VALUE:
            next(rest, None)
        elif word.split("=", maxsplit=1)[0] not in _WITH_VALUE and word not in _ALONE:
            kept.append(word)
    return shell_line(kept)


def command_of(arguments: argparse.Namespace, name: str) -> str:
    """The same of parsed arguments, which remember their words; their command where they do not."""
    words: Sequence[str] = getattr(arguments, "words", name.split())
    return repeating(words)
