"""Settings as text: ``section.name=value``, TOML, and plain data."""

from __future__ import annotations

import dataclasses
import math
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..errors import SettingError
from .fields import check_value
from .presets import preset
from .settings import Settings


def with_overrides(settings: Settings, overrides: list[str]) -> Settings:
    """Settings with ``section.name=value`` changes applied.

    Raises:
        SettingError: unknown section or name, a value of another type, or out of its bounds.
    """
    for override in overrides:
        path, equals, text = override.partition("=")
        section, dot, name = path.strip().partition(".")
        if not equals or not dot:
            raise SettingError(
                f"{override!r} is not a setting",
                "write it as section.name=value: mapping.voxel_size_m=0.01",
            )
        settings = _with_value(settings, section, name, text.strip())
    return settings


def _with_value(settings: Settings, section: str, name: str, text: str) -> Settings:
    sections = {f.name for f in dataclasses.fields(settings)} - {"preset"}
    if section not in sections:
        raise SettingError(
            f"unknown section {section!r}", f"use one of: {', '.join(sorted(sections))}"
        )
    stage = getattr(settings, section)
    fields = {f.name: f for f in dataclasses.fields(stage)}
    if name not in fields:
        raise SettingError(
            f"unknown setting {section}.{name}", f"use one of: {', '.join(sorted(fields))}"
        )
    value = _parse(text, type(getattr(stage, name)), f"{section}.{name}")
    check_value(f"{section}.{name}", type(stage), fields[name], value)
    return dataclasses.replace(settings, **{section: dataclasses.replace(stage, **{name: value})})


def _parse(text: str, kind: type, name: str) -> Any:
    readers = {bool: {"true": True, "false": False}.__getitem__}
    try:
        return readers.get(kind, kind)(text.lower() if kind is bool else text)
    except (KeyError, ValueError):
        raise SettingError(f"{name} = {text!r}", f"give a {kind.__name__}") from None


def settings_to_toml(settings: Settings) -> str:
    """All settings as TOML, one table per stage, each with its meaning and unit."""
    lines = [f"preset = {_toml(settings.preset)}"]
    for section in dataclasses.fields(settings):
        if section.name == "preset":
            continue
        stage = getattr(settings, section.name)
        lines += ["", f"[{section.name}]"]
        for field in dataclasses.fields(stage):
            unit = field.metadata["unit"]
            meaning = field.metadata["help"] + (f" [{unit}]" if unit else "")
            lines.append(f"{field.name} = {_toml(getattr(stage, field.name))}  # {meaning}")
    return "\n".join(lines) + "\n"


def _toml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else repr(value)


def settings_from_toml(path: Path) -> Settings:
    """Read what `settings_to_toml` wrote; what a file leaves out keeps its preset's value.

    Raises:
        SettingError: the file cannot be read, is not TOML, or holds an unknown section or name, a
            value of another type, or one out of its bounds.
    """
    try:
        data = tomllib.loads(path.read_text("utf-8"))
    except OSError as error:
        raise SettingError(f"{path}: {error.strerror}", "give a config.toml") from None
    except tomllib.TOMLDecodeError as error:
        raise SettingError(f"{path} is not TOML: {error}", "mend that line") from None
    return _with_sections(data, str(path))


def _with_sections(data: Mapping[str, Any], where: str) -> Settings:
    settings = preset(str(data.get("preset", "default")))
    for section, values in data.items():
        if section == "preset":
            continue
        if not isinstance(values, dict):
            raise SettingError(
                f"{where}: {section} stands outside a section", "put it below its [section]"
            )
        for name, value in values.items():
            text = str(value).lower() if isinstance(value, bool) else str(value)
            settings = _with_value(settings, section, name, text)
    return settings


def settings_to_dict(settings: Settings) -> dict[str, Any]:
    """Nested plain data, for scene.json: what is infinite is the text ``inf``, as in TOML."""
    return _json_safe(dataclasses.asdict(settings))


def settings_from_dict(data: Mapping[str, Any]) -> Settings:
    """Settings as `settings_to_dict` wrote them; what is left out keeps its preset's value.

    Raises:
        SettingError: unknown preset, section or name, or a value of another type.
    """
    return _with_sections(data, "settings")


def _json_safe(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _json_safe(item) for key, item in value.items()}
    return str(value) if isinstance(value, float) and math.isinf(value) else value
