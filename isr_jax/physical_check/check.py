"""`check`: one model an entity, so that all stand together (Sec. V-D)."""

from __future__ import annotations

from ..config import DEFAULT_SUPPORT, PhysicalCheckSettings, SupportSettings
from ..library import CadLibrary
from ..types import Alignments, ContactGraph, Entities, Placement, Shortlist
from .arrangement import Scene
from .options import options_of
from .report import Report
from .search import Search
from .solids import scan_points


def check(
    entities: Entities,
    graph: ContactGraph,
    shortlist: Shortlist,
    alignments: Alignments,
    library: CadLibrary,
    settings: PhysicalCheckSettings,
    support: SupportSettings = DEFAULT_SUPPORT,
) -> tuple[Placement, ...]:
    """Choose what stands for each entity; one placement an entity, in their order.

    Candidates that do not carry the entity's children or go through layout are dropped. Of the
    rest min-conflicts takes one an entity, from the smallest cost (AE + w_D D + w_alpha
    |log alpha|; the paper's is AE alone), so that no two penetrate by more
    than the tolerance, kept scans included; what carries one another is exempt. Children then
    move onto their parents' models and overlaps are looked for again. Where a conflict remains
    and no small sideways move ends it, the entity with the larger cost keeps its scan, and says so.
    """
    options, reasons = options_of(
        entities, graph, shortlist, alignments, library, settings, support
    )
    scans = {i: scan_points(e.mesh.vertices) for i, e in enumerate(entities) if not e.is_layout}
    scene = Scene(entities, graph, scans, settings)
    search = Search(scene, options)
    report = Report(search, search.run(), shortlist, alignments, library, reasons)
    return tuple(report.placement(i) for i in range(len(entities)))
