"""Small moves so that nothing starts in the air or inside something else.

A model's plane is not at the very height of the scanned one, and alignment tolerates millimetres.
So, from the floor upwards, scan hulls are cut where they reach into others, and free bodies are
pushed out sideways and then set down on their supporting parent, each with all that it carries.
No body moves farther than a stated bound; what would need more stays where it is and is listed.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable

import numpy as np
from jaxtyping import Float

from ..classes import class_named
from ..config import ExportSettings
from ..geometry.convex import penetration, shifted_part, vertical_gap
from ..geometry.placed_solids import PartOverlap, PlacedSolid, deepest_overlap, is_contact
from ..geometry.standing import StandingThings, SupportTree
from ..robot_model import RobotModel
from ..types import ContactGraph, Entities, Mesh
from .bodies import Body, body_solid
from .hull_meshes import cut_hull, part_of
from .scan_bodies import solid_link
from .slabs import Slab, slab_part

_TOUCH_M = 1e-5
"""Overlaps below this are contact."""
_WORTH_SAYING_M = 1e-3
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


class _RestingBodies:
    """Bodies and layout while bodies are being moved."""

    def __init__(
        self,
        entities: Entities,
        graph: ContactGraph,
        slabs: tuple[Slab, ...],
        bodies: tuple[Body, ...],
    ) -> None:
        self.entities, self.graph = entities, graph
        self.bodies: dict[int, Body] = {b.position: b for b in bodies}
        """Where they were put first."""
        rows, parts = {e.name: i for i, e in enumerate(entities)}, {}
        for slab in slabs:
            parts.setdefault(rows[slab.entity_name], []).append(slab_part(slab))
        solids = {i: PlacedSolid(tuple(of_one)) for i, of_one in parts.items()}
        solids |= {b.position: body_solid(b) for b in bodies}
        tree = SupportTree(graph.parent, fixed={b.position for b in bodies if not b.free})
        self.standing = StandingThings(tree, solids)

    @property
    def tree(self) -> SupportTree:
        return self.standing.tree

    def solid(self, i: int) -> PlacedSolid:
        return self.standing.things[i]

    def name(self, i: int) -> str:
        return self.entities[i].name

    def moved_body(self, i: int) -> Body:
        """A body where it stands."""
        T = self.bodies[i].T_world_root.copy()
        T[:3, 3] += self.standing.shift_m[i]
        return dataclasses.replace(self.bodies[i], T_world_root=T)

    def reshape(self, i: int, robot: RobotModel) -> None:
        """Give a body another shape where it stands."""
        self.bodies[i] = dataclasses.replace(self.bodies[i], robot=robot)
        self.standing.things[i] = body_solid(self.moved_body(i))

    def others(self, i: int) -> list[int]:
        """All but what the body carries."""
        own = {*self.tree.subtree(i), *(int(c) for c in self.graph.children(i))}
        return [k for k in self.standing.things if k not in own]

    def deepest(
        self, i: int, others: Iterable[int], *, but_contact: bool
    ) -> tuple[int, PartOverlap] | None:
        """What a body overlaps most, and how; with or without contact with what carries it."""
        found, least_m = None, _TOUCH_M
        for k in others:
            carried = but_contact and self.tree.stands_on(i, k)
            overlap = deepest_overlap(
                self.solid(i), self.solid(k), carried=carried, least_m=least_m
            )
            if overlap is not None:
                found, least_m = (k, overlap), overlap.depth_m
        return found


def rest_on_supports(
    entities: Entities,
    graph: ContactGraph,
    slabs: tuple[Slab, ...],
    bodies: tuple[Body, ...],
    settings: ExportSettings,
) -> tuple[tuple[Body, ...], Adjustments]:
    """Bodies that touch what carries them and overlap nothing, as far as the bound allows."""
    scene = _RestingBodies(entities, graph, slabs, bodies)
    cut, unresolved = {}, {}
    for i in scene.tree.top_down(scene.bodies):
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
    result = tuple(scene.moved_body(b.position) for b in bodies)
    return result, Adjustments(_shifts(scene), cut, unresolved)


def _shifts(scene: _RestingBodies) -> dict[str, tuple[float, float, float]]:
    """By name, of what was moved, to the micrometre."""
    found = {}
    for i in sorted(scene.bodies):
        step_m = scene.standing.shift_m[i]
        if np.linalg.norm(step_m) > _TOUCH_M:
            x, y, z = (round(float(s), 6) for s in step_m)
            found[scene.name(i)] = (x, y, z)
    return found


def _cut_scan(scene: _RestingBodies, i: int, max_vertices: int) -> float:
    """Cut a scan's hulls by face planes of what they reach into; the share of volume kept."""
    body = scene.moved_body(i)
    link = body.robot.links[0]
    origin, meshes = body.T_world_root[:3, 3], list(link.hulls)
    before = _volume(meshes)
    children = [int(c) for c in scene.graph.children(i)]
    for k in [*scene.others(i), *children]:
        if k in scene.bodies and scene.bodies[k].scan is not None and k > i and k not in children:
            continue  # of two scans the later one is cut, not both
        carried = scene.tree.stands_on(i, k)
        meshes = [_cut_by(m, origin, scene.solid(k), max_vertices, carried) for m in meshes]
    kept = _volume(meshes) / before
    if kept < 1:
        density = class_named(scene.entities[i].class_name).density_kg_m3
        solid = solid_link(link.name, tuple(meshes), density)
        solid = dataclasses.replace(solid, visuals=link.visuals)
        scene.reshape(i, RobotModel(body.name, (solid,), ()))
    return kept


