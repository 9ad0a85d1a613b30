"""Lists of several maps in chunks of one size, so that one kernel walks them all."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Int

from ..runtime.batches import bucket


@dataclasses.dataclass(frozen=True, eq=False)
class Chunks:
    """Rows (or voxels) of several maps, each map's filled up to whole chunks."""

    rows: Int[np.ndarray, " blocks"]
    """Padding lies out of range, each entry once."""
    owner: Int[np.ndarray, " chunks"]
    """Map of each chunk."""
    spans: list[slice]
    """Where each map's own rows stand."""
    chunks: Int[np.ndarray, ""]
    """True ones; the rest is padding."""


def chunked(parts: list[np.ndarray], out_of_range: int, chunk: int) -> Chunks:
    """Lists of rows, one per map, in a power of two of chunks.

    Args:
        parts: Rows of each map.
        out_of_range: The first row that none of them has.
        chunk: Rows of a chunk.
    """
    counts = [-(-len(part) // chunk) for part in parts]
    total = sum(counts)
    size = bucket(total)
    rows = out_of_range + np.arange(size * chunk, dtype=np.int32)
    owner = np.zeros(size, np.int32)
    owner[:total] = np.repeat(np.arange(len(parts)), counts)
    starts = (np.cumsum([0, *counts[:-1]]) * chunk).tolist()
    spans = [slice(s, s + len(part)) for s, part in zip(starts, parts, strict=True)]
    for span, part in zip(spans, parts, strict=True):
        rows[span] = part
    return Chunks(rows, owner, spans, np.array(total, np.int32))
