"""Border: viser and trimesh. Shows a results folder in the browser."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import jax
import numpy as np
import trimesh

from ..errors import OutputError, SceneError
from ..geometry import box_corners
from ..scene_file import EntityRecord, SceneFile, read_scene

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


def view(result_dir: str | Path, *, port: int = 8080, host: str = "127.0.0.1") -> None:
    """Serve a results folder to the browser until interrupted.

    Args:
        result_dir: Folder that `pipeline.run` wrote.
        port: Port of the page.
        host: Address to listen on; by default this machine alone.

    Raises:
        OutputError: viser (extra ``viewer``) is not installed.
        SceneError: the folder holds no readable scene.
    """
    server = build_view(result_dir, port=port, host=host)
    print(f"http://{host}:{server.get_port()}  (Ctrl-C stops)")
    server.sleep_forever()


def build_view(result_dir: str | Path, *, port: int = 8080, host: str = "127.0.0.1") -> Any:
    """Start a viser server that shows the folder, and return it."""
    result_dir = Path(result_dir)
    scene = read_scene(result_dir / "scene.json")
    viser = _viser()
    server = viser.ViserServer(host=host, port=port, label="isr_jax", verbose=False)
    server.scene.set_up_direction("+z")
    layers = {
        "panoptic map": _add_map(server, result_dir),
        "models": _add_models(server, result_dir),
        "boxes": _add_boxes(server, scene),
        "contact graph": _add_graph(server, scene),
        "names": _add_names(server, scene),
    }
    for name, handles in layers.items():
        _add_switch(server, name, handles, shown=name in ("models", "names"))
    server.gui.add_markdown(_summary(scene))
    return server


def _viser() -> Any:
    try:
        return importlib.import_module("viser")
    except ImportError:
        raise OutputError(
            "the viewer needs viser, which is not installed", "pip install 'isr_jax[viewer]'"
        ) from None


def _add_switch(server: Any, name: str, handles: list[Any], shown: bool) -> None:
    box = server.gui.add_checkbox(name, initial_value=shown)

    def update(_: object = None) -> None:
        for handle in handles:
            handle.visible = box.value

    box.on_update(update)
    update()


def _add_map(server: Any, result_dir: Path) -> list[Any]:
    path = result_dir / "map" / "panoptic.ply"
    if not path.exists():
        return []
    mesh = trimesh.load_mesh(path)
    return [server.scene.add_mesh_trimesh("/map", mesh)]


def _add_models(server: Any, result_dir: Path) -> list[Any]:
    path = result_dir / "scene.glb"
    if not path.exists():
        raise SceneError(f"{path} is missing", "write the scene again with `isr run`")
    # glTF is y up; a quarter turn about x brings it back to z up.
    turn = (np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0)
    return [server.scene.add_glb("/models", path.read_bytes(), wxyz=turn)]


def _add_boxes(server: Any, scene: SceneFile) -> list[Any]:
    handles = []
    for entity in scene.entities:
        corners = np.asarray(box_corners(jax.tree.map(np.asarray, entity.box)))
        color = _BOX_COLORS[entity.type]
        handles.append(
            server.scene.add_line_segments(
                f"/boxes/{entity.name}", corners[_EDGES].astype(np.float32), colors=color
            )
        )
    return handles


def _add_graph(server: Any, scene: SceneFile) -> list[Any]:
    centers = {e.name: np.asarray(e.box.center, np.float32) for e in scene.entities}
    supports = [(centers[e.parent], centers[e.name]) for e in scene.entities if e.parent in centers]
    proximal = [(centers[a], centers[b]) for a, b, _ in scene.proximal]
    handles = []
    for name, pairs, color in (
        ("supports", supports, _SUPPORT_COLOR),
        ("proximal", proximal, _PROXIMAL_COLOR),
    ):
        if pairs:
            lines = np.array(pairs, np.float32)
            handles.append(server.scene.add_line_segments(f"/graph/{name}", lines, colors=color))
    return handles


def _add_names(server: Any, scene: SceneFile) -> list[Any]:
    return [
        server.scene.add_label(
            f"/names/{e.name}", e.name, position=tuple(np.asarray(e.box.center, float))
        )
        for e in scene.entities
        if e.type != "layout"
    ]


def _summary(scene: SceneFile) -> str:
    rows = ["| entity | stands as | on |", "| --- | --- | --- |"]
    rows += [f"| {e.name} | {_stands_as(e)} | {e.parent or '-'} |" for e in scene.entities]
    return "\n".join(rows)


def _stands_as(entity: EntityRecord) -> str:
    return entity.cad.id if entity.cad else entity.type
