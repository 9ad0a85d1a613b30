"""What a run found, as tables for a terminal."""

from __future__ import annotations

from pathlib import Path

from rich.console import RenderableType
from rich.table import Table

from ..evaluation import EvaluationReport
from ..pipeline import RunResult
from ..scene_file import EntityRecord, SceneFile


def run_tables(result: RunResult) -> tuple[RenderableType, ...]:
    """Every entity and what stands for it, the drift of each free body, and the headline."""
    return (
        entity_table(result.scene_file),
        result.stability.table(),
        headline_table(result),
    )


def entity_table(scene: SceneFile) -> Table:
    """One row per entity: what it stands as, on what, how well the model fits."""
    table = Table(title="entities", title_justify="left")
    for heading in ("entity", "stands as", "on", "fit", "why no model"):
        table.add_column(heading)
    for entity in scene.entities:
        error = entity.cad.alignment_error_m if entity.cad else None
        table.add_row(
            entity.name,
            entity.cad.id if entity.cad else entity.type,
            _support(entity),
            "" if error is None else f"{1000 * error:.0f} mm",
            entity.reason or "",
        )
    return table


def _support(entity: EntityRecord) -> str:
    if entity.parent is not None:
        return entity.parent
    return f"({entity.attachment})" if entity.attachment != "none" else "nothing"


def headline_table(result: RunResult, report: EvaluationReport | None = None) -> Table:
    """Entities, supports, models, bodies, stability, scores, and where the outputs are."""
    table = Table(title="result", title_justify="left")
    table.add_column("figure")
    table.add_column("value", overflow="fold")
    for name, value in _headline(result):
        table.add_row(name, value)
    if report is not None:
        table.add_section()
        for name, value in report.headline():
            table.add_row(name, value)
    table.add_section()
    for name, value in _outputs(result.out_dir):
        table.add_row(name, value)
    return table


def _headline(result: RunResult) -> list[tuple[str, str]]:
    scene, stability = result.scene_file, result.stability
    layout = sum(e.type == "layout" for e in scene.entities)
    placed = [e for e in scene.entities if e.cad is not None]
    articulated = sum(e.type == "articulated" for e in placed)
    carried = sum(e.parent not in (None, "room") for e in scene.entities)
    mapped = result.scene.mapping
    frames = [] if mapped is None else [("frames", _frames(mapped.frames_used, mapped.skipped))]
    exported = stability.exported
    drift = max((b.drift_end_m for b in exported.bodies), default=0.0)
    return [
        *frames,
        ("entities found", f"{len(scene.entities)} ({layout} of layout)"),
        ("supports", f"{carried}, {support_levels(scene)} levels"),
        ("CAD models placed", f"{len(placed)} ({articulated} articulated)"),
        ("scans kept", str(sum(e.type == "scan" for e in scene.entities))),
        ("free / fixed bodies", f"{len(exported.bodies)} / {len(stability.fixed)}"),
        ("penetration at t = 0, max", f"{1000 * exported.penetration_max_m:.2f} mm"),
        (f"drift after {exported.end_s:g} s, max", f"{1000 * drift:.2f} mm"),
        ("left the room", str(exported.left_room)),
        ("time", f"{result.seconds:.0f} s"),
    ]


def _frames(used: int, skipped: tuple[str, ...]) -> str:
    return f"{used} integrated, {len(skipped)} skipped" + (" (see run.log)" if skipped else "")


def support_levels(scene: SceneFile) -> int:
    """Depth of the support tree below the layout: a cup on a book on a table is 3."""
    parents = {e.name: e.parent for e in scene.entities if e.type != "layout"}
    deepest = 0
    for name in parents:
        level, above = 0, name
        while above in parents and parents[above] is not None:
            level, above = level + 1, parents[above]
        deepest = max(deepest, level)
    return deepest


def _outputs(out_dir: Path) -> list[tuple[str, str]]:
    return [
        ("scene", str(out_dir / "scene.json")),
        ("MJCF", str(out_dir / "scene.xml")),
        ("URDF", str(out_dir / "scene_description" / "urdf" / "scene.urdf")),
        ("look at it", f"isr view {out_dir}"),
    ]
