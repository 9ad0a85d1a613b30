"""Candidates as options: placed on their support, out of the walls, carrying their children."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float

from ..config import PhysicalCheckSettings, SupportSettings
from ..geometry import box_at, footprint_corners
from ..library import CadLibrary, CadModel
from ..types import Alignments, AlignmentStatus, ContactGraph, Entities, Shortlist
from .contact import contact_ratios
from .layout import LayoutPlane, cleared_of_layout, layout_planes
from .solids import Solid, model_parts, solid_of


@dataclasses.dataclass(frozen=True, eq=False)
class Option:
    """A candidate that may stand for its entity, at rest on its support as observed."""

    row: int
    """In the shortlist."""
    T_world_cad: Float[np.ndarray, "4 4"]
    scale: float
    error_m: float
    """AE."""
    cost_m: float
    """What the choice is by: AE + w_D D + w_alpha |log alpha|."""
    solid: Solid
    carrying_m: dict[int, list[float]]
    """Heights of the planes that carry each child, by its position."""


@dataclasses.dataclass(frozen=True)
class Child:
    """What stands on an entity."""

    position: int
    name: str
    footprint: np.ndarray
    bottom_m: float


def observed_support(entities: Entities, graph: ContactGraph, position: int) -> float | None:
    """Height of the plane that carries an entity, where it stands; None where nothing does.

    Layout counts as level: so it is exported. Of a plane that was not seen it is the entity's
    bottom.
    """
    parent, plane = int(graph.parent[position]), int(graph.support_plane[position])
    if parent < 0:
        return None
    if plane < 0:
        box = box_at(graph.refined_box, position)
        return float(box.center[2] - box.size[2] / 2)
    planes = entities[parent].planes
    if entities[parent].is_layout:
        return float(np.asarray(planes.corners)[plane, :, 2].mean())
    xy = np.asarray(graph.refined_box.center, np.float64)[position, :2]
    normal = np.asarray(planes.normal, np.float64)[plane]
    return float(-(float(planes.offset[plane]) + normal[:2] @ xy) / normal[2])


def children_of(entities: Entities, graph: ContactGraph, position: int) -> list[Child]:
    """The entities that stand on one."""
    found = []
    for c in graph.children(position).tolist():
        box = box_at(graph.refined_box, c)
        bottom = float(box.center[2] - box.size[2] / 2)
        found.append(Child(c, entities[c].name, np.asarray(footprint_corners(box)), bottom))
    return found


class _Judge:
    """Turns shortlist rows into options, or into reasons against them."""

    def __init__(self, entities, graph, shortlist, alignments, library, settings, support) -> None:
        self.entities: Entities = entities
        self.graph: ContactGraph = graph
        self.shortlist: Shortlist = shortlist
        self.alignments: Alignments = alignments
        self.library: CadLibrary = library
        self.settings: PhysicalCheckSettings = settings
        self.support: SupportSettings = support
        self.layout: list[LayoutPlane] = layout_planes(entities)

    def place(self, row: int) -> tuple[Option | None, str | None]:
        """The option of a row before its children are looked at, or why there is none."""
        found, settings = self.alignments, self.settings
        status, error = AlignmentStatus(int(found.status[row])), float(found.alignment_error_m[row])
        if not status.usable:
            return None, f"alignment: {status.label}"
        if not error <= settings.max_alignment_error_m:
            return None, f"AE {error:.3f} m over {settings.max_alignment_error_m:.3f} m"
        position, scale = int(self.shortlist.entity[row]), float(found.scale[row])
        T = np.asarray(found.T_world_cad[row], np.float64).copy()
        T[:3, :3] = _nearest_rotation(T[:3, :3])
        solid = solid_of(model_parts(self.library[int(self.shortlist.model[row])]), T, scale)
        step = np.zeros(3)
        support = observed_support(self.entities, self.graph, position)
        if support is not None:
            step[2] = support + settings.clearance_m - solid.low[2]
        push, reason = cleared_of_layout(
            solid.moved(step), self.layout, supported=support is not None, settings=settings
        )
        if reason:
            return None, reason
        step = step + push
        T[:3, 3] += step
        return Option(row, T, scale, error, self._cost(row), solid.moved(step), {}), None

    def _cost(self, row: int) -> float:
        """AE sees one side only and ties where a model is turned or exchanged for a scaled one."""
        found, settings = self.alignments, self.settings
        matching = settings.matching_weight_m * float(self.shortlist.error[row])
        scaling = settings.scale_weight_m * abs(float(np.log(found.scale[row])))
        return float(found.alignment_error_m[row]) + matching + scaling

    def up_planes(self, option: Option) -> np.ndarray:
        """Corners [planes, 4, 3] of the option's up-facing planes, world frame."""
        model: CadModel = self.library[int(self.shortlist.model[option.row])]
        R, t = option.T_world_cad[:3, :3], option.T_world_cad[:3, 3]
        up = np.asarray(model.planes.normal) @ R[2] >= self.support.up_cosine
        up &= np.asarray(model.planes.valid)
        return option.scale * np.asarray(model.planes.corners, np.float64)[up] @ R.T + t


