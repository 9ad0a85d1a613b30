"""Decode frames ahead in threads, so that decoding and computing overlap."""

from __future__ import annotations

import collections
from collections.abc import Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor

from ..errors import FrameError
from ..types import Frame, Sequence


def prefetch(
    sequence: Sequence, indices: Iterable[int], *, workers: int = 2, ahead: int = 4
) -> Iterator[tuple[int, Frame | FrameError]]:
    """Frames in the order asked for; one that cannot be read comes as its error.

    Args:
        sequence: Where the frames come from.
        indices: Which, in this order.
        workers: Decoding threads.
        ahead: Frames decoded before they are asked for, at most.
    """
    with ThreadPoolExecutor(workers, thread_name_prefix="prefetch") as pool:
        waiting: collections.deque[tuple[int, Future[Frame | FrameError]]] = collections.deque()
        try:
            for index in indices:
                waiting.append((index, pool.submit(_frame_or_error, sequence, index)))
                if len(waiting) > ahead:
                    done, future = waiting.popleft()
                    yield done, future.result()
            while waiting:
                done, future = waiting.popleft()
                yield done, future.result()
        finally:
            for _, future in waiting:
                future.cancel()


def _frame_or_error(sequence: Sequence, index: int) -> Frame | FrameError:
    try:
        return sequence[index]
    except FrameError as error:
        return error
