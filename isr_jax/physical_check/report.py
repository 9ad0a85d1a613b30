"""Placements, with the reason against every candidate that lost."""

from __future__ import annotations

import numpy as np

from ..classes import class_named
from ..library import CadLibrary
from ..types import Alignments, AlignmentStatus, Candidate, Entity, Placement, Shortlist
from .arrangement import Arrangement
from .options import Option
from .search import Search, collision


class Report:
    """What became of every entity and every candidate."""

    def __init__(
        self,
        search: Search,
        arrangement: Arrangement,
        shortlist: Shortlist,
        alignments: Alignments,
        library: CadLibrary,
    ) -> None:
        self.search, self.arrangement = search, arrangement
        self.shortlist, self.alignments, self.library = shortlist, alignments, library

    def placement(self, i: int) -> Placement:
        """What stands for the entity at this position."""
        entity = self.search.problem.entities[i]
        rows = np.flatnonzero(self.shortlist.entity == i).tolist()
        option = self.arrangement.chosen.get(i)
        if option is None:
            kept = tuple(self._candidate(row, self._lost(i, row)) for row in rows)
            reason = self._why_scan(entity, kept, self.search.fallen.get(i))
            return Placement(entity.id, None, None, None, None, None, kept, reason)
        T = option.T_world_cad.copy()
        T[:3, 3] += self.arrangement.step_m(i)
        return Placement(
            entity_id=entity.id,
            cad_id=self.library[int(self.shortlist.model[option.row])].id,
            T_world_cad=T,
            scale=np.full(3, option.scale),
            matching_error=float(self.shortlist.error[option.row]),
            alignment_error_m=option.error_m,
            candidates=tuple(
                self._candidate(row, None if row == option.row else self._lost(i, row))
                for row in rows
            ),
            reason=None,
        )

    def _candidate(self, row: int, reason: str | None) -> Candidate:
        found = self.alignments
        return Candidate(
            cad_id=self.library[int(self.shortlist.model[row])].id,
            rotation=int(self.shortlist.rotation[row]),
            matching_error=float(self.shortlist.error[row]),
            alignment_error_m=float(found.alignment_error_m[row]),
            status=AlignmentStatus(int(found.status[row])).label,
            reason=reason,
        )

    def _lost(self, i: int, row: int) -> str:
        if row in self.search.reasons:
            return self.search.reasons[row]
        option, chosen = self.search.tried[row], self.arrangement.chosen.get(i)
        if chosen is not None and chosen.cost_m <= option.cost_m:
            costs = f"cost {option.cost_m:.3f} m, the chosen one {chosen.cost_m:.3f} m"
            return f"not needed: {costs}"
        name, depth_m = self._deepest_conflict(i, option)
        if depth_m > 0:
            return collision(name, depth_m)
        return self.search.fallen.get(i, "the chosen one leaves fewer conflicts elsewhere")

    def _deepest_conflict(self, i: int, option: Option) -> tuple[str, float]:
        """Of one option with everything as it finally stands."""
        search, best = self.search, ("", 0.0)
        for j in search.problem.positions:
            if j == i or j in search.fallen:
                continue
            depth_m = search.overlap_m(i, option, j, self.arrangement.chosen.get(j))
            if depth_m > best[1]:
                best = search.problem.entities[j].name, depth_m
        return best

    def _why_scan(
        self, entity: Entity, candidates: tuple[Candidate, ...], fallen: str | None
    ) -> str:
        name = entity.class_name
        if entity.is_layout:
            return "layout"
        if not class_named(name).functional:
            return f"class {name} has no CAD function"
        if len(self.library.matching_class(name)) == 0:
            return f"no model of class {name} in the library"
        if not candidates:
            return "matching found no candidate"
        nearest = min(candidates, key=lambda c: c.alignment_error_m)
        why = fallen or nearest.reason
        return f"no candidate of {len(candidates)} fits; {nearest.cad_id}: {why}"
