"""The page of all settings, docs/settings.md, made from the settings themselves."""

from __future__ import annotations

import dataclasses
from typing import Any

from ..errors import SettingError
from .fields import choices
from .presets import PRESETS
from .sensor import NoiseModel, PoseNoise
from .settings import Settings

_HEAD = """\
# Settings

<!-- Written by `isr settings --out docs/settings.md`; change isr_jax/config/ instead. -->

Every number of the pipeline, one table per section. `isr run --set mapping.voxel_size_m=0.02
matching.shortlist=20` changes some of them, `--preset paper` takes another column, and `--config
out/kitchen/config.toml` takes those of an earlier run: the resolved settings are saved beside every
result. In Python, `isr.with_overrides(isr.preset("paper"), ["mapping.voxel_size_m=0.02"])`.

A preset's column says where it differs from the default: `paper` has the paper's numbers, its gaps
filled as its released code fills them; `voxblox++` has the mapping of Grinvald et al. 2019, the
paper's baseline, and all after the map as in `paper`.
"""
_SENSOR_HEAD = """\
## The noise of a rendered film

`isr_jax.config.NoiseModel` and `PoseNoise` are no section of the settings, since no stage reads
them: `isr.film_room(noise=..., pose_noise=...)` does.
"""


def settings_page() -> str:
    """Markdown: one table per section, with units, presets, bounds and meanings."""
    sections = "\n".join(settings_section(name) for name in section_names())
    noise = "\n".join(_section(kind.__name__, kind, {}, "###") for kind in (NoiseModel, PoseNoise))
    return "\n".join([_HEAD, sections, _SENSOR_HEAD, noise])


def section_names() -> tuple[str, ...]:
    """The sections of the settings, in the order of the pipeline."""
    return tuple(f.name for f in dataclasses.fields(Settings) if f.name != "preset")


def settings_section(name: str) -> str:
    """Markdown of one section.

    Raises:
        SettingError: no section has that name.
    """
    if name not in section_names():
        raise SettingError(f"unknown section {name!r}", f"use one of: {', '.join(section_names())}")
    by_preset = {preset: getattr(settings, name) for preset, settings in PRESETS.items()}
    default = by_preset.pop("default")
    return _section(name, type(default), {p: s for p, s in by_preset.items() if s != default})


def _section(title: str, kind: type, by_preset: dict[str, Any], mark: str = "##") -> str:
    columns = ["setting", "unit", "default", *by_preset, "allowed", "meaning"]
    lines = [
        f"{mark} {title}",
        "",
        (kind.__doc__ or "").partition("\n")[0],
        "",
        _row(columns),
        _row(["---"] * len(columns)),
    ]
    for field in dataclasses.fields(kind):
        others = [getattr(section, field.name) for section in by_preset.values()]
        differing = ["" if value == field.default else _text(value) for value in others]
        unit, meaning = field.metadata["unit"], field.metadata["help"]
        allowed = _allowed(field, choices(kind).get(field.name, ()))
        name, default = f"`{field.name}`", _text(field.default)
        lines.append(_row([name, unit, default, *differing, allowed, meaning]))
    return "\n".join(lines) + "\n"


def _row(cells: list[str]) -> str:
    return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:g}" if isinstance(value, float) else str(value)


def _allowed(field: dataclasses.Field, listed: tuple[str, ...]) -> str:
    """Choices, or bounds: ``0.5 to 20``, ``from 1``, ``up to 1``."""
    if listed or isinstance(field.default, bool):
        return ", ".join(listed or ("true", "false"))
    low, high = field.metadata["low"], field.metadata["high"]
    if low is not None and high is not None:
        return f"{_text(low)} to {_text(high)}"
    if low is not None:
        return f"from {_text(low)}"
    return f"up to {_text(high)}" if high is not None else "any"
