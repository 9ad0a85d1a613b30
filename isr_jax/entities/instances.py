"""Which instances of a map are things: parts joined, fragments left out, hung things renamed."""

from __future__ import annotations

import dataclasses
import logging

import numpy as np
from scipy.spatial import KDTree

from ..classes import ClassInfo, class_named, classes
from ..config import EntitySettings
from ..geometry import points_in_box_frame
from ..types import Box, Mesh, PanopticSurface
from .planes import vertex_areas
from .rectangles import facing_direction, gravity_box
from .submesh import main_pieces, submesh

_LOG = logging.getLogger("isr_jax")
_MIN_SHARE = 0.4
"""`ClassInfo.min_diagonal_m` over the diagonal of a typical instance."""


@dataclasses.dataclass(frozen=True, eq=False)
class Instance:
    """An instance of the map that may become an entity."""

    id: int
    info: ClassInfo
    mesh: Mesh
    box: Box
    merged_ids: tuple[int, ...] = ()


def thing_instances(surface: PanopticSurface, settings: EntitySettings) -> list[Instance]:
    """The things of a map; what is left out is counted on the log ``isr_jax``."""
    found = []
    for id, class_id in zip(surface.instance_ids, surface.class_ids, strict=True):
        info = classes()[class_id]
        if info.kind == "thing":
            one = _instance((int(id),), info, surface, settings)
            found += [one] if one is not None else []
    found = _joined(found, surface, settings)
    kept = [one for one in found if not _is_fragment(one, settings)]
    if dropped := [one.info.name for one in found if one not in kept]:
        _LOG.info("%d fragments left out: %s", len(dropped), ", ".join(sorted(dropped)))
    return [_renamed(one, settings) for one in kept]


def _instance(
    ids: tuple[int, ...], info: ClassInfo, surface: PanopticSurface, settings: EntitySettings
) -> Instance | None:
    whole = submesh(surface.mesh, np.isin(surface.instance, ids))
    mesh = main_pieces(whole, settings.piece_link_m, settings.piece_min_ratio)
    if len(mesh.vertices) < settings.min_vertices:
        return None
    return Instance(ids[0], info, mesh, thing_box(mesh, surface.voxel_size_m, settings), ids[1:])


def thing_box(mesh: Mesh, voxel_m: float, settings: EntitySettings) -> Box:
    """Least gravity-aligned box around a mesh with normals, robust to strays; metres."""
    assert mesh.normals is not None
    return gravity_box(
        mesh.vertices,
        settings.box_trim,
        2 * voxel_m,
        voxel_m,
        facing=facing_direction(mesh.normals),
        weight=settings.box_normal_weight,
    )


def _joined(
    found: list[Instance], surface: PanopticSurface, settings: EntitySettings
) -> list[Instance]:
    """Instances that are parts of a larger one of their class join it.

    A camera sees the sides of a desk in frames in which it does not see its top, and labels then
    never meet.
    """
    whole: list[Instance] = []
    for one in sorted(found, key=lambda f: (-len(f.mesh.vertices), f.id)):
        for k, other in enumerate(whole):
            if one.info is other.info and _is_part(one, other, surface, settings):
                ids = (other.id, *other.merged_ids, one.id, *one.merged_ids)
                merged = _instance(ids, other.info, surface, settings)
                whole[k] = merged if merged is not None else other
                break
        else:
            whole.append(one)
    return sorted(whole, key=lambda f: f.id)


def _is_part(
    one: Instance, other: Instance, surface: PanopticSurface, settings: EntitySettings
) -> bool:
    """Whether an instance lies in the box of another, or is the other half of a small thing.

    Boxes reach a voxel farther, not more: books lie on books. Halves touch side by side, and
    together are no larger than one typical thing of their class.
    """
    ratio = settings.merge_inside_ratio
    voxel_m = surface.voxel_size_m
    place = np.asarray(points_in_box_frame(other.box, one.mesh.vertices))
    inside = np.all(np.abs(place) <= np.asarray(other.box.size) / 2 + voxel_m, axis=1)
    if np.mean(inside) >= ratio:
        return True
    both = np.concatenate([one.mesh.vertices, other.mesh.vertices])
    size = gravity_box(both, settings.box_trim, 2 * voxel_m, voxel_m).size
    if np.linalg.norm(size) > one.info.min_diagonal_m / _MIN_SHARE:
        return False
    gap = KDTree(other.mesh.vertices).query(one.mesh.vertices)[0].min()
    return bool(gap <= 2 * voxel_m and _level_share(one.box, other.box) >= ratio)


def _level_share(a: Box, b: Box) -> float:
    """Common part of two ranges of height, over the smaller range."""
    low, high = (
        np.array([box.center[2] + sign * box.size[2] / 2 for box in (a, b)]) for sign in (-1, 1)
    )
    return float((high.min() - low.max()) / (high - low).min())


def _is_fragment(one: Instance, settings: EntitySettings) -> bool:
    """Too small for its class, or a few flakes scattered in a large box."""
    size = np.asarray(one.box.size, np.float64)
    if settings.drop_fragments and np.linalg.norm(size) < one.info.min_diagonal_m:
        return True
    largest_side_m2 = np.prod(np.sort(size)[1:])
    return bool(vertex_areas(one.mesh).sum() < settings.min_coverage * largest_side_m2)


def _renamed(one: Instance, settings: EntitySettings) -> Instance:
    """Segmenters know no wall cabinets: a cabinet whose bottom is high up is one."""
    bottom = float(one.box.center[2] - one.box.size[2] / 2)
    if not one.info.hung_class or bottom < settings.hung_min_bottom_m:
        return one
    return dataclasses.replace(one, info=class_named(one.info.hung_class))
