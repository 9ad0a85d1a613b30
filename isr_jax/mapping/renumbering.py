"""Map labels get new numbers without walking the whole map.

Each renumbering makes a new generation of numbers. Blocks keep the generation in which their labels
are written, and are rewritten when a frame next labels them, or all at once before the map is read.
So the time per frame does not grow with the map, and a number that went free may be given again.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Int

from ..runtime.batches import bucket
from . import label_slots
from .blocks import BlockIndex
from .pool import ROW_MULTIPLE, LabelSlots

_MOST_GENERATIONS = 64
"""So many pending renumberings are written out; they would be slow to compose."""


class Renumbering:
    """Generations of label numbers: from each that some block may bear to today's."""

    def __init__(self) -> None:
        self.generation = 0
        self._to_now: dict[int, Int[np.ndarray, " labels"]] = {}

    @property
    def pending(self) -> int:
        """Generations before today's that blocks may bear."""
        return len(self._to_now)

    @property
    def is_long(self) -> bool:
        """Whether it is time to write all blocks."""
        return self.pending >= _MOST_GENERATIONS

    def add(self, new_label: Int[np.ndarray, " labels"]) -> None:
        """From now on label ``i`` is ``new_label[i]``."""
        self._to_now = {g: new_label[table] for g, table in self._to_now.items()}
        self._to_now[self.generation] = np.asarray(new_label)
        self.generation += 1

    def renumber_rows(
        self,
        labels: LabelSlots,
        blocks: BlockIndex,
        first_row: int,
        rows: Int[np.ndarray, " blocks"],
    ) -> LabelSlots:
        """Today's labels in these rows of a map; takes the storage of ``labels``.

        Args:
            labels: Of the pool.
            blocks: Of the map.
            first_row: Of the map in the pool.
            rows: Of the map.
        """
        if not self._to_now:
            return labels
        of_row = blocks.generation[rows]
        stale = rows[of_row < self.generation]
        if not len(stale):
            return labels
        generations = sorted(self._to_now)
        tables = _padded_tables([self._to_now[g] for g in generations])
        size = bucket(len(stale), ROW_MULTIPLE)
        padded = len(labels[0]) + np.arange(size, dtype=np.int32)
        padded[: len(stale)] = stale + first_row
        table_of = np.zeros(size, np.int32)
        table_of[: len(stale)] = np.searchsorted(generations, blocks.generation[stale])
        labels = label_slots.renumber_slots(
            labels, tables, padded, table_of, np.array(len(stale), np.int32)
        )
        blocks.generation[stale] = self.generation
        return labels

    def renumber_all(self, labels: LabelSlots, blocks: BlockIndex, first_row: int) -> LabelSlots:
        """Today's labels in all rows of a map; takes the storage of ``labels``."""
        used = np.arange(blocks.used, dtype=np.int32)
        labels = self.renumber_rows(labels, blocks, first_row, used)
        self._to_now = {}
        return labels


def _padded_tables(tables: list[np.ndarray]) -> np.ndarray:
    """Tables of equal, bucketed sizes, so that few shapes are compiled."""
    width = bucket(max(len(t) for t in tables), 64)
    padded = np.zeros((bucket(len(tables)), width), np.uint32)
    for row, table in zip(padded, tables):
        row[: len(table)] = table
    return padded
