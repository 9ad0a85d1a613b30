"""Work on the next items in threads while the caller is busy with this one."""

from __future__ import annotations

import collections
from collections.abc import Callable, Generator, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

T = TypeVar("T")
R = TypeVar("R")


def prefetch_results(
    work: Callable[[T], R], items: Iterable[T], *, workers: int, ahead: int, name: str
) -> Generator[R, None, None]:
    """``work`` of each item, in the items' order; what it raises is raised in its turn.

    Closing the generator cancels what has not begun, and waits for what has.

    Args:
        work: Called in a thread. It overlaps with the caller where it is not Python itself: XLA,
            ONNX Runtime, OpenCV and NumPy's loops let other threads run.
        items: Taken one by one, by the caller's thread, as it asks for results.
        workers: Threads. With one, no two calls of ``work`` overlap.
        ahead: Results made before they are asked for, at most.
        name: Of the threads.
    """
    with ThreadPoolExecutor(workers, thread_name_prefix=name) as pool:
        waiting: collections.deque[Future[R]] = collections.deque()
        try:
            for item in items:
                waiting.append(pool.submit(work, item))
                if len(waiting) > ahead:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        finally:
            for future in waiting:
                future.cancel()
