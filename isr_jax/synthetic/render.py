"""Border: OpenCV and trimesh. Writes a room as a plain-folder sequence with its truth."""

from __future__ import annotations

import collections
import json
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import trimesh
from scipy import ndimage
from trimesh.exchange.ply import export_ply

from ..classes import class_named, classes
from ..config import NoiseModel
from ..errors import OutputError
from ..scene_file import write_scene
from ..types import Camera, Mesh
from .filming import Film, SeenSurface, Shot, joined
from .room import Room
from .truth import scene_of_entities, true_entities
from .walk import camera_path

DEPTH_SCALE = 1000.0
"""Units of the depth images per metre."""
_FOCAL_PER_WIDTH = 585.0 / 640.0
_JPEG_QUALITY = 92
_WRITERS = 2
_PENDING = 8
"""Shots that may wait for the disk."""


def default_camera(width: int, height: int) -> Camera:
    """A pinhole camera with a Kinect's field of view."""
    focal = _FOCAL_PER_WIDTH * width
    return Camera(focal, focal, width / 2, height / 2, width, height)


def render_sequence(
    room: Room,
    out_dir: Path,
    *,
    frames: int = 150,
    width: int = 640,
    height: int = 480,
    noise: NoiseModel = NoiseModel(),  # noqa: B008 (frozen)
    seed: int = 0,
    progress: Callable[[int, int], None] | None = None,
) -> None:
    """Film a room and write the sequence, its panoptic labels and its truth.

    Written: ``rgb/``, ``depth/`` (uint16 millimetres), ``poses/`` (camera to dataset),
    ``intrinsics.json``, ``panoptic/`` and ``panoptic.json`` (COCO panoptic; segment id = entity
    id), ``truth/scene.json``, ``truth/meshes/``, ``truth/observed.npz``. The same arguments write
    the same bytes.

    Args:
        room: From `make_room`.
        out_dir: Made where it is missing.
        frames: Length of the walk.
        width: Of the images, pixels.
        height: Of the images, pixels.
        noise: The depth sensor; `NO_NOISE` for true depth.
        seed: Of the walk and the noise.
        progress: Called with (frames done, frames) after each frame.
    """
    out_dir = Path(out_dir)
    camera = default_camera(width, height)
    film = Film(room, camera, noise, seed)
    path = camera_path(room, frames, seed)
    _make_folders(out_dir)
    _write_json(out_dir / "intrinsics.json", _intrinsics(room, camera))
    seen: list[SeenSurface] = []
    annotations: list[dict[str, Any]] = []
    pending: collections.deque[Future[None]] = collections.deque()
    with ThreadPoolExecutor(_WRITERS) as pool:
        for index, pose in enumerate(path):
            shot = film.shoot(index, pose)
            seen.append(shot.seen)
            annotations.append(_annotation(room, index, shot))
            pending.append(pool.submit(_write_shot, out_dir, room, index, pose, shot))
            while len(pending) > _PENDING or (pending and index == frames - 1):
                pending.popleft().result()
            if progress is not None:
                progress(index + 1, frames)
    _write_json(out_dir / "panoptic.json", _panoptic_index(camera, annotations))
    _write_truth(room, out_dir / "truth", joined(seen))


def frame_name(index: int) -> str:
    """Stem of a frame's files."""
    return f"{index:06d}"


def _make_folders(out_dir: Path) -> None:
    for name in ("rgb", "depth", "poses", "panoptic", "truth/meshes"):
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


def _write_shot(out_dir: Path, room: Room, index: int, pose: np.ndarray, shot: Shot) -> None:
    name = frame_name(index)
    bgr = np.ascontiguousarray(shot.color[..., ::-1])
    quality = [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY]
    _write_image(out_dir / "rgb" / f"{name}.jpg", bgr, quality)
    millimetres = np.rint(shot.depth_m * DEPTH_SCALE).astype(np.uint16)
    fast = [cv2.IMWRITE_PNG_COMPRESSION, 1]
    _write_image(out_dir / "depth" / f"{name}.png", millimetres, fast)
    ids = shot.instance
    panoptic = np.stack([ids >> 16 & 255, ids >> 8 & 255, ids & 255], -1).astype(np.uint8)
    _write_image(out_dir / "panoptic" / f"{name}.png", panoptic, fast)
    T_dataset_camera = np.linalg.inv(room.T_world_dataset) @ pose
    np.savetxt(out_dir / "poses" / f"{name}.txt", T_dataset_camera, fmt="%.9f")


def _write_image(path: Path, image: np.ndarray, options: list[int]) -> None:
    if not cv2.imwrite(str(path), image, options):
        raise OutputError(f"{path} could not be written", "is the disk full?")


def _annotation(room: Room, index: int, shot: Shot) -> dict[str, Any]:
    """COCO panoptic annotation of one frame."""
    class_of = {patch.id: patch.class_name for patch in room.layout}
    class_of |= {item.id: item.model.class_name for item in room.items}
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


def _write_truth(room: Room, out_dir: Path, seen: SeenSurface) -> None:
    entities = true_entities(room)
    for entity in entities:
        _write_ply(out_dir / "meshes" / f"{entity.name}.ply", entity.mesh)
    np.savez_compressed(
        out_dir / "observed.npz",
        points=seen.points.astype(np.float32),
        normals=seen.normals.astype(np.float32),
        instance=seen.instance.astype(np.int32),
    )
    write_scene(scene_of_entities(room, entities), out_dir / "scene.json")


def _write_ply(path: Path, mesh: Mesh) -> None:
    whole = trimesh.Trimesh(
        mesh.vertices,
        mesh.faces,
        vertex_normals=mesh.normals,
        vertex_colors=mesh.colors,
        process=False,
    )
    path.write_bytes(export_ply(whole, vertex_normal=True))


def _write_json(path: Path, data: dict[str, Any]) -> None:
    path.write_text(json.dumps(data, allow_nan=False) + "\n", "utf-8")
