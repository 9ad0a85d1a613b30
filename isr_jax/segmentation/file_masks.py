"""Border: panoptic masks computed elsewhere, as COCO panoptic PNG and JSON (OpenCV, files)."""

from __future__ import annotations

import hashlib
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import Bool, Int

from ..classes import classes
from ..errors import FrameError
from ..types import Frame, PanopticFrame
from .components import connected_components
from .painting import MIN_PIXELS
from .panoptic_json import Annotation, PanopticIndex, find_json, read_index


class FileMasks:
    """Reads a COCO panoptic JSON file and the PNG files in the folder of its name beside it.

    ``panoptic.json`` has ``panoptic/``, ``panoptic_val2017.json`` has ``panoptic_val2017/``. A
    PNG's pixel is id = R + 256 G + 256^2 B, 0 for "nothing here"; every other id has its entry in
    ``segments_info``. Categories are COCO's, by id and name, or carry our class names. Segments of
    stuff that we call things (cabinets of COCO) become their connected components; crowds
    (``iscrowd``) are nobody's instance and left out. An annotation belongs to the frame of its
    image's name (that of the PNG where no image is listed).
    """

    def __init__(self, path: Path | str) -> None:
        self._json = find_json(Path(path))
        self.folder = self._json.parent
        self._index: PanopticIndex = read_index(self._json)
        self.name = f"masks:{self.folder.name}"

    def __call__(self, frame: Frame) -> PanopticFrame:
        return self.read(frame)[0]

    def read(self, frame: Frame) -> tuple[PanopticFrame, Int[np.ndarray, " masks"]]:
        """The masks of a frame, and the id in the file of each of their rows (0 for row 0).

        Raises:
            FrameError: The frame has no annotation, or its PNG is missing, of another size, or
                holds a segment that is not listed.
        """
        annotation = self._index.annotations.get(frame.name)
        if annotation is None:
            raise FrameError(
                f"{self._json} has no annotation for frame {frame.name!r}",
                "add it (file_name is the frame's name), or read annotated frames (input.stride)",
            )
        path = self._json.with_suffix("") / annotation.file_name
        row = _rows(_read_ids(path, frame), annotation, path)
        ids = np.array([0, *annotation.ids], np.int64)
        class_id = np.array([0, *annotation.class_ids], np.int32)
        score = np.array([0.0, *annotation.scores], np.float32)
        # What our table has no class for is no mask.
        row = np.where(class_id[row] > 0, row, 0)
        is_group = np.array([False, *annotation.is_group]) & _are_things(class_id)
        row, source = _separate(row, is_group)
        return PanopticFrame(row, class_id[source], score[source]), ids[source]

    def content_hash(self) -> str:
        digest = hashlib.sha256(self._json.read_bytes())
        for name in sorted(a.file_name for a in self._index.annotations.values()):
            path = self._json.with_suffix("") / name
            digest.update(name.encode())
            if path.is_file():
                digest.update(path.read_bytes())
        return digest.hexdigest()

    def describe(self) -> str:
        return f"masks from {self._json}: {len(self._index.annotations)} frames"


def _read_ids(path: Path, frame: Frame) -> Int[np.ndarray, "height width"]:
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED) if path.is_file() else None
    if image is None:
        raise FrameError(f"{path} is missing or is no PNG", "write the mask of this frame again")
    if image.dtype != np.uint8 or image.ndim != 3:
        raise FrameError(
            f"{path} is no RGB image of 8 bits per channel",
            "write ids as R + 256 G + 256^2 B (COCO panoptic)",
        )
    if image.shape[:2] != frame.depth_m.shape:
        raise FrameError(
            f"{path} is {image.shape[1]}x{image.shape[0]}, the depth image "
            f"{frame.depth_m.shape[1]}x{frame.depth_m.shape[0]}",
            "make the masks at the size of the depth images",
        )
    blue, green, red = (image[..., k].astype(np.int64) for k in range(3))
    return red + 256 * green + 65536 * blue


def _rows(
    ids: Int[np.ndarray, "height width"], annotation: Annotation, path: Path
) -> Int[np.ndarray, "height width"]:
    """Row of each pixel's segment, counted from 1; 0 = none."""
    known = np.array([0, *annotation.ids], np.int64)
    order = np.argsort(known, kind="stable")
    at = np.minimum(np.searchsorted(known[order], ids), len(order) - 1)
    strange = known[order][at] != ids
    if strange.any():
        raise FrameError(
            f"{path} has a segment {int(ids[strange][0])} that segments_info does not list",
            "write the mask and its annotation again, together",
        )
    return order[at].astype(np.int32)


def _are_things(class_id: Int[np.ndarray, " masks"]) -> Bool[np.ndarray, " masks"]:
    return np.array([info.kind == "thing" for info in classes()])[class_id]


def _separate(
    row: Int[np.ndarray, "height width"], is_group: Bool[np.ndarray, " masks"]
) -> tuple[Int[np.ndarray, "height width"], Int[np.ndarray, " rows"]]:
    """Give each connected component of the marked rows a row of its own.

    Returns:
        The new rows, and the old row that each of them comes from.
    """
    row, source = row.copy(), list(range(len(is_group)))
    for old in np.flatnonzero(is_group & np.isin(np.arange(len(is_group)), row)):
        label, area = connected_components(row == old)
        row[label > 0] = 0
        for count, k in enumerate(np.flatnonzero(area >= MIN_PIXELS)):
            row[label == k] = old if count == 0 else len(source)
            source += [int(old)] if count else []
    return row, np.array(source)
