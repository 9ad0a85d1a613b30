"""Border: plain data and arrays in one file that is written whole and mapped when it is read.

Layout: `_HEAD` (magic, length and CRC-32 of the header), a JSON header that says where each array
lies, the arrays at multiples of 64 bytes.
"""

from __future__ import annotations

import json
import os
import struct
import threading
import zlib
from pathlib import Path
from typing import Any

import numpy as np

_HEAD = struct.Struct("<8sQQ")
_MAGIC = b"isrpack1"
_ALIGNMENT = 64


def write_packed(path: Path, data: Any, arrays: dict[str, np.ndarray], unchecked=()) -> None:
    """Write a file in one step: other processes see the old one or the new one; raises OSError.

    Args:
        path: Its folder is created.
        data: What JSON can hold.
        arrays: Of numbers.
        unchecked: Names of arrays that are too large to check whenever the file is opened.
    """
    places, end = {}, 0
    blocks = {name: np.ascontiguousarray(values) for name, values in arrays.items()}
    for name, block in blocks.items():
        crc = None if name in unchecked else zlib.crc32(block.data)
        places[name] = [block.dtype.str, list(block.shape), end, crc]
        end += block.nbytes + -block.nbytes % _ALIGNMENT
    text = json.dumps([data, places, end], separators=(",", ":")).encode()
    text += b" " * (-(_HEAD.size + len(text)) % _ALIGNMENT)
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = path.with_name(f"{path.name}.{os.getpid()}-{threading.get_ident()}.new")
    try:
        with fresh.open("wb") as file:
            file.write(_HEAD.pack(_MAGIC, len(text), zlib.crc32(text)) + text)
            for block in blocks.values():
                file.write(block.data)
                file.write(b"\0" * (-block.nbytes % _ALIGNMENT))
        fresh.replace(path)
    finally:
        fresh.unlink(missing_ok=True)


def read_packed(path: Path) -> tuple[Any, dict[str, np.ndarray]]:
    """What `write_packed` wrote, the arrays mapped; ValueError for any other file, or OSError."""
    with path.open("rb") as file:
        head = file.read(_HEAD.size)
        if len(head) < _HEAD.size or not head.startswith(_MAGIC):
            raise ValueError(f"{path} was written in another format")
        _, length, crc = _HEAD.unpack(head)
        text = file.read(length)
        first, size = file.tell(), file.seek(0, os.SEEK_END)
    if zlib.crc32(text) != crc:
        raise ValueError(f"{path}: its header is damaged")
    data, places, end = json.loads(text)
    if first + end != size:
        raise ValueError(f"{path} was cut short")
    arrays = {}
    whole = np.memmap(path, np.uint8, "r", offset=0) if end else np.zeros(first, np.uint8)
    for name, (dtype, shape, offset, crc) in places.items():
        kind = np.dtype(dtype)
        count = int(np.prod(shape, dtype=np.int64)) * kind.itemsize
        block = np.asarray(whole[first + offset : first + offset + count])
        if crc is not None and zlib.crc32(block.data) != crc:
            raise ValueError(f"{path}: {name} is damaged")
        arrays[name] = block.view(kind).reshape(shape)
    return data, arrays
