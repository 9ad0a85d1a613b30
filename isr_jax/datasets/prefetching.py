"""Decode frames ahead in threads, so that decoding and computing overlap."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..errors import FrameError
from ..runtime.prefetch import prefetch_results
from ..types import Frame, RgbdSequence


def prefetch(
    sequence: RgbdSequence, indices: Iterable[int], *, workers: int = 2, ahead: int = 4
) -> Iterator[tuple[int, Frame | FrameError]]:
    """Frames in the order asked for; one that cannot be read comes as its error.

    Args:
        sequence: Where the frames come from.
        indices: Which, in this order.
        workers: Decoding threads.
        ahead: Frames decoded before they are asked for, at most.
    """

    def read(index: int) -> tuple[int, Frame | FrameError]:
        try:
            return index, sequence[index]
        except FrameError as error:
            return index, error

    return prefetch_results(read, indices, workers=workers, ahead=ahead, name="prefetch")
