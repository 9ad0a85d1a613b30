"""What `evaluate` found: the scores of every measure as plain data, as JSON, and as tables."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

from rich.console import Group
from rich.table import Table

from ..errors import OutputError
from ..runtime.render_text import render_text
from .figures import Headline, percent
from .graphs.graph_scores import AttachmentScores, EdgeScores
from .graphs.support_planes import SupportPlaneScores
from .maps.boxes import BoxScores
from .maps.instances import InstanceScores
from .maps.panoptic import PanopticScores
from .maps.released_counting import ReleasedCounting
from .maps.surface_scores import SurfaceScores
from .matches import Match
from .models.cad_scores import CadScores
from .models.replacement import ReplacementScores
from .standing import StandingScores


@dataclasses.dataclass(frozen=True)
class EvaluationReport:
    """All scores of one result. Shares are 0 to 1, lengths metres, None what is undefined."""

    panoptic: PanopticScores
    instances: InstanceScores
    boxes: BoxScores
    """Of the boxes in scene.json, which supports have refined (mAP_re)."""
    observed_boxes: BoxScores | None
    """Before refinement (mAP); None where the result does not keep them."""
    supports: EdgeScores
    """Edges from things to what carries them."""
    proximal: EdgeScores
    """Pairs of things that are close; layout is in none."""
    attachments: AttachmentScores
    support_planes: SupportPlaneScores
    cad: CadScores
    replacement: ReplacementScores | None
    """What reads the models themselves; None where no library is given."""
    standing: StandingScores | None
    """ISR-Stab of the result; None where its folder has no ``stability.json``."""
    surface: SurfaceScores
    matches: tuple[Match, ...]
    unseen: tuple[str, ...]
    """True entities that the camera hardly saw; nothing is asked of them."""
    released_counting: ReleasedCounting | None = None
    """The same counted as the released code does, where asked for; for comparison only."""

    def to_json(self) -> dict[str, Any]:
        """Plain data."""
        return dataclasses.asdict(self)

    def write(self, path: str | Path) -> None:
        """Write `to_json` to a file.

        Raises:
            OutputError: the file cannot be written.
        """
        try:
            text = json.dumps(self.to_json(), indent=1, allow_nan=False)
            Path(path).write_text(text + "\n", "utf-8")
        except OSError as error:
            raise OutputError(f"{path}: {error.strerror}", "choose another folder") from None

    def headline(self) -> Headline:
        """(name, value) of what is quoted first."""
        found = sum(m.predicted is not None for m in self.matches)
        observed, released = self.observed_boxes, self.released_counting
        return (
            ("things found", f"{found} of {len(self.matches)}"),
            *self.panoptic.headline(),
            *self.instances.headline(),
            *(() if observed is None else observed.headline("mAP")),
            *self.boxes.headline("mAP_re"),
            *self.supports.headline("support"),
            *self.proximal.headline("proximal"),
            *self.attachments.headline(),
            *self.support_planes.headline(),
            *self.cad.headline(),
            *(() if self.replacement is None else self.replacement.headline()),
            *(() if self.standing is None else self.standing.headline()),
            *self.surface.headline(),
            *(() if released is None else released.headline()),
        )

    def table(self) -> Group:
        """All of it for a terminal; print it with a rich console."""
        top = Table("score", "value", title="against the truth (percent)")
        for name, value in self.headline():
            top.add_row(name, value)
        models = () if self.replacement is None else (self.replacement.table(),)
        return Group(top, self._class_table(), self.surface.table(), self.cad.table(), *models)

    def __str__(self) -> str:
        return render_text(self.table())

    def _class_table(self) -> Table:
        """One row per class, then both averages."""
        headings = ("class", "PQ", "SQ", "RQ", "TP/FP/FN", "mask AP", "box AP", "11-point box AP")
        table = Table(
            *headings,
            caption="AP at 0.5 / 0.25; its means run over the classes of seen true things",
        )
        masks = {r.class_name: (r.ap50, r.ap25) for r in self.instances.rows}
        boxes = {r.class_name: r for r in self.boxes.rows}
        p, i, b = self.panoptic, self.instances, self.boxes
        for c in p.classes:
            row = boxes.get(c.class_name)
            table.add_row(
                c.class_name,
                *map(percent, (c.pq, c.sq, c.rq)),
                f"{c.true_positives}/{c.false_positives}/{c.false_negatives}",
                percent(*masks[c.class_name]) if c.class_name in masks else "",
                percent(row.ap50, row.ap25) if row else "",
                percent(row.ap50_11point, row.ap25_11point) if row else "",
            )
        table.add_section()
        table.add_row(
            "mean, all classes",
            *map(percent, (p.pq, p.sq, p.rq)),
            "",
            percent(i.map50, i.map25),
            percent(b.map50, b.map25),
            percent(b.map50_11point, b.map25_11point),
        )
        quality = map(percent, (p.pq_matched, p.sq_matched, p.rq_matched))
        table.add_row("mean, matched classes only", *quality)
        return table
