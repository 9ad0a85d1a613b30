"""A setting: a dataclass field with a unit, bounds or choices, and one phrase of meaning."""

from __future__ import annotations

import dataclasses
import functools
from typing import Any, Literal, get_args, get_origin, get_type_hints

from ..errors import SettingError


def setting(
    default: Any,
    help: str,
    *,
    unit: str = "",
    low: float | int | None = None,
    high: float | int | None = None,
) -> Any:
    """A dataclass field that knows its unit, bounds and meaning.

    A closed vocabulary is the field's type, a ``Literal``: `choices` reads it.

    Args:
        help: One phrase that stands alone, as ``config.toml`` and docs/settings.md print it.
        unit: Of the value; empty for what has none.
        low: Least value, allowed itself.
        high: Greatest value, allowed itself.
    """
    metadata = {"help": help, "unit": unit, "low": low, "high": high}
    return dataclasses.field(default=default, metadata=metadata)


@functools.cache
def choices(section: type) -> dict[str, tuple[str, ...]]:
    """All allowed values of each field of a settings class whose type is a ``Literal``."""
    hints = get_type_hints(section)
    return {name: get_args(hint) for name, hint in hints.items() if get_origin(hint) is Literal}


class Checked:
    """Checks every field where the settings are made.

    Raises:
        SettingError: a field is out of its bounds or is none of its choices.
    """

    def __post_init__(self) -> None:
        for field in dataclasses.fields(self):  # type: ignore[arg-type]
            name = f"{type(self).__name__}.{field.name}"
            check_value(name, type(self), field, getattr(self, field.name))


def check_value(name: str, section: type, field: dataclasses.Field, value: Any) -> None:
    """Refuse a value that a field of a settings class does not allow.

    Args:
        name: What the message calls the setting.

    Raises:
        SettingError: the value is out of the field's bounds or is none of its choices.
    """
    allowed = choices(section).get(field.name, ())
    if allowed and value not in allowed:
        raise SettingError(f"{name} = {value!r}", f"use one of: {', '.join(allowed)}")
    low, high = field.metadata.get("low"), field.metadata.get("high")
    if (low is not None and not value >= low) or (high is not None and not value <= high):
        unit = field.metadata["unit"]
        raise SettingError(
            f"{name} = {value!r} {unit} is out of bounds",
            f"keep it between {low if low is not None else '-inf'} and "
            f"{high if high is not None else 'inf'} {unit}".rstrip(),
        )
