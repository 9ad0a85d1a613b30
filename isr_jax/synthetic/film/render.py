"""Border: OpenCV. Writes a room as a plain-folder sequence with its truth."""

from __future__ import annotations

import collections
import dataclasses
import json
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from scipy import ndimage

from ...classes import class_named, classes
from ...config import NoiseModel, PoseNoise
from ...errors import OutputError
from ...types import Camera
from ..camera.cameras import default_camera as default_camera
from ..camera.cameras import named_camera
from ..camera.drift import NO_DRIFT, tracked_path
from ..camera.free_space import free_space
from ..camera.walk import camera_path
from ..image.shading import Developed
from ..room import Room
from ..truth_files import write_truth
from .film import Film, Look, SeenSurface, Shot, class_names, joined
from .views import FrameViews, Views

DEPTH_SCALE = 1000.0
"""Units of the depth images per metre."""
_JPEG_QUALITY = 92
_DARKROOMS = 2
"""Threads that make images of what rays met, and write them."""
_PENDING = 4
"""Frames that may wait for them."""


@dataclasses.dataclass(frozen=True, eq=False)
class _Printed:
    """What is kept of a frame once its files are written."""

    seen: SeenSurface
    annotation: dict[str, Any]
    views: FrameViews


def render_sequence(
    room: Room,
    out_dir: Path,
    *,
    frames: int = 150,
    width: int = 640,
    height: int = 480,
    noise: NoiseModel = NoiseModel(),  # noqa: B008 (frozen)
    pose_noise: PoseNoise = NO_DRIFT,
    camera: str | Camera = "kinect",
    seed: int = 0,
    progress: Callable[[int, int], None] | None = None,
) -> None:
    """Film a room and write the sequence, its panoptic labels and its truth.

    Written: ``rgb/``, ``depth/`` (uint16 millimetres), ``poses/`` (camera to dataset),
    ``intrinsics.json``, ``panoptic/`` and ``panoptic.json`` (COCO panoptic; segment id = entity
    id), ``parts/`` (uint16 ids of ``truth/parts.json``), and of the truth what `write_truth` lists
    and ``views.json`` (`Views.record`). With pose noise ``poses/`` are the tracker's and
    ``truth/poses/`` the true ones. The same arguments write the same bytes.

    Args:
        room: From `make_room`.
        out_dir: Made where it is missing.
        frames: Length of the walk.
        width: Of the images, pixels.
        height: Of the images, pixels.
        noise: The depth sensor; `NO_NOISE` for true depth.
        pose_noise: Drift and jitter of the poses.
        camera: A name of `cameras.CAMERAS`, or one that says its own width and height.
        seed: Of the walk and the noise.
        progress: Called with (frames done, frames) after each frame.

    Raises:
        OutputError: the folder cannot be written.
        SceneError: nowhere in the room is space for a camera.
        SettingError: no camera has that name.
    """
    out_dir = Path(out_dir)
    if isinstance(camera, str):
        camera = named_camera(camera, width, height)
    path = camera_path(room, frames, seed, camera=camera, sensor=noise)
    film = Film(room, camera, noise, seed)
    space = free_space(room, seed)
    views = Views(film.surfaces, film.scene, space, camera, noise, seed)
    make_folders(out_dir, pose_noise)
    _write_json(out_dir / "intrinsics.json", _intrinsics(room, camera))
    _write_poses(room, out_dir, path, pose_noise, seed)
    printed = _filmed(out_dir, room, film, views, path, progress)
    annotations = [frame.annotation for frame in printed]
    _write_json(out_dir / "panoptic.json", _panoptic_index(camera, annotations))
    write_truth(room, out_dir / "truth", joined([frame.seen for frame in printed]))
    by_name = {frame_name(i): frame.views for i, frame in enumerate(printed)}
    names = {entity.id: entity.name for entity in (*room.layout, *room.items)}
    _write_json(out_dir / "truth" / "views.json", views.record(by_name, names))


def _filmed(
    out_dir: Path,
    room: Room,
    film: Film,
    views: Views,
    path: np.ndarray,
    progress: Callable[[int, int], None] | None,
) -> list[_Printed]:
    """Cast the rays of one frame while threads develop and write those before it."""
    printed: list[_Printed] = []
    pending: collections.deque[Future[_Printed]] = collections.deque()
    with ThreadPoolExecutor(_DARKROOMS) as pool:
        for index, pose in enumerate(path):
            look = film.look(pose)
            job = (out_dir, room, film, views, index, pose, look, film.expose(look))
            pending.append(pool.submit(_print, *job))
            while len(pending) > _PENDING or (pending and index == len(path) - 1):
                printed.append(pending.popleft().result())
            if progress is not None:
                progress(index + 1, len(path))
    return printed


