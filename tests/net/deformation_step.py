"""Reads an array of a .vtu step as hvp writes it: appended, raw, in blocks of zlib."""

import re
import struct
import zlib
from pathlib import Path

FORMATS = {"Float64": "d", "Float32": "f", "Int64": "q", "Int32": "i", "UInt8": "B"}


def inflated(data: bytes, at: int) -> bytes:
    """Number of blocks, their size, the last one's size, the compressed sizes, the blocks."""
    (blocks,) = struct.unpack_from("<I", data, at)
    sizes = struct.unpack_from(f"<{blocks}I", data, at + 12)
    at += 12 + 4 * blocks
    whole = b""
    for size in sizes:
        whole += zlib.decompress(data[at : at + size])
        at += size
    return whole


def array(step: Path, name: str) -> tuple[float, ...]:
    """Its components one after the other."""
    text = step.read_bytes()
    found = re.search(rf'<DataArray type="(\w+)" Name="{name}"[^>]*?offset="(\d+)"'.encode(), text)
    if found is None:
        raise ValueError(f"{step.name} has no {name}")
    start = text.index(b"_", text.index(b"<AppendedData")) + 1
    data = inflated(text, start + int(found[2]))
    letter = FORMATS[found[1].decode()]
    return struct.unpack(f"<{len(data) // struct.calcsize(letter)}{letter}", data)
