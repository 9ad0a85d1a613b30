"""Border: panoptic masks computed elsewhere, as COCO panoptic PNG and JSON (OpenCV, files)."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from ..classes import class_named, label_table
from ..errors import ClassError, FrameError, SegmenterError
from ..types import Frame, PanopticFrame

_COCO_NAMES = {
    (1, "person"),
    (62, "chair"),
    (67, "dining table"),
    (118, "floor-wood"),
    (190, "floor-other-merged"),
    (199, "wall-other-merged"),
}
"""Categories by which COCO panoptic is told from a list of our own classes."""


class FileMasks:
    """Reads ``panoptic.json`` and the PNG files of ``panoptic/`` beside it.

    A PNG's pixel is id = R + 256 G + 65536 B; 0 and ids without a segment are "nothing here".
    Categories carry our class names, or COCO panoptic ids. An image belongs to the frame of the
    same name.
    """

    def __init__(self, folder: Path | str) -> None:
        self.folder = Path(folder)
        self._json = self.folder / "panoptic.json"
        content = _read_json(self._json)
        _check_members(content, self._json)
        self._class_of = _category_classes(content["categories"], self._json)
        self._annotations = {Path(a["file_name"]).stem: a for a in content["annotations"]}
        self.name = f"masks:{self.folder.name}"

    def __call__(self, frame: Frame) -> PanopticFrame:
        return self.read(frame)[0]

    def read(self, frame: Frame) -> tuple[PanopticFrame, np.ndarray]:
        """The masks of a frame, and the id in the file of each of their rows (0 for row 0)."""
        annotation = self._annotations.get(frame.name)
        if annotation is None:
            raise FrameError(
                f"{self._json} has no annotation for frame {frame.name!r}",
                "add it (file_name is the frame's name), or read annotated frames (input.stride)",
            )
        ids = _read_ids(self.folder / "panoptic" / annotation["file_name"], frame)
        segments = annotation["segments_info"]
        segment_ids = np.array([0, *(s["id"] for s in segments)], np.int64)
        order = np.argsort(segment_ids, kind="stable")
        at = np.minimum(np.searchsorted(segment_ids[order], ids), len(order) - 1)
        row = np.where(segment_ids[order][at] == ids, order[at], 0).astype(np.int32)
        class_id = np.array([0, *(self._category(s) for s in segments)], np.int32)
        score = np.array([0.0, *(s.get("score", 1.0) for s in segments)], np.float32)
        # What our table has no class for is no mask.
        return PanopticFrame(np.where(class_id[row] > 0, row, 0), class_id, score), segment_ids

    def _category(self, segment: dict[str, Any]) -> int:
        try:
            return self._class_of[segment["category_id"]]
        except KeyError:
            raise SegmenterError(
                f"{self._json}: segment {segment['id']} has category {segment['category_id']}, "
                "which `categories` does not list",
                "add the category to the file",
            ) from None

    def content_hash(self) -> str:
        digest = hashlib.sha256(self._json.read_bytes())
        for name in sorted(a["file_name"] for a in self._annotations.values()):
            path = self.folder / "panoptic" / name
            digest.update(name.encode())
            if path.is_file():
                digest.update(path.read_bytes())
        return digest.hexdigest()

    def describe(self) -> str:
        return f"masks from {self._json}: {len(self._annotations)} frames"


def _read_json(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text("utf-8"))
    except FileNotFoundError:
        raise SegmenterError(
            f"no masks: {path} does not exist",
            "give a folder with panoptic.json and panoptic/*.png, or another --segmenter",
        ) from None
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise SegmenterError(f"{path} is not JSON: {error}", "write it again") from None
    _check_keys(content, ("annotations", "categories"), str(path))
    return content


def _check_members(content: dict[str, Any], path: Path) -> None:
    """What every category, annotation and segment must have, found before any frame is read."""
    for i, category in enumerate(content["categories"]):
        _check_keys(category, ("id", "name"), f"{path}: categories[{i}]")
    for i, annotation in enumerate(content["annotations"]):
        where = f"{path}: annotations[{i}]"
        _check_keys(annotation, ("file_name", "segments_info"), where)
        for j, segment in enumerate(annotation["segments_info"]):
            _check_keys(segment, ("id", "category_id"), f"{where}.segments_info[{j}]")


def _check_keys(member: Any, keys: tuple[str, ...], where: str) -> None:
    missing = [k for k in keys if not isinstance(member, dict) or k not in member]
    if missing:
        raise SegmenterError(
            f"{where} has no {' and no '.join(missing)}", "follow the COCO panoptic format"
        )


def _category_classes(categories: list[dict[str, Any]], path: Path) -> dict[int, int]:
    if any((c["id"], c["name"]) in _COCO_NAMES for c in categories):
        table = label_table("coco_panoptic")
        return {c["id"]: int(table[c["id"]]) if c["id"] < len(table) else 0 for c in categories}
    try:
        return {c["id"]: class_named(c["name"]).id for c in categories}
    except ClassError as error:
        raise SegmenterError(f"{path}: {error.problem}", error.hint) from None


def _read_ids(path: Path, frame: Frame) -> np.ndarray:
    image = cv2.imread(str(path), cv2.IMREAD_COLOR_RGB) if path.is_file() else None
    if image is None:
        raise FrameError(f"{path} is missing or is no PNG", "write the mask of this frame again")
    if image.shape[:2] != frame.depth_m.shape:
        raise FrameError(
            f"{path} is {image.shape[1]}x{image.shape[0]}, the depth image "
            f"{frame.depth_m.shape[1]}x{frame.depth_m.shape[0]}",
            "make the masks at the size of the depth images",
        )
    image = image.astype(np.int64)
    return image[..., 0] + 256 * image[..., 1] + 65536 * image[..., 2]
