"""Files that are there whole or not at all."""

import os
from pathlib import Path


def write_whole(path: Path, data: bytes | str) -> Path:
    """Write beside the name and rename. A text has UTF-8 and its own line ends."""
    beside = path.with_name(f"{path.name}.{os.getpid()}.part")
    try:
        beside.write_bytes(data.encode() if isinstance(data, str) else data)
        beside.replace(path)
    except OSError:
        beside.unlink(missing_ok=True)
        raise
    return path
