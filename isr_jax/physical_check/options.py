"""Candidates as options: placed on their support, out of the walls, carrying their children."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from ..config import CadSettings, PhysicalCheckSettings, SupportSettings
from ..geometry import box_at, footprint_corners, nearest_rotation
from ..geometry.placed_solids import PlacedSolid
from ..library import CadLibrary
from ..types import Alignments, AlignmentStatus, Shortlist
from .contact import contact_ratios
from .layout import cleared_of_layout, layout_planes
from .problem import CheckProblem
from .things import model_parts, solid_of


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
    solid: PlacedSolid
    as_written: bool
    """Whether its hulls are those that the scene is written with."""
    carrying_m: dict[int, list[float]]
    """Heights of the planes that carry each child, by its position."""


@dataclasses.dataclass(frozen=True)
class _Child:
    """What stands on an entity."""

    position: int
    name: str
    footprint: Float[np.ndarray, "4 2"]
    bottom_m: float


class Candidates:
    """Turns shortlist rows into options, or into reasons against them.

    Models come with hulls that are quick to make and may reach too far; those that were chosen once
    get the hulls that they are written with (`write`), and are options anew.
    """

    def __init__(
        self,
        problem: CheckProblem,
        shortlist: Shortlist,
        alignments: Alignments,
        library: CadLibrary,
        support: SupportSettings,
        cad: CadSettings,
    ) -> None:
        self.problem, self.shortlist, self.alignments = problem, shortlist, alignments
        self.library = library.with_hulls(shortlist.model.tolist(), cad.candidate_hulls)
        self.support, self.cad = support, cad
        self.layout = layout_planes(problem.entities)

    @property
    def settings(self) -> PhysicalCheckSettings:
        return self.problem.settings

    def owner(self, row: int) -> int:
        """Position of the entity that a row is a candidate for."""
        return int(self.shortlist.entity[row])

    def model(self, row: int) -> int:
        """Position in the library of a row's model."""
        return int(self.shortlist.model[row])

    def write(self, options: Sequence[Option]) -> list[int]:
        """Give the options' models the hulls that are written; all rows of these models."""
        models = {self.model(option.row) for option in options}
        self.library = self.library.with_hulls(sorted(models), self.cad.chosen_hulls)
        return np.flatnonzero(np.isin(self.shortlist.model, list(models))).tolist()

    def options(self, rows: Sequence[int]) -> tuple[list[Option], dict[int, str]]:
        """Options of the rows that are any, and the reason against each row that is none."""
        placed: list[Option] = []
        reasons: dict[int, str] = {}
        for row in rows:
            option, reason = self._placed(row)
            if option is None:
                reasons[row] = reason or ""
            else:
                placed.append(option)
        options = []
        for option, reason in self._carrying(placed):
            if reason:
                reasons[option.row] = reason
            else:
                options.append(option)
        return options, reasons

    def _placed(self, row: int) -> tuple[Option | None, str | None]:
        """The option of a row before its children are looked at, or why there is none."""
        found, settings = self.alignments, self.settings
        status, error = AlignmentStatus(int(found.status[row])), float(found.alignment_error_m[row])
        if not status.usable:
            return None, f"alignment: {status.label}"
        if not error <= settings.max_alignment_error_m:
            return None, f"AE {error:.3f} m over {settings.max_alignment_error_m:.3f} m"
        T, scale = _rigid(found.T_world_cad[row]), float(found.scale[row])
        solid, as_written = self._solid(row, T, scale)
        step, supported = np.zeros(3), self.problem.carried(self.owner(row))
        if supported:
            support_m = self.problem.support_m(self.owner(row))
            step[2] = support_m + settings.clearance_m - solid.bottom_m
        push, reason = cleared_of_layout(
            solid.moved(step), self.layout, supported=supported, settings=settings
        )
        if reason:
            return None, reason
        step = step + push
        T[:3, 3] += step
        cost_m = self._cost_m(row)
        return Option(row, T, scale, error, cost_m, solid.moved(step), as_written, {}), None

    def _solid(self, row: int, T: np.ndarray, scale: float) -> tuple[PlacedSolid, bool]:
        model = self.library[self.model(row)]
        as_written = not model.lacks_hulls(self.cad.chosen_hulls)
        swelling_m = 0.0 if as_written else model.swelling_m
        return solid_of(model_parts(model), T, scale, swelling_m), as_written

    def _cost_m(self, row: int) -> float:
        """AE sees one side only and ties where a model is turned or exchanged for a scaled one."""
        found, settings = self.alignments, self.settings
        matching = settings.matching_weight_m * float(self.shortlist.error[row])
        scaling = settings.scale_weight_m * abs(float(np.log(found.scale[row])))
        return float(found.alignment_error_m[row]) + matching + scaling

    def _up_planes(self, option: Option) -> Float[np.ndarray, "planes 4 3"]:
        """Corners of the option's up-facing planes, world frame."""
        model = self.library[self.model(option.row)]
        R, t = option.T_world_cad[:3, :3], option.T_world_cad[:3, 3]
        up = np.asarray(model.planes.normal) @ R[2] >= self.support.up_cosine
        up &= np.asarray(model.planes.valid)
        return option.scale * np.asarray(model.planes.corners, np.float64)[up] @ R.T + t

    def _children(self, position: int) -> list[_Child]:
        """The entities that stand on one."""
        entities, graph, found = self.problem.entities, self.problem.graph, []
        for c in graph.children(position).tolist():
            box = box_at(graph.refined_box, c)
            bottom_m = float(box.center[2] - box.size[2] / 2)
            footprint = np.asarray(footprint_corners(box))
            found.append(_Child(c, entities[c].name, footprint, bottom_m))
        return found

    def _carrying(self, placed: list[Option]) -> list[tuple[Option, str | None]]:
        """Options with the planes that carry their children, or the child that they drop."""
        owner = [self.owner(option.row) for option in placed]
        children = {i: self._children(i) for i in set(owner)}
        keys, planes, footprints = [], [], []
        for o, option in enumerate(placed):
            for child in children[owner[o]]:
                for corners in self._up_planes(option):
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
            _judged(option, children[i], found, self.settings, self.support.min_contact)
            for option, i, found in zip(placed, owner, contacts, strict=True)
        ]


def _rigid(T: np.ndarray) -> Float[np.ndarray, "4 4"]:
    """float32 leaves a rotation a little off."""
    T = np.array(T, np.float64)
    T[:3, :3] = nearest_rotation(T[:3, :3])
    return T


def _judged(
    option: Option,
    children: list[_Child],
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
