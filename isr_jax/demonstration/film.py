"""Films of furnished rooms: which room, which camera, and what lies there already."""

from __future__ import annotations

import dataclasses
import json
import re
import shutil
from pathlib import Path
from typing import Any

from .. import synthetic
from ..cad import default_library
from ..config import NoiseModel, PoseNoise
from ..errors import OutputError, SettingError
from ..library import CadLibrary
from ..runtime.reporter import LogReporter, Reporter
from ..synthetic.room import ROOM_KINDS, Room
from .room_making import made_to_stand, standing_room

_KINECT, _TRUE_POSES = NoiseModel(), PoseNoise()
_STAMP = "film.json"
"""Says which film a folder holds."""


@dataclasses.dataclass(frozen=True)
class FilmPlan:
    """Which room is filmed, and how."""

    seed: int | None = None
    """Of the room, the walk and the noise; None is the built-in room."""
    kind: str | None = None
    """Of `ROOM_KINDS`; None: drawn from the seed."""
    frames: int = 150
    """Length of the walk."""
    width: int = 640
    """Of the images, pixels."""
    height: int = 480
    noise: NoiseModel = _KINECT
    """Of the depth camera."""
    pose_noise: PoseNoise = _TRUE_POSES
    """Of the poses that are written; by default they are the true ones."""

    def stamp(self, library: CadLibrary) -> dict[str, Any]:
        """Plain data that only the very same film has."""
        return {
            "synthetic": synthetic.VERSION,
            "library": library.content_hash,
            **dataclasses.asdict(self),
        }


def film_room(
    out_dir: str | Path,
    *,
    seed: int | None = None,
    kind: str | None = None,
    frames: int = 150,
    width: int = 640,
    height: int = 480,
    noise: NoiseModel = _KINECT,
    pose_noise: PoseNoise = _TRUE_POSES,
    library: CadLibrary | None = None,
    reporter: Reporter | None = None,
) -> Path:
    """Film a furnished room with a simulated camera; returns the folder of the sequence.

    The room stands in MuJoCo before it is filmed (`room_making.standing_room`); ``truth/twin/``
    holds the scene that proves it. The very same film that lies there already is kept; another
    one is replaced. The same arguments write the same bytes.

    Args:
        out_dir: Receives frames, true masks and ``truth/``.
        seed: Another room; None is the built-in one.
        kind: Of the room, of `ROOM_KINDS`; None: drawn from the seed.
        frames: Length of the walk.
        width: Of the images, pixels.
        height: Of the images, pixels.
        noise: Of the depth camera; `synthetic.NO_NOISE` for true depth.
        pose_noise: Of the poses; by default they are the true ones.
        library: What the room is furnished with; by default the package's own models.
        reporter: Receives progress.

    Raises:
        OutputError: the folder holds something else.
        SettingError: there is no such kind of room, or no frame is asked for.
        LibraryError: the library lacks what such a room cannot be without.
        SceneError: no room was found that stands.
        LibraryError: the library lacks what a room cannot be without.
    """
    out_dir, reporter = Path(out_dir), reporter or LogReporter()
    plan = FilmPlan(seed, kind, frames, width, height, noise, pose_noise)
    _refuse(plan)
    library = default_library() if library is None else library
    stamp = plan.stamp(library)
    kept = _same_film(out_dir, stamp)
    reporter.stage("synthetic", kept)
    if not kept:
        _film(_standing(plan, library, out_dir, reporter), plan, out_dir, reporter)
        (out_dir / _STAMP).write_text(json.dumps(stamp), "utf-8")
    return out_dir


def image_size(text: str) -> tuple[int, int]:
    """Width and height in pixels of ``640x480``.

    Raises:
        SettingError: it is written otherwise.
    """
    found = re.fullmatch(r"(\d+)x(\d+)", text.strip())
    if found is None:
        raise SettingError(f"{text!r} is no size of images", "write width x height: 640x480")
    return int(found[1]), int(found[2])


def is_filmed(out_dir: Path, plan: FilmPlan, library: CadLibrary) -> bool:
    """Whether this very film lies there, finished."""
    return _stamp_of(out_dir) == plan.stamp(library)


def _refuse(plan: FilmPlan) -> None:
    if plan.kind is not None and plan.kind not in ROOM_KINDS:
        raise SettingError(
            f"unknown kind of room {plan.kind!r}", f"use one of: {', '.join(ROOM_KINDS)}"
        )
    if plan.kind is not None and plan.seed is None:
        raise SettingError("the built-in room has its own kind", "give a seed, too")
    if min(plan.frames, plan.width, plan.height) < 1:
        raise SettingError(
            f"{plan.frames} frames of {plan.width}x{plan.height} pixels",
            "give at least one of each",
        )


def _standing(plan: FilmPlan, library: CadLibrary, out_dir: Path, reporter: Reporter) -> Room:
    twin_dir = out_dir / "truth" / "twin"
    if plan.seed is None:
        room = synthetic.builtin_room(library)
        return made_to_stand(room, library, twin_dir=twin_dir, reporter=reporter).room
    return standing_room(
        plan.seed, library, kind=plan.kind, twin_dir=twin_dir, reporter=reporter
    ).room


def _film(room: Room, plan: FilmPlan, out_dir: Path, reporter: Reporter) -> None:
    synthetic.render_sequence(
        room,
        out_dir,
        frames=plan.frames,
        width=plan.width,
        height=plan.height,
        noise=plan.noise,
        pose_noise=plan.pose_noise,
        seed=plan.seed or 0,
        progress=lambda done, total: reporter.progress("synthetic", done, total),
    )


def _stamp_of(out_dir: Path) -> dict[str, Any] | None:
    stamp = out_dir / _STAMP
    return json.loads(stamp.read_text("utf-8")) if stamp.exists() else None


def _same_film(out_dir: Path, wanted: dict[str, Any]) -> bool:
    """Whether this film is there; else the folder is emptied of another one, or of half a film."""
    try:
        found = _stamp_of(out_dir)
        if found is not None:
            if found == wanted:
                return True
            # Frames of a longer film would be read as part of a shorter one.
            shutil.rmtree(out_dir)
        elif out_dir.exists() and any(out_dir.iterdir()):
            raise OutputError(f"{out_dir} holds something else", "give a new folder for the film")
        out_dir.mkdir(parents=True, exist_ok=True)
        (out_dir / _STAMP).write_text(
            "{}", "utf-8"
        )  # marks the folder as a film that is not finished
    except OSError as error:
        raise OutputError(
            f"cannot write to {out_dir}: {error.strerror}", "give another --out"
        ) from None
    return False
