"""What a stage is, stated once."""

from __future__ import annotations

import dataclasses
from typing import Generic, TypeVar

T = TypeVar("T")


@dataclasses.dataclass(frozen=True)
class Stage(Generic[T]):
    """A stage of the way through; each stage's package states its own as ``STAGE``."""

    name: str
    version: int
    """Raised when results change; part of the key of stored results."""
    result: type[T]
    """Of one scene."""
    settings: tuple[str, ...]
    """Sections of `config.Settings` that it is called with after its inputs, its own first."""


__all__ = ["Stage"]
