"""Small moves so that nothing starts in the air or inside something else.

A model's plane is not at the very height of the scanned one, and alignment tolerates millimetres.
So, from the floor upwards, scan hulls are cut where they reach into others, and free bodies are
pushed out sideways and then set down on their supporting parent, each with all that it carries.
No body moves farther than a stated bound; what would need more stays where it is and is listed.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from ..classes import class_named
from ..config import ExportSettings
from ..robot_model import RobotModel
from ..types import ContactGraph, Entities, Mesh
from .bodies import Body, body_hulls
from .convex import (
    Hull,
    boxes_apart,
    cut_hull,
    hull_of_mesh,
    penetration_depth,
    separations,
    sideways_exit,
    vertical_gap,
)
from .scan_bodies import solid_link
from .slabs import Slab, slab_hull

_TOUCH_M = 1e-5
"""Overlaps below this are contact."""
_CUT_LIMIT = 0.5
"""A cut that leaves less than this share of a hull's volume is not made."""
_PUSHES = 20


@dataclasses.dataclass(frozen=True)
class Adjustments:
    """What export changed, by entity name."""

    shift_m: dict[str, tuple[float, float, float]]
    """Bodies that were moved."""
    cut_share: dict[str, float]
    """Share of the collision volume that scans kept after cutting."""
    unresolved: dict[str, str]
    """What still floats or overlaps, and by how much."""


class _Arrangement:
    """Hulls of everything while bodies are being moved."""

    def __init__(self, entities: Entities, graph: ContactGraph, slabs, bodies) -> None:
        self.entities, self.graph = entities, graph
        rows = {e.name: i for i, e in enumerate(entities)}
        self.bodies: dict[int, Body] = {b.position: b for b in bodies}
        self.hulls: dict[int, list[Hull]] = {}
        for slab in slabs:
            self.hulls.setdefault(rows[slab.entity_name], []).append(slab_hull(slab))
        self.hulls |= {b.position: body_hulls(b) for b in bodies}
        self.start = {i: b.T_world_root[:3, 3].copy() for i, b in self.bodies.items()}

    def subtree(self, i: int) -> list[int]:
        """The body and every free body that stands on it."""
        below = [i]
        for p in below:
            below += [int(c) for c in self.graph.children(p) if self.bodies[int(c)].free]
        return below

    def ancestors(self, i: int) -> set[int]:
        found: set[int] = set()
        while (i := int(self.graph.parent[i])) >= 0:
            found.add(i)
        return found

    def move(self, i: int, step: np.ndarray) -> None:
        for k in self.subtree(i):
            T = self.bodies[k].T_world_root.copy()
            T[:3, 3] += step
            self.bodies[k] = dataclasses.replace(self.bodies[k], T_world_root=T)
            self.hulls[k] = [Hull(h.vertices + step, h.normals) for h in self.hulls[k]]

    def shift(self, i: int) -> np.ndarray:
        return self.bodies[i].T_world_root[:3, 3] - self.start[i]

    def top_down(self) -> list[int]:
        return sorted(self.bodies, key=lambda i: (len(self.ancestors(i)), i))

    def overlaps(self, i: int, others) -> list[tuple[float, int, Hull, Hull]]:
        """Overlapping hull pairs of a body with others, deepest first."""
        found = [
            (penetration_depth(a, b), k, a, b)
            for k in others
            for a, b in _near_pairs(self.hulls[i], self.hulls[k])
        ]
        deep = [f for f in found if f[0] > _TOUCH_M]
        return sorted(deep, key=lambda f: -f[0])


def _near_pairs(first: list[Hull], second: list[Hull]) -> list[tuple[Hull, Hull]]:
    """Pairs whose axis-aligned boxes meet."""
    low_a, high_a, low_b, high_b = (
        np.array([getattr(hull, side) for hull in hulls])
        for hulls in (first, second)
        for side in ("low", "high")
    )
    near = np.all((low_a[:, None] <= high_b) & (low_b <= high_a[:, None]), axis=-1)
    return [(first[a], second[b]) for a, b in np.argwhere(near)]


def rest_on_supports(
    entities: Entities,
    graph: ContactGraph,
    slabs: tuple[Slab, ...],
    bodies: tuple[Body, ...],
    settings: ExportSettings,
) -> tuple[tuple[Body, ...], Adjustments]:
    """Bodies that touch what carries them and overlap nothing, as far as the bound allows."""
    scene = _Arrangement(entities, graph, slabs, bodies)
    cut, unresolved = {}, {}
    for i in scene.top_down():
        body = scene.bodies[i]
        if body.scan is not None:
            kept = _cut_scan(scene, i, settings.max_hull_vertices)
            cut |= {body.name: round(kept, 4)} if kept < 1 else {}
        if body.free:
            _push_out(scene, i, settings.max_shift_m)
            problem = _set_down(scene, i, settings.max_shift_m)
            unresolved |= {body.name: problem} if problem else {}
    for i, body in scene.bodies.items():
        problem = _what_overlaps(scene, i)
        if problem:
            unresolved[body.name] = "; ".join(filter(None, (unresolved.get(body.name), problem)))
    shifts = {scene.bodies[i].name: scene.shift(i) for i in sorted(scene.bodies)}
    moved = {
        name: (round(float(step[0]), 6), round(float(step[1]), 6), round(float(step[2]), 6))
        for name, step in shifts.items()
        if np.linalg.norm(step) > _TOUCH_M
    }
    result = tuple(scene.bodies[b.position] for b in bodies)
    return result, Adjustments(moved, cut, unresolved)