def _print(
    out_dir: Path,
    room: Room,
    film: Film,
    views: Views,
    index: int,
    pose: np.ndarray,
    look: Look,
    developed: Developed,
) -> _Printed:
    shot = film.shot(index, look, developed)
    write_shot(out_dir, index, shot)
    shown = views.frame(pose, shot.instance, shot.true_depth_m)
    return _Printed(shot.seen, _annotation(room, index, shot), shown)


def frame_name(index: int) -> str:
    """Stem of a frame's files."""
    return f"{index:06d}"


def make_folders(out_dir: Path, pose_noise: PoseNoise = NO_DRIFT) -> None:
    """Make the folders of a sequence.

    Raises:
        OutputError: a folder cannot be made.
    """
    names = ["rgb", "depth", "poses", "panoptic", "parts", "truth"]
    for name in names + ["truth/poses"] * (pose_noise != NO_DRIFT):
        try:
            (out_dir / name).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(
                f"{out_dir / name}: {error.strerror}", "give an output folder that can be written"
            ) from None


def _intrinsics(room: Room, camera: Camera) -> dict[str, Any]:
    keys = ("fx", "fy", "cx", "cy", "width", "height")
    values = {key: getattr(camera, key) for key in keys}
    return values | {"depth_scale": DEPTH_SCALE, "gravity": room.gravity_dataset.tolist()}


def write_shot(out_dir: Path, index: int, shot: Shot) -> None:
    """Write the images of one frame into the folders of a sequence.

    Raises:
        OutputError: an image cannot be written.
    """
    name = frame_name(index)
    bgr = np.ascontiguousarray(shot.color[..., ::-1])
    quality = [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY]
    _write_image(out_dir / "rgb" / f"{name}.jpg", bgr, quality)
    millimetres = np.rint(shot.depth_m * np.float32(DEPTH_SCALE)).astype(np.uint16)
    fast = [cv2.IMWRITE_PNG_COMPRESSION, 1]
    _write_image(out_dir / "depth" / f"{name}.png", millimetres, fast)
    ids = shot.instance
    panoptic = np.stack([ids >> 16 & 255, ids >> 8 & 255, ids & 255], -1).astype(np.uint8)
    _write_image(out_dir / "panoptic" / f"{name}.png", panoptic, fast)
    _write_image(out_dir / "parts" / f"{name}.png", shot.part.astype(np.uint16), fast)


def _write_poses(room: Room, out_dir: Path, path: np.ndarray, noise: PoseNoise, seed: int) -> None:
    """What the tracker gives; where it errs, the truth too."""
    folders = {out_dir / "poses": tracked_path(path, noise, seed)}
    if noise != NO_DRIFT:
        folders[out_dir / "truth" / "poses"] = path
    T_dataset_world = np.linalg.inv(room.T_world_dataset)
    for folder, poses in folders.items():
        for index, pose in enumerate(poses):
            np.savetxt(folder / f"{frame_name(index)}.txt", T_dataset_world @ pose, fmt="%.9f")


def _write_image(path: Path, image: np.ndarray, options: list[int]) -> None:
    if not cv2.imwrite(str(path), image, options):
        raise OutputError(f"{path} could not be written", "is the disk full?")


def _annotation(room: Room, index: int, shot: Shot) -> dict[str, Any]:
    """COCO panoptic annotation of one frame."""
    class_of = class_names(room)
    area = np.bincount(shot.instance.ravel())
    segments = []
    for entity_id, place in enumerate(ndimage.find_objects(shot.instance), 1):
        if place is None:
            continue
        (top, bottom), (left, right) = ((side.start, side.stop) for side in place)
        segment = {
            "id": entity_id,
            "category_id": class_named(class_of[entity_id]).id,
            "area": int(area[entity_id]),
            "bbox": [left, top, right - left, bottom - top],
            "iscrowd": 0,
        }
        segments.append(segment)
    return {
        "image_id": index,
        "file_name": f"{frame_name(index)}.png",
        "segments_info": segments,
    }


def _panoptic_index(camera: Camera, annotations: list[dict[str, Any]]) -> dict[str, Any]:
    size = {"width": camera.width, "height": camera.height}
    ids = [annotation["image_id"] for annotation in annotations]
    images = [{"id": i, "file_name": f"{frame_name(i)}.jpg", **size} for i in ids]
    categories = [
        {
            "id": info.id,
            "name": info.name,
            "supercategory": info.kind,
            "isthing": int(info.kind == "thing"),
        }
        for info in classes()
        if info.id > 0
    ]
    return {"images": images, "annotations": annotations, "categories": categories}


def _write_json(path: Path, data: dict[str, Any]) -> None:
    path.write_text(json.dumps(data, allow_nan=False) + "\n", "utf-8")
