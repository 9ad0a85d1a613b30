"""Slow twin of `isr_jax.contact_graph`: loops over entities and planes, float64, no culling."""

from __future__ import annotations

import numpy as np

from isr_jax.classes import class_named
from isr_jax.config import DEFAULT_SUPPORT
from isr_jax.types import ROOM, UNSUPPORTED

from .geometry_reference import convex_overlap, footprint_of, overlap_depth, rotation_z


def bottom(entity) -> float:
    return float(entity.box.center[2]) - float(entity.box.size[2]) / 2


def height(normal, offset, xy) -> float:
    return -(float(offset) + float(normal[0]) * xy[0] + float(normal[1]) * xy[1]) / float(normal[2])


def vertex_contact(child, normal, offset, vertices, near_m, rim_m) -> float:
    """Rectangle of the vertices near the plane below the child, over the child's bottom."""
    half = np.asarray(child.box.size, float)[:2] / 2
    turn = rotation_z(float(child.box.yaw))
    places = []
    for vertex in np.asarray(vertices, float):
        if abs(np.dot(normal, vertex) + offset) > near_m:
            continue
        place = (turn.T @ (vertex - np.asarray(child.box.center, float)))[:2]
        if np.all(np.abs(place) <= half + rim_m):
            places.append(np.clip(place, -half, half))
    if not places:
        return 0.0
    return float(np.prod(np.ptp(places, axis=0)) / np.prod(2 * half))


def polygon_contact(child, corners, margin_m) -> float:
    center = corners.mean(0)
    grown = []
    for corner in corners:
        moved = corner.astype(float)
        for side in (corners[1] - corners[0], corners[3] - corners[0]):
            unit = side / np.linalg.norm(side)
            moved = moved + np.sign((corner - center) @ unit) * margin_m * unit
        grown.append(moved[:2])
    area = convex_overlap(np.array(grown), footprint_of(child.box))
    return area / float(np.prod(np.asarray(child.box.size, float)[:2]))


def terms(scene, child, parent, k, settings) -> tuple[float, float, float]:
    """D, A and S of one triple."""
    normal = np.asarray(parent.planes.normal[k], float)
    offset = float(parent.planes.offset[k])
    if parent.is_layout and settings.layout_whole_polygon:
        contact = polygon_contact(child, parent.planes.corners[k], settings.layout_margin_m)
    else:
        near = settings.near_voxels * scene.voxel_size_m
        rim = settings.rim_voxels * scene.voxel_size_m
        contact = vertex_contact(child, normal, offset, parent.mesh.vertices, near, rim)
    gap = bottom(child) - height(normal, offset, np.asarray(child.box.center, float))
    return gap, contact, (1 - min(1.0, abs(gap))) * contact


def may_carry(child, parent) -> bool:
    if child.is_layout or child.id == parent.id:
        return False
    return parent.is_layout or (bottom(parent), parent.id) < (bottom(child), child.id)


def admissible(child, parent, gap, contact, score, settings) -> bool:
    mount = class_named(child.class_name).mount
    limit = settings.max_gap_m
    if mount == "floor" and parent.is_layout:
        limit = 1.0
    if mount in ("wall", "opening"):
        limit = settings.max_gap_mounted_m
    sinks = gap < -settings.max_sink_m and not parent.is_layout
    return (
        contact >= DEFAULT_SUPPORT.min_contact
        and score >= settings.min_score
        and gap <= limit
        and not sinks
    )


def supports(scene, settings, same_score=0.02):
    """Parent, plane and score of every entity."""
    found = []
    for child in scene:
        best = (ROOM if child.is_layout else UNSUPPORTED, -1, 0.0)
        rows = []
        for position, parent in enumerate(scene):
            if not may_carry(child, parent):
                continue
            for k in range(len(parent.planes.offset)):
                if parent.planes.normal[k][2] < DEFAULT_SUPPORT.up_cosine:
                    continue
                gap, contact, score = terms(scene, child, parent, k, settings)
                if not admissible(child, parent, gap, contact, score, settings):
                    continue
                rows.append((position, k, score))
                best = max(best, rows[-1], key=lambda row: row[2])
        level = [r for r in rows if r[0] == best[0] and r[2] >= best[2] - same_score]
        if level:
            planes = scene[best[0]].planes
            shares = {r: polygon_contact(child, planes.corners[r[1]], 0.0) for r in level}
            best = max(level, key=lambda row: (round(shares[row], 3), row[2]))
        if best[0] == UNSUPPORTED and settings.inside_furniture:
            best = (_furniture_around(scene, child), -1, 0.0)
        found.append(best)
    return found


def _furniture_around(scene, child):
    """The least fixed thing in whose box a movable thing stands by half; UNSUPPORTED if none."""
    around = []
    for position, other in enumerate(scene):
        info, (x, y, _) = class_named(other.class_name), np.asarray(other.box.size, float)
        top = bottom(other) + float(other.box.size[2])
        lower = may_carry(child, other) and not other.is_layout
        if not lower or info.movable or info.mount != "floor" or bottom(child) > top:
            continue
        half = np.array([(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)]) / 2
        corners = half @ rotation_z(float(other.box.yaw)).T + np.asarray(other.box.center, float)
        if polygon_contact(child, corners, 0.0) >= 0.5:
            around.append((float(np.prod(np.asarray(other.box.size, float))), position))
    movable = class_named(child.class_name).movable
    return min(around)[1] if around and movable else UNSUPPORTED


def carried_at(carrier, k, place) -> float:
    """Layout within 11 degrees of level is taken as level, at the mean height of its corners."""
    planes = carrier.planes
    if carrier.is_layout and abs(float(planes.normal[k][2])) > 0.98:
        return sum(float(corner[2]) for corner in planes.corners[k]) / 4
    return height(planes.normal[k], planes.offset[k], place)


def refined(scene, found):
    """Vertical centre and height of every box after refinement."""
    rows = []
    for entity, (parent, k, _) in zip(scene, found, strict=True):
        center, size = float(entity.box.center[2]), float(entity.box.size[2])
        if parent >= 0 and k >= 0:
            level = carried_at(scene[parent], k, np.asarray(entity.box.center, float))
            size_new = max(center + size / 2 - level, min(size, scene.voxel_size_m))
            center, size = level + size_new / 2, size_new
        rows.append((center, size))
    return np.array(rows)


def proximal(scene, graph):
    """Overlapping, non-supporting pairs of things by the graph's refined boxes, with depth."""
    pairs = {}
    for i in range(len(scene)):
        for j in range(i + 1, len(scene)):
            if scene[i].is_layout or scene[j].is_layout:
                continue
            if graph.parent[i] == j or graph.parent[j] == i:
                continue
            depth = overlap_depth(*(_box_at(graph.refined_box, at) for at in (i, j)))
            if depth > 0:
                pairs[i, j] = depth
    return pairs


def _box_at(box, position):
    return type(box)(box.center[position], np.asarray(box.yaw[position]), box.size[position])
