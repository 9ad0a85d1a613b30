"""What the rooms of a benchmark are like, from the truth beside their films."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from isr_jax.demonstration.room_making import TAKEN_AWAY
from isr_jax.errors import SceneError

from .sheets import Sheet

_HEADINGS = (
    "room",
    "m2",
    "objects",
    "classes",
    "with joints",
    "levels",
    "occluded, %",
    "seen, %",
    "well seen, %",
    "taken away",
    "drift, mm",
)


def room_sheet(out_dir: Path) -> Sheet:
    """One row per filmed room, and their mean.

    Objects are the things among its items; levels the longest way down a tower (a cup on a book
    on a table: 3). Occluded: of an entity's pixels that nothing but the image's border would
    hide, the share that other things hide; seen: the share of an entity's observable surface that
    the camera saw; both are means over entities. Well seen: entities seen for the most part.
    Taken away: items that did not stand; drift: the farthest that a body of the room that was
    filmed moved in 5 s of MuJoCo.

    Raises:
        SceneError: no room was filmed, or a truth folder cannot be read.
    """
    folders = sorted((out_dir / "rooms").glob("*/film/truth"))
    if not folders:
        raise SceneError(f"no film below {out_dir}", "run the benchmark first")
    figures = {folder.parent.parent.name: _figures(folder) for folder in folders}
    mean = tuple(
        float(np.mean(column)) if (column := [v for v in values if v is not None]) else None
        for values in zip(*figures.values(), strict=True)
    )
    lines = [(name, *map(_shown, values)) for name, values in figures.items()]
    return Sheet("rooms", _HEADINGS, (*lines, ("mean", *map(_shown, mean))))


def _figures(truth_dir: Path) -> tuple[float | None, ...]:
    """The columns of a room after its name; shares in percent."""
    room, views = _read(truth_dir / "room.json"), _read(truth_dir / "views.json")["room"]
    things = [item for item in room["items"] if item["kind"] == "thing"]
    parents = {item["name"]: item["parent"] for item in room["items"]}
    shares = [views[name] for name in ("occlusion", "seen", "well_seen")]
    return (
        float(np.prod(room["size_m"][:2])),
        float(len(things)),
        float(len({item["class"] for item in things})),
        float(sum(any(j["kind"] != "fixed" for j in item["joints"]) for item in things)),
        float(max((_level(item["name"], parents) for item in things), default=0)),
        *(None if share is None else 100.0 * share for share in shares),
        float(sum(TAKEN_AWAY in note for note in room["notes"])),
        _drift_mm(truth_dir / "twin" / "stability.json"),
    )


def _drift_mm(path: Path) -> float | None:
    """None for a film whose room was not made to stand."""
    if not path.exists():
        return None
    bodies = _read(path)["exported"]["bodies"]
    return 1000.0 * max((body["drift_end_m"] for body in bodies), default=0.0)


def _level(name: str | None, parents: dict[str, str | None]) -> int:
    level = 0
    while name in parents and parents[name] is not None:
        level, name = level + 1, parents[name]
    return level


def _read(path: Path) -> dict[str, Any]:
    try:
        return json.loads(path.read_text("utf-8"))
    except (OSError, ValueError) as error:
        raise SceneError(f"{path} cannot be read: {error}", "film the room anew") from None


def _shown(value: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:.0f}" if value >= 10 or value == int(value) else f"{value:.2g}"
