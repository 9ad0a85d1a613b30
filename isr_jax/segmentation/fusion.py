"""Masks and depth segments correct each other (paper, section IV, Per-frame Segmentation)."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Bool, Int

from ..classes import classes
from ..config import SegmentationSettings
from ..types import Frame, FrameSegments, PanopticFrame
from .depth_segments import segment_depth
from .outliers import largest_clusters

_HOME_RATIO = 0.5
"""A segment less covered than this follows a mask only if so much of the mask lies in it."""


@dataclasses.dataclass(frozen=True, eq=False)
class _Pieces:
    """Parts of segments with one mask: (segment, mask) pairs and the piece of every pixel."""

    piece: np.ndarray
    """[height, width], 0 = none."""
    segment: np.ndarray
    mask: np.ndarray
    pixels: np.ndarray


def segment_frame(
    frame: Frame,
    panoptic: PanopticFrame,
    settings: SegmentationSettings,
) -> FrameSegments:
    """Segments of one frame with the class and instance that its masks give them.

    Args:
        frame: Depth and camera are used.
        panoptic: Masks; those with a score below ``settings.min_score`` are ignored.
        settings: Of this stage. With ``bilateral`` masks also split segments, else segments only
            take labels; with ``remove_outliers`` pieces of a thing far from the rest of it go to
            the background; with ``fill_from_masks`` pixels that no segment holds (edges of depth,
            noise far away: a seventh of the returns of a furnished room) follow their mask.

    Returns:
        ``instance`` is the row of the mask in ``panoptic``, for layout and stuff as well. Classes
        of kind ``dynamic`` are kept so that mapping can leave them out.
    """
    segment = segment_depth(frame.depth_m, frame.camera, settings)
    mask = np.where(panoptic.score >= settings.min_score, np.arange(len(panoptic.score)), 0)
    mask = mask[panoptic.mask].astype(np.int32)
    return label_segments(frame, segment, mask, panoptic.class_id, settings)


def label_segments(
    frame: Frame,
    segment: Int[np.ndarray, "height width"],
    mask: Int[np.ndarray, "height width"],
    mask_class: Int[np.ndarray, " masks"],
    settings: SegmentationSettings,
) -> FrameSegments:
    """As `segment_frame`, from depth segments that are already there."""
    seen = frame.depth_m > 0
    shape = (int(segment.max()) + 1, len(mask_class))
    pair = np.where(seen, segment * shape[1] + mask, 0).ravel()
    counts = np.bincount(pair, minlength=shape[0] * shape[1]).reshape(shape)
    counts[0, 0] -= np.count_nonzero(~seen)
    kinds = np.array([info.kind for info in classes()])[mask_class]
    is_small = counts.sum(1) < settings.min_segment_px
    is_small[0] = True  # what no segment holds is fragments
    label = _labels(counts, kinds, is_small, settings)
    pieces = _cut(label, pair, segment.shape)
    is_stray = np.zeros(len(pieces.mask), bool)
    if settings.remove_outliers:
        is_thing = kinds[pieces.mask] == "thing"
        is_stray = is_thing & ~largest_clusters(
            frame.depth_m,
            frame.camera,
            pieces.piece,
            np.where(is_thing, pieces.mask, 0),
            settings.cluster_distance_m,
        )
    return _assemble(pieces, is_small, is_stray, mask_class)


def _labels(
    counts: Int[np.ndarray, "segments masks"],
    kinds: np.ndarray,
    is_small: Bool[np.ndarray, " segments"],
    settings: SegmentationSettings,
) -> Int[np.ndarray, "segments masks"]:
    """Mask whose label the pixels of each (segment, mask) pair take; -1 = none, 0 = background."""
    area, mask_area = counts.sum(1, keepdims=True), counts.sum(0, keepdims=True)
    enough = counts >= max(settings.min_piece_px, 1)
    apart = np.isin(kinds, ("thing", "stuff") if settings.cut_out_stuff else ("thing",))
    cut_out = (
        enough
        & apart
        & (counts > settings.mask_in_segment_ratio * mask_area)
        & (counts < settings.cut_out_ratio * area)
    )
    split = enough & (counts >= settings.split_ratio * area)
    split &= counts >= settings.split_mask_ratio * mask_area
    keeps = (cut_out | split) & settings.bilateral
    keeps[:, 0] = False
    rest = _majority(np.where(cut_out & settings.bilateral, 0, counts), mask_area[0], settings)
    # A speck of depth is a segment only if a mask holds most of it.
    best = counts[np.arange(len(rest)), rest]
    rest = np.where(is_small & ((rest == 0) | (best < 0.5 * area[:, 0])), -1, rest)
    rest[0] = -1
    keeps[0] = False
    label = np.where(keeps, np.arange(counts.shape[1]), rest[:, None])
    if settings.fill_from_masks:
        label[0, 1:] = np.arange(1, counts.shape[1])
    # People move: all that their mask covers is left out of the map, whatever its shape.
    dynamic = np.flatnonzero(kinds == "dynamic")
    label[:, dynamic] = dynamic
    return label


def _majority(
    counts: Int[np.ndarray, "segments masks"],
    mask_area: Int[np.ndarray, " masks"],
    settings: SegmentationSettings,
) -> Int[np.ndarray, " segments"]:
    """The mask that most of each segment lies in; 0 where it holds too little of the segment."""
    area, covered = counts.sum(1), counts.copy()
    covered[:, 0] = 0
    best = covered.argmax(1)
    count = covered[np.arange(len(best)), best]
    follows = count > 0
    follows &= count >= settings.majority_ratio * area
    if settings.bilateral:
        # A mask that is mostly elsewhere has only spilled over a segment that it half covers.
        follows &= (count >= 0.5 * area) | (count >= _HOME_RATIO * mask_area[best])
    return np.where(follows, best, 0)


def _cut(label: np.ndarray, pair: np.ndarray, shape: tuple[int, ...]) -> _Pieces:
    """Number the (segment, label) pairs that occur, and label every pixel with its piece."""
    segments, masks = label.shape
    pixels = np.bincount(pair, minlength=segments * masks)
    key = np.where(label < 0, -1, np.arange(segments)[:, None] * masks + label).ravel()
    occurs = (key >= 0) & (pixels > 0)
    found, inverse = np.unique(key[occurs], return_inverse=True)
    piece_of_pair = np.zeros(segments * masks, np.int32)
    piece_of_pair[occurs] = inverse + 1
    # Pixels without return share pair 0 with unsegmented background; its label is -1.
    sizes = np.bincount(piece_of_pair, weights=pixels, minlength=len(found) + 1).astype(np.int64)
    table = np.concatenate([[0], found])
    return _Pieces(piece_of_pair[pair].reshape(shape), table // masks, table % masks, sizes)


def _assemble(
    pieces: _Pieces, is_small: np.ndarray, is_stray: np.ndarray, mask_class: np.ndarray
) -> FrameSegments:
    """Fragments of one mask become one segment, strays become background; then number densely."""
    count = len(pieces.mask)
    number = np.arange(count)
    fragment = is_small[pieces.segment] & (number > 0)
    first = np.full(len(mask_class), -1)
    kept = np.flatnonzero(fragment & ~is_stray)[::-1]
    first[pieces.mask[kept]] = kept
    number = np.where(fragment, np.where(is_stray, 0, first[pieces.mask]), number)
    found, dense = np.unique(np.concatenate([[0], number]), return_inverse=True)
    mask = np.where(is_stray, 0, pieces.mask)[found]
    mask[0] = 0
    return FrameSegments(
        segment=dense[1:].astype(np.int32)[pieces.piece],
        class_id=np.asarray(mask_class)[mask].astype(np.int32),
        instance=mask.astype(np.int32),
    )
