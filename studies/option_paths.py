"""Folders and files that options name, looked at before anything is run."""

import os
import re
from collections.abc import Sequence
from pathlib import Path

from studies.errors import InputError

_LONGEST = 120  # of what a default folder's name says, as hvp run has it


def check_folder(option: str, path: Path, written: bool = True) -> Path:
    """The folder, which is there or can be made. One that is only read may be read-only.

    Throws InputError.
    """
    there = path.absolute()
    while not there.exists() and there != there.parent:
        there = there.parent
    if not there.is_dir():
        raise InputError(f"{option} {path}: expected a folder, found the file {there}")
    if written and not os.access(there, os.W_OK | os.X_OK):
        raise InputError(f"{option} {path}: expected a folder to write in, found {there}")
    return path


def check_file(option: str, path: Path) -> Path:
    """A file that is to be written into a folder that is there. Throws InputError."""
    if path.is_dir():
        raise InputError(f"{option} {path}: expected a file, found a folder")
    if not path.absolute().parent.is_dir():
        raise InputError(f"{option} {path}: expected a file in a folder that is there")
    if not os.access(path.absolute().parent, os.W_OK | os.X_OK):
        raise InputError(f"{option} {path}: expected a file in a folder to write in")
    return path


def folder_name(words: Sequence[str]) -> str:
    """What was asked for, as part of a folder's name: what differs there gets another folder."""
    text = "+".join(words)
    plain = re.sub(r"[^\w.=+-]", "-", re.sub(r"[ \"']", "", text), flags=re.ASCII)
    return plain if len(plain) <= _LONGEST else plain[:_LONGEST].rstrip("+-.")