def _nearest_rotation(matrix: np.ndarray) -> np.ndarray:
    """float32 leaves a rotation a little off."""
    u, _, vt = np.linalg.svd(matrix)
    return u @ vt


def options_of(
    entities: Entities,
    graph: ContactGraph,
    shortlist: Shortlist,
    alignments: Alignments,
    library: CadLibrary,
    settings: PhysicalCheckSettings,
    support: SupportSettings,
) -> tuple[dict[int, list[Option]], dict[int, str]]:
    """Options of each entity that has any, and the reason against each row that is none."""
    judge = _Judge(entities, graph, shortlist, alignments, library, settings, support)
    placed, reasons = [], {}
    for row in range(len(shortlist.entity)):
        option, reason = judge.place(row)
        if option is not None:
            placed.append(option)
        else:
            reasons[row] = reason or ""
    options: dict[int, list[Option]] = {}
    for option, reason in _carrying(judge, placed):
        if reason:
            reasons[option.row] = reason
        else:
            options.setdefault(int(shortlist.entity[option.row]), []).append(option)
    return options, reasons


def _carrying(judge: _Judge, placed: list[Option]) -> list[tuple[Option, str | None]]:
    """Options with the planes that carry their children, or the child that they drop."""
    owner = [int(judge.shortlist.entity[o.row]) for o in placed]
    children = {i: children_of(judge.entities, judge.graph, i) for i in set(owner)}
    keys, planes, footprints = [], [], []
    for o, option in enumerate(placed):
        for child in children[owner[o]]:
            for corners in judge.up_planes(option):
                keys.append((o, child.position, float(corners[:, 2].mean())))
                planes.append(corners[:, :2])
                footprints.append(child.footprint)
    ratios = contact_ratios(np.reshape(planes, (-1, 4, 2)), np.reshape(footprints, (-1, 4, 2)))
    contacts: list[dict[int, list[tuple[float, float]]]] = [
        {child.position: [] for child in children[i]} for i in owner
    ]
    for (o, c, height), ratio in zip(keys, ratios.tolist(), strict=True):
        contacts[o][c].append((height, ratio))
    return [
        _judged(option, children[i], found, judge.settings, judge.support.min_contact)
        for option, i, found in zip(placed, owner, contacts, strict=True)
    ]


def _judged(
    option: Option,
    children: list[Child],
    contacts: dict[int, list[tuple[float, float]]],
    settings: PhysicalCheckSettings,
    min_contact: float,
) -> tuple[Option, str | None]:
    """``contacts``: (height, A) of every up-facing plane with each child."""
    carrying = {}
    for child in children:
        near = [
            (height, ratio)
            for height, ratio in contacts[child.position]
            if abs(height - child.bottom_m) <= settings.child_height_tolerance_m
        ]
        if not near:
            limit = settings.child_height_tolerance_m
            return option, f"has no plane within {limit:.2f} m of {child.name}'s bottom"
        best = max(ratio for _, ratio in near)
        if best < min_contact:
            return option, f"carries {child.name} with A = {best:.2f} (< {min_contact:g})"
        carrying[child.position] = [h for h, ratio in near if ratio >= min_contact]
    return dataclasses.replace(option, carrying_m=carrying), None
