"""What the printed tables show of all measures, in the order of the stages."""

from __future__ import annotations

import dataclasses

from .one_run import COST, FAILED, RUN


@dataclasses.dataclass(frozen=True)
class Figure:
    """One line of a printed table."""

    title: str
    stage: str
    metric: str
    factor: float = 100.0
    """From the table's unit to the printed one."""
    unit: str = "%"
    higher_is_better: bool = True

    def shown(self, value: float | None) -> str:
        """The value in the printed unit; a dash where it is undefined."""
        return "-" if value is None else f"{self.factor * value:.1f}"

    @property
    def heading(self) -> str:
        return f"{self.title}, {self.unit}" if self.unit else self.title


def _millimetres(title: str, stage: str, metric: str) -> Figure:
    return Figure(title, stage, metric, 1000.0, "mm", False)


HEADLINE = (
    Figure("PQ", "mapping", "panoptic.pq"),
    Figure("SQ", "mapping", "panoptic.sq"),
    Figure("RQ", "mapping", "panoptic.rq"),
    Figure("PQ things", "mapping", "panoptic.pq_things"),
    Figure("instance AP@0.5", "mapping", "instances.map50"),
    _millimetres("surface accuracy, median", "mapping", "surface.accuracy_median_m"),
    Figure("surface F at 5 cm", "mapping", "surface.rates.0.05.f_score"),
    Figure("box mAP@0.5", "entities", "observed_boxes.map50"),
    Figure("box mAP_re@0.5", "contact_graph", "boxes.map50"),
    Figure("support precision", "contact_graph", "supports.precision"),
    Figure("support recall", "contact_graph", "supports.recall"),
    Figure("proximal precision", "contact_graph", "proximal.precision"),
    Figure("proximal recall", "contact_graph", "proximal.recall"),
    Figure("retrieval top-1", "matching", "replacement.retrieval.top1"),
    Figure("retrieval top-10", "matching", "replacement.retrieval.top10"),
    Figure("Scan2CAD accuracy, official", "alignment", "replacement.scan2cad.official.instances"),
    Figure("Scan2CAD accuracy, strict", "alignment", "replacement.scan2cad.strict.instances"),
    _millimetres("Chamfer, two-way", "alignment", "replacement.chamfer.two_way_median_m"),
    Figure("functional equivalence", "scene", "replacement.equivalence.score"),
    _millimetres("penetration, max", "stability", "exported.penetration_max_m"),
    Figure("bodies within 1 cm", "stability", "exported.rates.within_1_cm"),
    Figure("the same, all freed", "stability", "freed.rates.within_1_cm"),
    Figure("PhyRecon", "stability", "exported.variants.phyrecon"),
    Figure("MolmoSpaces, bodies", "stability", "exported.variants.molmospaces_bodies"),
    Figure("seconds", COST, "seconds", 1.0, "s", False),
    Figure("processor seconds", COST, "cpu_seconds", 1.0, "s", False),
    Figure("peak memory", COST, "peak_memory_bytes", 1e-9, "GB", False),
    Figure("runs that failed", RUN, FAILED, 100.0, "%", False),
)
