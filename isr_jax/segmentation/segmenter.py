"""What every source of masks is to the rest: a function from a frame to its panoptic masks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

from ..types import Frame, PanopticFrame


@runtime_checkable
class Segmenter(Protocol):
    """A source of panoptic masks."""

    name: str

    def __call__(self, frame: Frame) -> PanopticFrame:
        """Masks of one frame; raises `errors.FrameError` when that one frame has none to read."""
        ...

    def content_hash(self) -> str:
        """Hex digest of all that its masks depend on; part of the key of stored results."""
        ...

    def describe(self) -> str:
        """What it is, for the log: files, hardware, noise rates."""
        ...


@runtime_checkable
class BatchSegmenter(Segmenter, Protocol):
    """A source of masks that gains from several frames at once, as a model on an accelerator."""

    def batch(self, frames: Sequence[Frame]) -> list[PanopticFrame]:
        """The masks of each frame, up to rounding as one by one."""
        ...
