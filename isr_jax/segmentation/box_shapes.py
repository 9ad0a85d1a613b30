"""The shape of a thing inside its box, from depth and semantics."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float, Int

_AGREE_RATIO = 0.1
"""Semantics speak for a box when this share of it has the box's class."""
_MIN_DEPTH_RATIO = 0.2
"""With less depth in a box (black screens), the whole box is the mask."""
_BIN_M, _BIN_RATIO = 0.02, 0.01
"""Depth bins are 2 cm + 1 % of the depth; two empty ones in a row are a gap."""


def shape_in_box(
    box: Float[np.ndarray, " 4"],
    depth_m: Float[np.ndarray, "height width"],
    agrees: Bool[np.ndarray, "height width"],
    *,
    by_semantics: bool,
) -> Bool[np.ndarray, "height width"]:
    """Pixels of the thing in ``box`` (x0, y0, x1, y1).

    Large things whose outline the semantics know (``by_semantics``) are where the semantics agree
    with the box. Of others, the pixels in one cluster of depth about the seed: the median depth
    where semantics agree, else that of the middle of the box.
    """
    mask = np.zeros(depth_m.shape, bool)
    window = _window(box, depth_m.shape)
    depth, agree = depth_m[window], agrees[window]
    speaks = agree.mean() >= _AGREE_RATIO if agree.size else False
    if by_semantics and speaks:
        mask[window] = agree
        return mask
    seen = depth > 0
    if seen.mean() < _MIN_DEPTH_RATIO if seen.size else True:
        mask[window] = True
        return mask
    seeds = depth[seen & (agree if speaks else _middle(depth.shape))]
    seed_m = float(np.median(seeds if len(seeds) else depth[seen]))
    near_m, far_m = _cluster(depth[seen], seed_m)
    mask[window] = (depth >= near_m) & (depth <= far_m)
    return mask


def _window(box: np.ndarray, shape: tuple[int, ...]) -> tuple[slice, slice]:
    x0, y0 = np.floor(box[:2]).astype(int)
    x1, y1 = np.ceil(box[2:]).astype(int)
    return slice(max(y0, 0), min(y1, shape[0])), slice(max(x0, 0), min(x1, shape[1]))


def _middle(shape: tuple[int, ...]) -> np.ndarray:
    middle = np.zeros(shape, bool)
    h, w = shape
    middle[h // 4 : h - h // 4, w // 4 : w - w // 4] = True
    return middle


def _cluster(depth_m: np.ndarray, seed_m: float) -> tuple[float, float]:
    """Depths between the first gap before the seed and the first one behind it."""
    width_m = _BIN_M + _BIN_RATIO * seed_m
    bins = np.round((depth_m - seed_m) / width_m).astype(int)
    start = -int(bins.min())
    count = np.bincount(bins + start)
    occupied = count >= max(3, 1e-3 * len(depth_m))
    gap = ~occupied & ~np.append(occupied[1:], False)
    behind = np.flatnonzero(gap[start + 1 :])
    last = start + behind[0] if len(behind) else len(count) - 1
    gap = ~occupied & ~np.insert(occupied[:-1], 0, False)
    before = np.flatnonzero(gap[:start])
    first = before[-1] + 1 if len(before) else 0
    return seed_m + (first - start - 0.5) * width_m, seed_m + (last - start + 0.5) * width_m


def heights(
    depth_m: Float[np.ndarray, "height width"],
    K: Float[np.ndarray, "3 3"],
    T_world_camera: Float[np.ndarray, "4 4"],
) -> Float[np.ndarray, "height width"]:
    """Height over the floor of every pixel with depth, metres; 0 elsewhere."""
    up = T_world_camera[2].astype(np.float32)
    x = (np.arange(depth_m.shape[1], dtype=np.float32) - np.float32(K[0, 2])) / np.float32(K[0, 0])
    y = (np.arange(depth_m.shape[0], dtype=np.float32) - np.float32(K[1, 2])) / np.float32(K[1, 1])
    slope = (up[0] * x)[None, :] + (up[1] * y + up[2])[:, None]
    return np.where(depth_m > 0, depth_m * slope + up[3], np.float32(0))


def plausible_layout(
    class_map: Int[np.ndarray, "height width"],
    height_m: Float[np.ndarray, "height width"],
    seen: Bool[np.ndarray, "height width"],
    *,
    floor: int,
    ceiling: int,
    floor_tolerance_m: float = 0.2,
    ceiling_min_m: float = 1.8,
) -> Int[np.ndarray, "height width"]:
    """Take "floor" from what stands above it (a semantic model calls near table tops so), and
    "ceiling" from what is low. The world's floor is at height 0."""
    wrong = (class_map == floor) & (np.abs(height_m) > floor_tolerance_m)
    wrong |= (class_map == ceiling) & (height_m < ceiling_min_m)
    return np.where(wrong & seen, 0, class_map)
