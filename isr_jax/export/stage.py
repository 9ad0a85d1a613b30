"""Write a scene in every format, then load each again and compare."""

from __future__ import annotations

import dataclasses
import os
from pathlib import Path
from typing import Any

from ..borders.ply import write_ply
from ..config import ExportSettings
from ..errors import OutputError
from ..library import CadLibrary
from ..scene_file import SceneFile, scene_from_stages, write_scene
from ..types import ContactGraph, Entities, PanopticSurface, Placement
from .bodies import Body, scene_bodies
from .glb_scene import write_glb
from .labels import final_labels
from .mjcf_scene import write_mjcf
from .resting import Adjustments, rest_on_supports
from .urdf_scene import write_urdf_package
from .verify import verify_exports


def export_scene(
    entities: Entities,
    graph: ContactGraph,
    placements: tuple[Placement, ...],
    library: CadLibrary,
    out_dir: Path,
    settings: ExportSettings | None = None,
    *,
    metrics: dict[str, Any] | None = None,
    all_settings: dict[str, Any] | None = None,
    versions: dict[str, str] | None = None,
    surface: PanopticSurface | None = None,
) -> SceneFile:
    """Write scene.json, scene.xml, the ROS package, scene.glb and the scans in map/.

    Free bodies are first set down on what carries them (`resting`); scene.json holds the poses
    after that, and ``metrics["export"]`` says who was moved, cut, or still overlaps.

    Args:
        entities: Of one scene.
        graph: Who carries whom.
        placements: One per entity, in order.
        library: Holds the placed models.
        out_dir: Created.
        settings: By default those of the preset ``default``.
        metrics: Kept in scene.json.
        all_settings: Kept in scene.json.
        versions: Kept in scene.json.
        surface: The panoptic map, for ``map/panoptic.ply``.

    Raises:
        OutputError: the folder cannot be written (found before any work), or an export that was
            loaded again differs from the scene.
    """
    settings = settings or ExportSettings()
    _refuse_unwritable(out_dir)
    slabs, bodies = scene_bodies(entities, graph, placements, library, settings)
    bodies, adjustments = rest_on_supports(entities, graph, slabs, bodies, settings)
    write_mjcf(out_dir, slabs, bodies, settings)
    urdf = write_urdf_package(out_dir, slabs, bodies)
    write_glb(out_dir / "scene.glb", slabs, bodies)
    paths = _write_map(entities, surface, out_dir)
    scene = scene_from_stages(
        entities,
        graph,
        _moved(placements, bodies),
        library,
        paths,
        metrics=(metrics or {}) | {"export": _report(bodies, adjustments)},
        settings=all_settings or {},
        versions=versions or {},
    )
    write_scene(scene, out_dir / "scene.json")
    verify_exports(slabs, bodies, out_dir, urdf)
    return scene


def _refuse_unwritable(out_dir: Path) -> None:
    try:
        out_dir.mkdir(parents=True, exist_ok=True)
        probe = out_dir / f".probe_{os.getpid()}"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise OutputError(
            f"cannot write to {out_dir}: {error.strerror}", "give another output folder"
        ) from None


def _write_map(
    entities: Entities, surface: PanopticSurface | None, out_dir: Path
) -> dict[int, str]:
    paths = {e.id: f"map/{e.name}.ply" for e in entities if len(e.mesh.faces)}
    for entity in entities:
        if entity.id in paths:
            write_ply(out_dir / paths[entity.id], entity.mesh)
    if surface is not None:
        instance, class_id = final_labels(entities, surface)
        extra = {"instance": instance, "class": class_id}
        write_ply(out_dir / "map" / "panoptic.ply", surface.mesh, extra)
    return paths


def _moved(placements: tuple[Placement, ...], bodies: tuple[Body, ...]) -> tuple[Placement, ...]:
    """Placements at the poses that were exported."""
    poses = {b.position: b.T_world_root for b in bodies if b.scan is None}
    return tuple(
        dataclasses.replace(p, T_world_cad=poses[i]) if i in poses else p
        for i, p in enumerate(placements)
    )


def _report(bodies: tuple[Body, ...], adjustments: Adjustments) -> dict[str, Any]:
    return {
        "free": [b.name for b in bodies if b.free],
        "fixed": [b.name for b in bodies if not b.free],
        "shift_m": {k: list(v) for k, v in adjustments.shift_m.items()},
        "cut_share": adjustments.cut_share,
        "unresolved": adjustments.unresolved,
    }
