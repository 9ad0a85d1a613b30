"""Border: OpenCV. A contact sheet of a sequence: what some of its frames show, in four rows."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import Int, UInt8

from ...borders.drawing import instance_colors
from ...errors import OutputError, SequenceError

_WIDTH_PX = 240
"""Of one picture."""
_GAP_PX, _MARGIN_PX = 4, 22
_FAR_M = 5.0
"""The depth that gets the last colour."""
_ROWS = ("color", "depth", "instances", "parts")


def contact_sheet(sequence_dir: Path, out_png: Path, *, frames: int = 8) -> None:
    """Write a PNG of frames spread evenly over a rendered sequence, a column each.

    Rows: colour; depth from red (near) over green to blue (5 m), black where nothing returned;
    instances; parts (links of articulated models). Grey: none.

    Args:
        sequence_dir: From `render_sequence`.
        out_png: Written.
        frames: Columns; as many as there are frames at most.

    Raises:
        SequenceError: the folder holds no rendered sequence.
        OutputError: the picture cannot be written.
    """
    sequence_dir, out_png = Path(sequence_dir), Path(out_png)
    names = sorted(path.stem for path in (sequence_dir / "rgb").glob("*.jpg"))
    if not names or frames < 1:
        problem = f"{sequence_dir} has no frames to show ({len(names)} found, {frames} asked for)"
        raise SequenceError(problem, "give a folder that `isr synth` wrote, and one frame or more")
    chosen = np.unique(np.linspace(0, len(names) - 1, frames).round().astype(int))
    scale = _depth_scale(sequence_dir)
    columns = [_column(sequence_dir, names[i], scale) for i in chosen]
    gap = np.full((columns[0].shape[0], _GAP_PX, 3), 255, np.uint8)
    sheet = np.hstack([piece for column in columns for piece in (column, gap)][:-1])
    sheet = np.hstack([_captions(columns[0].shape[0]), sheet])
    try:
        out_png.parent.mkdir(parents=True, exist_ok=True)
        written = cv2.imwrite(str(out_png), np.ascontiguousarray(sheet[..., ::-1]))
    except (OSError, cv2.error):
        written = False
    if not written:
        raise OutputError(f"{out_png} could not be written", "give a path that ends in .png")


def depth_colors(depth_m: np.ndarray, far_m: float = _FAR_M) -> UInt8[np.ndarray, "height width 3"]:
    """RGB of a depth image: near is red, ``far_m`` and beyond blue, 0 black."""
    near = 1 - np.clip(depth_m / far_m, 0, 1)
    bgr = cv2.applyColorMap((255 * near).astype(np.uint8), cv2.COLORMAP_TURBO)
    rgb = np.ascontiguousarray(bgr[..., ::-1])
    rgb[depth_m <= 0] = 0
    return rgb


def _column(folder: Path, name: str, depth_scale: float) -> UInt8[np.ndarray, "height width 3"]:
    panoptic = _read(folder / "panoptic" / f"{name}.png")[..., ::-1].astype(np.int32)
    instance = panoptic[..., 0] << 16 | panoptic[..., 1] << 8 | panoptic[..., 2]
    depth_m = _read(folder / "depth" / f"{name}.png").astype(np.float32) / depth_scale
    pictures = (
        _read(folder / "rgb" / f"{name}.jpg")[..., ::-1],
        depth_colors(depth_m),
        _labels(instance),
        _labels(_read(folder / "parts" / f"{name}.png").astype(np.int32)),
    )
    ways = (cv2.INTER_AREA, cv2.INTER_NEAREST, cv2.INTER_NEAREST, cv2.INTER_NEAREST)
    height = round(_WIDTH_PX * pictures[0].shape[0] / pictures[0].shape[1])
    gap = np.full((_GAP_PX, _WIDTH_PX, 3), 255, np.uint8)
    small = [
        cv2.resize(np.ascontiguousarray(p), (_WIDTH_PX, height), interpolation=w)
        for p, w in zip(pictures, ways, strict=True)
    ]
    return np.vstack([piece for picture in small for piece in (picture, gap)][:-1])


def _labels(ids: Int[np.ndarray, "height width"]) -> UInt8[np.ndarray, "height width 3"]:
    return instance_colors(ids.ravel()).reshape(*ids.shape, 3)


def _captions(height: int) -> UInt8[np.ndarray, "height margin 3"]:
    """The names of the rows, read from below."""
    strip = np.full((_MARGIN_PX, height, 3), 255, np.uint8)
    each = (height + _GAP_PX) / len(_ROWS)
    for i, text in enumerate(reversed(_ROWS)):
        (width, _), _ = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, 0.5, 1)
        at = (round((i + 0.5) * each - width / 2), _MARGIN_PX - 7)
        cv2.putText(strip, text, at, cv2.FONT_HERSHEY_SIMPLEX, 0.5, (40,) * 3, 1, cv2.LINE_AA)
    return np.rot90(strip)


def _depth_scale(folder: Path) -> float:
    path = folder / "intrinsics.json"
    try:
        return float(json.loads(path.read_text("utf-8"))["depth_scale"])
    except (OSError, ValueError, KeyError) as error:
        problem = f"{path} cannot be read: {type(error).__name__} {error}"
        raise SequenceError(problem, "give a folder that `isr synth` wrote") from None


def _read(path: Path) -> np.ndarray:
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if image is None:
        raise SequenceError(f"{path} is no image that can be read", "render the sequence again")
    return image
