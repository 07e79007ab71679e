"""Files that are there whole or not at all."""

import contextlib
import os
from pathlib import Path


def write_whole(path: Path, data: bytes | str) -> Path:
    """Write beside the name and rename. A text has UTF-8 and its own line ends."""
    beside = path.with_name(f"{path.name}.{os.getpid()}.part")
    try:
        beside.write_bytes(data.encode() if isinstance(data, str) else data)
        beside.replace(path)
    except OSError as error:
        with contextlib.suppress(OSError):  # nor can it be removed where it could not be made
            beside.unlink()
        error.filename = error.filename or str(path)  # a full disk has none
        raise
    return path
