"""The command that repeats what was asked for, as a shell takes it."""

import argparse
import shlex
from collections.abc import Sequence

# Where results go and how they are brought about: none of their bytes hangs on these.
_ELSEWHERE = ("--out", "--store", "--jobs", "--scheduler")


def repeating(words: Sequence[str]) -> str:
    """The words of a command without what does not change its results."""
    kept: list[str] = []
    rest = iter(words)
    for word in rest:
        if word in _ELSEWHERE:
            next(rest, None)
        elif word.split("=", maxsplit=1)[0] not in _ELSEWHERE and word not in (
            "--quiet",
            "--retry",
        ):
            kept.append(word)
    return shlex.join(["./hvp", *kept])


def command_of(arguments: argparse.Namespace, name: str) -> str:
    """The same of parsed arguments, which remember their words; their command where they do not."""
    words: Sequence[str] = getattr(arguments, "words", name.split())
    return repeating(words)
