"""`check`: one model per entity, so that all stand together (Sec. V-D)."""

from __future__ import annotations

from collections.abc import Sequence

from ..config import (
    DEFAULT_SUPPORT,
    CadSettings,
    PhysicalCheckSettings,
    SupportSettings,
)
from ..library import CadLibrary
from ..types import Alignments, ContactGraph, Entities, Placement, Shortlist
from .options import Candidates
from .problem import CheckProblem
from .report import Report
from .search import Search


def check(
    entities: Entities,
    graph: ContactGraph,
    shortlist: Shortlist,
    alignments: Alignments,
    library: CadLibrary,
    settings: PhysicalCheckSettings,
    support: SupportSettings = DEFAULT_SUPPORT,
    cad: CadSettings | None = None,
) -> tuple[Placement, ...]:
    """Choose what stands for each entity; one placement per entity, in their order.

    Candidates that do not carry the entity's children or go through layout are dropped. Of the
    rest min-conflicts takes one per entity, from the smallest cost (AE + w_D D + w_alpha
    |log alpha|; the paper's is AE alone), so that no two penetrate by more than the tolerance, kept
    scans included. Contact of a thing with what carries it does not count, but a child that reaches
    into its parent otherwise does. Children then move onto their parents' models and overlaps are
    looked for again. Where a conflict remains and no small sideways move ends it, the entity that
    the other carries, or moves more easily, or has the larger cost keeps its scan, and says so.

    Args:
        entities: Of one scene.
        graph: Who carries whom.
        shortlist: Candidates of each entity.
        alignments: Of each row of the shortlist.
        library: That the shortlist names; it makes the hulls of models that come without.
        settings: Tolerances and weights.
        support: Which planes carry, and how much of a child.
        cad: Which hulls candidates are judged by, and which the scene is written with; by default
            those of the preset ``default``. What is chosen was judged by the latter.

    Raises:
        LibraryError: A model without collision hulls, in a library that makes none.
        SettingError: An unknown kind of hulls.
    """
    problem = CheckProblem(entities, graph, settings)
    cad = cad or CadSettings()
    candidates = Candidates(problem, shortlist, alignments, library, support, cad)
    search = Search(problem, candidates)
    report = Report(search, search.run(), shortlist, alignments, library)
    return tuple(report.placement(i) for i in range(len(entities)))


def check_scenes(
    entities: Sequence[Entities],
    graphs: Sequence[ContactGraph],
    shortlists: Sequence[Shortlist],
    alignments: Sequence[Alignments],
    library: CadLibrary,
    settings: PhysicalCheckSettings,
    support: SupportSettings = DEFAULT_SUPPORT,
    cad: CadSettings | None = None,
) -> list[tuple[Placement, ...]]:
    """`check` of each of several scenes."""
    scenes = zip(entities, graphs, shortlists, alignments, strict=True)
    return [check(*scene, library, settings, support, cad) for scene in scenes]
