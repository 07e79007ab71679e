"""Folders for what a run writes, removed after it: by who made them, or by who comes next."""

import contextlib
import fcntl
import functools
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

_PREFIX = "hvp-study-"
_LOCK = ".owned"


@contextlib.contextmanager
def scratch_folder() -> Iterator[Path]:
    """An empty folder, in the system's folder for such; locked as long as its owner lives."""
    sweep_once(tempfile.gettempdir())
    with tempfile.TemporaryDirectory(prefix=_PREFIX) as name:
        folder = Path(name)
        # Locked before it has the name by which others look for it.
        beside = folder / f"{_LOCK}.part"
        with beside.open("wb") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            beside.rename(folder / _LOCK)
            inside = folder / "files"
            inside.mkdir()
            yield inside


@functools.cache
def sweep_once(where: str) -> None:
    """Remove what killed studies of this user have left in a folder, once a process."""
    for folder in Path(where).glob(f"{_PREFIX}*"):
        # Whatever is in the way, as a folder that its owner removes meanwhile, is left to the next.
        with contextlib.suppress(OSError):
            if folder.is_symlink() or folder.stat().st_uid != os.getuid():
                continue
            with (folder / _LOCK).open("rb") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                shutil.rmtree(folder)
