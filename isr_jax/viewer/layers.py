"""Border: viser and trimesh. What the page shows of a results folder, one function per layer."""

from __future__ import annotations

import colorsys
from pathlib import Path
from typing import Any

import jax
import numpy as np
import trimesh
from trimesh.visual import ColorVisuals

from ..errors import SceneError
from ..geometry import box_corners
from ..scene_file import EntityRecord, SceneFile

_EDGES = np.array(
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]]
)
_BOX_COLORS = {
    "layout": (150, 150, 150),
    "rigid": (60, 130, 240),
    "articulated": (240, 120, 40),
    "scan": (200, 60, 60),
}
_SUPPORT_COLOR = (30, 170, 80)
_PROXIMAL_COLOR = (220, 180, 30)
_LINE_M = 0.008
_NAME_SCALE = 0.6
"""Of viser's labels: at full size those of neighbours cover each other."""
_NAME_ABOVE_M = 0.03


def add_models(server: Any, scene: SceneFile, result_dir: Path) -> list[Any]:
    """What stands in the room: models, kept scans, layout.

    Raises:
        SceneError: ``scene.glb`` is missing.
    """
    path = result_dir / "scene.glb"
    if not path.exists():
        raise SceneError(f"{path} is missing", "write the scene again with `isr run`")
    # glTF is y up; a quarter turn about x brings it back to z up.
    turn = (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0)
    # Shadows of scans, rough as they are, fall on themselves as specks.
    glb = path.read_bytes()
    return [
        server.scene.add_glb("/models", glb, wxyz=turn, cast_shadow=False, receive_shadow=False)
    ]


def add_map(server: Any, scene: SceneFile, result_dir: Path) -> list[Any]:
    """The panoptic map as it was seen."""
    mesh = _map_mesh(result_dir)
    return [] if mesh is None else [_shown(server, "/map", mesh)]


def add_instances(server: Any, scene: SceneFile, result_dir: Path) -> list[Any]:
    """The panoptic map, one colour per instance."""
    mesh = _map_mesh(result_dir)
    if mesh is None:
        return []
    instance = np.asarray(mesh.metadata["_ply_raw"]["vertex"]["data"]["instance"]).ravel()
    mesh.visual = ColorVisuals(mesh, vertex_colors=_instance_colors(instance))
    return [_shown(server, "/instances", mesh)]


def _map_mesh(result_dir: Path) -> trimesh.Trimesh | None:
    path = result_dir / "map" / "panoptic.ply"
    return trimesh.load_mesh(path, process=False) if path.exists() else None


def _shown(server: Any, name: str, mesh: trimesh.Trimesh) -> Any:
    glb = trimesh.Scene(mesh).export(file_type="glb", tree_postprocessor=_matt)
    return server.scene.add_glb(name, glb, cast_shadow=False, receive_shadow=False)


def _matt(tree: dict[str, Any]) -> None:
    """glTF takes what has no material for metal."""
    tree["materials"] = [{"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0}}]
    for mesh in tree["meshes"]:
        for primitive in mesh["primitives"]:
            primitive["material"] = 0


def _instance_colors(instance: np.ndarray) -> np.ndarray:
    """Hues a golden section apart, so that neighbouring numbers differ; grey for none."""
    numbers, rows = np.unique(instance, return_inverse=True)
    hues = [colorsys.hsv_to_rgb(0.618034 * n % 1, 0.55 + 0.3 * (n % 2), 0.9) for n in numbers]
    table = np.rint(255 * np.array(hues).reshape(-1, 3)).astype(np.uint8)
    table[numbers == 0] = 150
    return table[rows]


def add_boxes(server: Any, scene: SceneFile, result_dir: Path) -> list[Any]:
    """The entities' boxes, coloured by what stands for them."""
    handles = []
    for entity in scene.entities:
        corners = np.asarray(box_corners(jax.tree.map(np.asarray, entity.box)))
        lines, color = corners[_EDGES].astype(np.float32), _BOX_COLORS[entity.type]
        handles.append(_lines(server, f"/boxes/{entity.name}", lines, color))
    return handles


def add_graph(server: Any, scene: SceneFile, result_dir: Path) -> list[Any]:
    """The contact graph: from parent to child in green, between proximal pairs in yellow."""
    centers = {e.name: np.asarray(e.box.center, np.float32) for e in scene.entities}
    supports = [
        (_foot(centers[e.parent], centers[e.name], scene.entity(e.parent)), centers[e.name])
        for e in scene.entities
        if e.parent in centers
    ]
    proximal = [(centers[a], centers[b]) for a, b, _ in scene.proximal]
    edges = (
        ("supports", supports, _SUPPORT_COLOR),
        ("proximal", proximal, _PROXIMAL_COLOR),
    )
    return [
        _lines(server, f"/graph/{name}", np.array(pairs, np.float32), color)
        for name, pairs, color in edges
        if pairs
    ]


def _foot(parent: np.ndarray, child: np.ndarray, entity: EntityRecord) -> np.ndarray:
    """Where an edge starts: a thing's middle; of layout, the point below the child."""
    if entity.class_name != "floor":
        return parent
    return np.array([child[0], child[1], parent[2]], np.float32)


def _lines(server: Any, name: str, points: np.ndarray, color: tuple[int, int, int]) -> Any:
    return server.scene.add_line_segments(name, points, colors=color, thickness=_LINE_M)


def add_names(server: Any, scene: SceneFile, result_dir: Path) -> list[Any]:
    """The entities' names, above them."""
    handles = []
    for entity in scene.entities:
        if entity.type == "layout":
            continue
        x, y, z = (float(v) for v in np.asarray(entity.box.center))
        top = z + float(entity.box.size[2]) / 2 + _NAME_ABOVE_M
        handles.append(
            server.scene.add_label(
                f"/names/{entity.name}",
                entity.name,
                position=(x, y, top),
                font_screen_scale=_NAME_SCALE,
                anchor="bottom-center",
            )
        )
    return handles


LAYERS = {
    "models": add_models,
    "names": add_names,
    "boxes": add_boxes,
    "contact graph": add_graph,
    "map": add_map,
    "map, by instance": add_instances,
}
"""Name on the page -> what adds it; each returns the handles that show or hide it."""
