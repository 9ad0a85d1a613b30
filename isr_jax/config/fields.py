"""A setting: a dataclass field with a unit, bounds and one line of meaning."""

from __future__ import annotations

import dataclasses
from typing import Any

from ..errors import SettingError


def setting(
    default: Any,
    help: str,
    *,
    unit: str = "",
    low: float | int | None = None,
    high: float | int | None = None,
    choices: tuple[str, ...] = (),
    static: bool = False,
) -> Any:
    """A dataclass field that knows its unit, bounds and meaning."""
    metadata = {
        "help": help,
        "unit": unit,
        "low": low,
        "high": high,
        "choices": choices,
        "static": static,
    }
    return dataclasses.field(default=default, metadata=metadata)


class Checked:
    """Checks every field against its bounds where the settings are made."""

    def __post_init__(self) -> None:
        for field in dataclasses.fields(self):  # type: ignore[arg-type]
            _check_field(type(self).__name__, field, getattr(self, field.name))


def _check_field(owner: str, field: dataclasses.Field, value: Any) -> None:
    low, high = field.metadata.get("low"), field.metadata.get("high")
    choices = field.metadata.get("choices")
    name = f"{owner}.{field.name}"
    if choices and value not in choices:
        raise SettingError(f"{name} = {value!r}", f"use one of: {', '.join(choices)}")
    if (low is not None and not value >= low) or (high is not None and not value <= high):
        unit = field.metadata["unit"]
        raise SettingError(
            f"{name} = {value!r} {unit} is out of bounds",
            f"keep it between {low if low is not None else '-inf'} and "
            f"{high if high is not None else 'inf'} {unit}".rstrip(),
        )
