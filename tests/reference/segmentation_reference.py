"""Slow twins of the depth-segmentation kernels: one pixel and one neighbour at a time."""

from __future__ import annotations

import numpy as np


def back_project(depth_m, camera):
    """Point of every pixel, camera frame."""
    v, u = np.mgrid[: camera.height, : camera.width].astype(np.float64)
    rays = np.stack([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, np.ones_like(u)], -1)
    return rays * depth_m[..., None]


def neighbours(i, j, window, shape):
    r = window // 2
    for y in range(max(i - r, 0), min(i + r + 1, shape[0])):
        for x in range(max(j - r, 0), min(j + r + 1, shape[1])):
            yield y, x


def normals(depth_m, camera, window, depth_ratio):
    """Least-squares plane n . v = 1 in inverse depth, by lstsq over the gated window."""
    normal, valid = np.zeros((*depth_m.shape, 3)), np.zeros(depth_m.shape, bool)
    for i, j in np.ndindex(depth_m.shape):
        rows, right = [], []
        for y, x in neighbours(i, j, window, depth_m.shape):
            centre, column, z = depth_m[i, j], depth_m[y, j], depth_m[y, x]
            near_row = z > 0 and column > 0 and abs(1 / z - 1 / column) < depth_ratio / z
            near_column = column > 0 and centre > 0
            near_column = near_column and abs(1 / column - 1 / centre) < depth_ratio / column
            if near_row and near_column:
                rows.append([x - j, y - i, 1.0])
                right.append(1 / z)
        if len(rows) < 12 or np.linalg.matrix_rank(np.array(rows)) < 3:
            continue
        a, b, c = np.linalg.lstsq(np.array(rows), np.array(right), rcond=None)[0]
        # w = a (fx x / z + cx - j) + b (fy y / z + cy - i) + c, times z
        n = np.array([a * camera.fx, b * camera.fy, c + a * (camera.cx - j) + b * (camera.cy - i)])
        normal[i, j], valid[i, j] = -n / np.linalg.norm(n), True
    return normal, valid


def discontinuity_map(depth_m, normal, camera, window, ratio):
    points, rays = back_project(depth_m, camera), back_project(np.ones_like(depth_m), camera)
    steps = np.zeros(depth_m.shape, bool)
    for i, j in np.ndindex(depth_m.shape):
        z, n = depth_m[i, j], normal[i, j]
        for y, x in neighbours(i, j, window, depth_m.shape):
            if z == 0 or depth_m[y, x] == 0 or abs(depth_m[y, x] - z) <= ratio * z:
                continue
            facing = n @ rays[y, x]
            expected = n @ points[i, j] / facing if facing < 0 else np.inf
            steps[i, j] |= abs(depth_m[y, x] - expected) > ratio * z
    return steps


def convexity_map(depth_m, normal, camera, window, mask_m):
    points, phi = back_project(depth_m, camera), np.ones(depth_m.shape)
    for i, j in np.ndindex(depth_m.shape):
        for y, x in neighbours(i, j, window, depth_m.shape):
            if depth_m[y, x] == 0 or not normal[y, x].any():
                continue
            apart = points[i, j] - points[y, x]
            if apart @ (normal[i, j] - normal[y, x]) / 2 < mask_m:
                phi[i, j] = min(phi[i, j], normal[i, j] @ normal[y, x])
    return phi


def join_edges(label, depth_m, camera, window, distance_m):
    """Round by round, each unlabelled pixel takes the nearest seed among its 8 neighbours'."""
    points = back_project(depth_m, camera)
    label, seed = label.copy(), points.copy()
    for _ in range(window // 2):
        before, seeds_before = label.copy(), seed.copy()
        for i, j in np.ndindex(label.shape):
            if before[i, j] or depth_m[i, j] == 0:
                continue
            best = distance_m
            for y, x in neighbours(i, j, 3, label.shape):
                gap = np.linalg.norm(points[i, j] - seeds_before[y, x])
                if before[y, x] and gap < best:
                    best, label[i, j], seed[i, j] = gap, before[y, x], seeds_before[y, x]
    return label


def piece_labels(segment, mask, kinds, small_px, settings):
    """Mask whose label each pixel takes (-1 none, 0 background): the rules of bilateral fusion."""

    def apart(kind):
        return kind == "thing" or (kind == "stuff" and settings.cut_out_stuff)

    result = np.full(segment.shape, -1)
    for s in range(1, segment.max() + 1):
        here = segment == s
        area = here.sum()
        count = {m: np.count_nonzero(here & (mask == m)) for m in range(len(kinds))}
        total = {m: np.count_nonzero(mask == m) for m in range(len(kinds))}
        cut = {
            m
            for m in count
            if m
            and apart(kinds[m])
            and count[m] >= settings.min_piece_px
            and count[m] > settings.mask_in_segment_ratio * total[m]
            and count[m] < settings.cut_out_ratio * area
        }
        split = {
            m
            for m in count
            if m
            and count[m] >= settings.min_piece_px
            and count[m] >= settings.split_ratio * area
            and count[m] >= settings.split_mask_ratio * total[m]
        }
        left = {m: n for m, n in count.items() if m not in cut}
        rest_area = sum(left.values())
        best = max((m for m in left if m), key=lambda m: (left[m], -m), default=0)
        rest = 0
        if best and left[best] > 0 and left[best] >= settings.majority_ratio * rest_area:
            at_home = left[best] >= 0.5 * total[best]
            rest = best if left[best] >= 0.5 * rest_area or at_home else 0
        if area < small_px and (rest == 0 or count[rest] < 0.5 * area):
            rest = -1
        result[here] = rest
        for m in cut | split:
            result[here & (mask == m)] = m
    if settings.fill_from_masks:
        alone = (segment == 0) & (mask > 0)
        result[alone] = mask[alone]
    for m, kind in enumerate(kinds):
        if kind == "dynamic":
            result[(mask == m)] = m
    return result


def largest_clusters(points, owner, pixels, instance, distance_m):
    """Pieces of the largest cluster of each instance: all pairs of samples, clusters by flooding.

    Args:
        points: [samples, 3].
        owner: Piece of each sample.
        pixels: Of each piece.
        instance: Of each piece; 0 = of none.
        distance_m: At which samples hang together.
    """
    near = np.linalg.norm(points[:, None] - points[None], axis=-1) <= distance_m
    cluster = np.arange(len(instance))
    for a, b in zip(*np.nonzero(near), strict=True):
        if instance[owner[a]] == instance[owner[b]]:
            one, other = cluster[owner[a]], cluster[owner[b]]
            cluster[cluster == one] = other
    weight = np.array([pixels[cluster == c].sum() for c in cluster])
    most = np.array([weight[instance == i].max() for i in instance])
    return (instance == 0) | (weight == most)
