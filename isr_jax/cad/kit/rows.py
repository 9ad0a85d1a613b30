"""Rows of the kit's catalogue: a maker, the size of its box, and its other dimensions."""

from __future__ import annotations

import dataclasses
import functools
import inspect
from collections.abc import Callable, Mapping
from typing import Any

from ...errors import SettingError
from .builder import ModelBuilder

Maker = Callable[..., ModelBuilder]
SIDES: dict[str, int] = {"low": 8, "medium": 16, "high": 32}
"""Sides of round parts at each level of detail."""


@dataclasses.dataclass(frozen=True)
class Row:
    """One model of the catalogue."""

    name: str
    """Within its class."""
    maker: Maker
    size: tuple[float, float, float]
    """Width, depth and height of the box, joints closed and handles left out, metres."""
    options: Mapping[str, Any]
    """Other arguments of the maker."""
    follows: Mapping[str, int]
    """Options that grow with the box when it is fitted: name and axis (0, 1, 2)."""

    def having(self, *, follows: Mapping[str, int] | None = None, **options: Any) -> Row:
        """The row with these of its maker's keyword arguments, and these that follow the size."""
        return dataclasses.replace(
            self,
            options={**self.options, **options},
            follows={**self.follows, **(follows or {})},
        )

    def design(
        self, size: tuple[float, float, float] | None = None, detail: str = "medium"
    ) -> ModelBuilder:
        """The design at this row's size, or at another one, metres.

        Raises:
            SettingError: there is no such level of detail.
        """
        asked = self.size if size is None else size
        options, defaults = dict(self.options), _defaults(self.maker)
        for name, axis in self.follows.items():
            own = options.get(name, defaults[name])
            options[name] = round(own * asked[axis] / self.size[axis], 6)
        if "sides" in defaults:
            options.setdefault("sides", sides_of(detail))
        return self.maker(*asked, **options)


def row(name: str, maker: Maker, width: float, depth: float, height: float) -> Row:
    """A row of the catalogue: a maker with its own defaults, at a size in metres."""
    return Row(name, maker, (width, depth, height), {}, {})


def sides_of(detail: str) -> int:
    """Sides of round parts; raises `SettingError` for an unknown level of detail."""
    if detail not in SIDES:
        raise SettingError(f"level of detail {detail!r}", f"use one of: {', '.join(SIDES)}")
    return SIDES[detail]


@functools.cache
def _defaults(maker: Maker) -> dict[str, Any]:
    """A maker's keyword arguments and their defaults."""
    parameters = inspect.signature(maker).parameters.values()
    return {p.name: p.default for p in parameters if p.kind == p.KEYWORD_ONLY}