def _volume(meshes: list[Mesh]) -> float:
    return solid_link("", tuple(meshes), 1.0).mass_kg


def _cut_by(
    mesh: Mesh,
    origin: Float[np.ndarray, "3"],
    other: PlacedSolid,
    max_vertices: int,
    carried: bool,
) -> Mesh:
    """What is left of a scan's hull in front of the parts that it reaches into.

    Args:
        mesh: The hull, about ``origin``.
        origin: World, metres.
        other: What it reaches into.
        max_vertices: Of what is left.
        carried: The scan stands on the other: contact at the carrying plane is left.
    """
    low, high = (getattr(mesh.vertices, side)(0) + origin for side in ("min", "max"))
    near = np.all((other.lows <= high) & (low <= other.highs), axis=1)
    part = shifted_part(part_of(mesh), origin) if near.any() else None
    for k in np.flatnonzero(near).tolist():
        assert part is not None
        depth_m, normal = penetration(part, other.part(k))
        if depth_m <= _TOUCH_M or (carried and is_contact(part, other.part(k))):
            continue
        edge_m = float((other.part(k).vertices @ normal).max() - origin @ normal)
        smaller = cut_hull(mesh, normal, edge_m, max_vertices)
        if smaller is not None and _volume([smaller]) >= _CUT_LIMIT * _volume([mesh]):
            mesh, part = smaller, shifted_part(part_of(smaller), origin)
    return mesh


def _push_out(scene: _RestingBodies, i: int, bound_m: float) -> None:
    """Move a body sideways out of what it overlaps, its carriers included; where that does not
    succeed, out of the others alone; undone where that does not either."""
    others, carriers = scene.others(i), scene.tree.carriers(i)
    for group in (others, [k for k in others if k not in carriers]):
        places = scene.standing.places()
        if _pushed_out(scene, i, group, bound_m):
            return
        scene.standing.put_back(places)


def _pushed_out(scene: _RestingBodies, i: int, others: list[int], bound_m: float) -> bool:
    """Whether pushes within the bound end all overlaps of a body."""
    for _ in range(_PUSHES):
        found = scene.deepest(i, others, but_contact=True)
        if found is None:
            return True
        k, overlap = found
        step = scene.standing.step_out(i, overlap, gap_m=_TOUCH_M, farthest_m=bound_m)
        if step is None:
            return False
        lift_m = -vertical_gap(overlap.part, overlap.other)
        if scene.tree.stands_on(i, k) and lift_m <= np.linalg.norm(step):
            return False  # off the edge of what carries it: it is to be lifted
        scene.standing.move(i, step)
    return False


def _set_down(scene: _RestingBodies, i: int, bound_m: float) -> str | None:
    """Lift or lower a body until it touches its parent; a message where it cannot."""
    parent = int(scene.graph.parent[i])
    if parent < 0:
        return "nothing carries it"
    gap_m, name = _gap_below(scene.solid(i), scene.solid(parent)), scene.name(parent)
    if not np.isfinite(gap_m):
        return f"no part of {name} lies below it"
    down = np.array([0.0, 0.0, -gap_m])
    if np.linalg.norm(scene.standing.shift_m[i] + down) > bound_m:
        mm = 1000 * abs(gap_m)
        return f"{mm:.1f} mm above {name}" if gap_m > 0 else f"{mm:.1f} mm in {name}"
    scene.standing.move(i, down)
    return None


def _gap_below(solid: PlacedSolid, carrier: PlacedSolid) -> float:
    """How far a solid can sink until it touches what carries it, metres (`vertical_gap`)."""
    low, high = solid.lows[:, None, :2], solid.highs[:, None, :2]
    above = np.all((low <= carrier.highs[:, :2]) & (carrier.lows[:, :2] <= high), axis=2)
    parts = [(solid.part(a), carrier.part(b)) for a, b in np.argwhere(above).tolist()]
    gaps_m = [(vertical_gap(part, below), part, below) for part, below in parts]
    # What was cut or pushed out of a backrest touches it still, and need not be lifted over it.
    return min(
        (
            gap_m
            for gap_m, part, below in gaps_m
            if gap_m >= -_WORTH_SAYING_M or penetration(part, below)[0] > _TOUCH_M
        ),
        default=np.inf,
    )


def _what_overlaps(scene: _RestingBodies, i: int) -> str | None:
    """The deepest overlap of a free body with anything."""
    if not scene.bodies[i].free:
        return None
    found = scene.deepest(i, [k for k in scene.standing.things if k != i], but_contact=False)
    if found is None or found[1].depth_m < _WORTH_SAYING_M:
        return None
    k, overlap = found
    return f"{1000 * overlap.depth_m:.1f} mm in {scene.name(k)}"
