"""Reads the .vtu files that a run writes: raw appended data, zlib, a header of 32-bit words."""

import re
import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from studies.errors import InputError

_ARRAY = re.compile(rb"<DataArray ([^>]*?)/?>")
_ATTRIBUTE = re.compile(rb'(\w+)="([^"]*)"')
_TYPES = {"Float64": "<f8", "Float32": "<f4", "Int32": "<i4", "UInt8": "<u1", "Int64": "<i8"}


def read_vtu(path: Path, names: set[str]) -> dict[str, npt.NDArray[Any]]:
    """The named arrays, a row a tuple where they have components. Throws InputError."""
    head, mark, rest = path.read_bytes().partition(b'<AppendedData encoding="raw">')
    start = rest.find(b"_") + 1
    if not mark or b"vtkZLibDataCompressor" not in head or b'header_type="UInt32"' not in head:
        raise InputError(f"{path}: expected a step of a run: appended raw data, zlib, UInt32")
    arrays: dict[str, npt.NDArray[Any]] = {}
    try:
        for found in _ARRAY.finditer(head):
            attributes = {
                key.decode(): value.decode() for key, value in _ATTRIBUTE.findall(found[1])
            }
            if attributes["Name"] not in names:
                continue
            data = _inflated(rest, start + int(attributes["offset"]))
            array = np.frombuffer(data, dtype=_TYPES[attributes["type"]])
            components = int(attributes.get("NumberOfComponents", "1"))
            arrays[attributes["Name"]] = array.reshape(-1, components) if components > 1 else array
    except (KeyError, ValueError, struct.error, zlib.error) as error:
        raise InputError(f"{path}: damaged: {error}") from error
    if missing := names - arrays.keys():
        raise InputError(f"{path}: expected the array {min(missing)}")
    return arrays


def _inflated(data: bytes, at: int) -> bytes:
    """VTK's blocks: their number, their size, the last one's, then each one's compressed size."""
    blocks, _, _ = struct.unpack_from("<3I", data, at)
    sizes = struct.unpack_from(f"<{blocks}I", data, at + 12)
    at += 12 + 4 * blocks
    parts = []
    for size in sizes:
        parts.append(zlib.decompress(data[at : at + size]))
        at += size
    return b"".join(parts)