def _others(scene: _Arrangement, i: int) -> list[int]:
    """All but what carries the body and what it carries."""
    own = {*scene.subtree(i), *(int(c) for c in scene.graph.children(i))}
    parent = int(scene.graph.parent[i])
    return [k for k in scene.hulls if k not in own and k != parent]


def _cut_scan(scene: _Arrangement, i: int, max_vertices: int) -> float:
    """Cut a scan's hulls by face planes of what they reach into; the share of volume kept."""
    body = scene.bodies[i]
    link = body.robot.links[0]
    origin, meshes = body.T_world_root[:3, 3], list(link.hulls)
    before = _volume(meshes)
    children = [int(c) for c in scene.graph.children(i)]
    for k in [*_others(scene, i), *children]:
        if k in scene.bodies and scene.bodies[k].scan is not None and k > i and k not in children:
            continue  # of two scans the later one is cut, not both
        meshes = [_cut_by(m, origin, scene.hulls[k], max_vertices) for m in meshes]
    kept = _volume(meshes) / before
    if kept < 1:
        density = class_named(scene.entities[i].class_name).density_kg_m3
        solid = solid_link(link.name, tuple(meshes), density)
        solid = dataclasses.replace(solid, visuals=link.visuals)
        robot = RobotModel(body.name, (solid,), ())
        scene.bodies[i] = dataclasses.replace(body, robot=robot)
        scene.hulls[i] = body_hulls(scene.bodies[i])
    return kept


def _volume(meshes: list[Mesh]) -> float:
    return solid_link("", tuple(meshes), 1.0).mass_kg


def _cut_by(mesh: Mesh, origin: np.ndarray, others: list[Hull], max_vertices: int) -> Mesh:
    for other in others:
        hull = hull_of_mesh(mesh)
        hull = Hull(hull.vertices + origin, hull.normals)
        if boxes_apart(hull, other):
            continue
        gap, normals = separations(hull, other)
        best = int(np.argmax(gap))
        if gap[best] >= -_TOUCH_M:
            continue
        edge = float((other.vertices @ normals[best]).max() - origin @ normals[best])
        smaller = cut_hull(mesh, normals[best], edge, max_vertices)
        if smaller is not None and _volume([smaller]) >= _CUT_LIMIT * _volume([mesh]):
            mesh = smaller
    return mesh


def _push_out(scene: _Arrangement, i: int, bound_m: float) -> None:
    """Move a body sideways out of what it overlaps; undone where that does not succeed."""
    others = [k for k in _others(scene, i) if k not in scene.ancestors(i)]
    start = scene.shift(i)
    for _ in range(_PUSHES):
        overlaps = scene.overlaps(i, others)
        if not overlaps:
            return
        length, direction = sideways_exit(*overlaps[0][2:])
        step = direction * (length + _TOUCH_M)
        if not np.isfinite(length) or np.linalg.norm(scene.shift(i) + step) > bound_m:
            break
        scene.move(i, step)
    scene.move(i, start - scene.shift(i))


def _set_down(scene: _Arrangement, i: int, bound_m: float) -> str | None:
    """Lift or lower a body until it touches its parent; a message where it cannot."""
    parent = int(scene.graph.parent[i])
    if parent < 0:
        return "nothing carries it"
    gaps = [vertical_gap(a, b) for a in scene.hulls[i] for b in scene.hulls[parent]]
    gap, name = min(gaps), scene.entities[parent].name
    if not np.isfinite(gap):
        return f"no part of {name} lies below it"
    if np.linalg.norm(scene.shift(i) - [0, 0, gap]) > bound_m:
        return f"{1000 * gap:.1f} mm above {name}" if gap > 0 else f"{-1000 * gap:.1f} mm in {name}"
    scene.move(i, np.array([0, 0, -gap]))
    return None


def _what_overlaps(scene: _Arrangement, i: int) -> str | None:
    """The deepest overlap of a free body with anything but its own kin above it."""
    if not scene.bodies[i].free:
        return None
    overlaps = scene.overlaps(i, [k for k in scene.hulls if k != i])
    if not overlaps or overlaps[0][0] < 1e-3:
        return None
    depth, k = overlaps[0][:2]
    return f"{1000 * depth:.1f} mm in {scene.entities[k].name}"
