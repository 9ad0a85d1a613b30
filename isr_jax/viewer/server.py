"""Border: viser. Serves a results folder to the browser."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import jax
import numpy as np

from ..errors import OutputError
from ..geometry import box_corners
from ..scene_file import EntityRecord, SceneFile, read_scene
from .layers import LAYERS

_SHOWN = ("models", "names")
"""Layers that are on when the page opens."""
_MAP_LAYERS = ("map", "map, by instance")


def view(result_dir: str | Path, *, port: int = 8080, host: str = "127.0.0.1") -> None:
    """Serve a results folder to the browser until interrupted.

    Args:
        result_dir: Folder that `pipeline.run` wrote.
        port: Port of the page; the next free one where it is taken.
        host: Address to listen on; by default this machine alone.

    Raises:
        OutputError: viser (extra ``viewer``) is not installed.
        SceneError: the folder holds no readable scene.
    """
    server = build_view(result_dir, port=port, host=host)
    print(f"http://{host}:{server.get_port()}  (Ctrl-C stops)")
    server.sleep_forever()


def build_view(result_dir: str | Path, *, port: int = 8080, host: str = "127.0.0.1") -> Any:
    """Start a viser server that shows the folder, and return it; ``stop()`` ends it.

    Raises:
        OutputError: viser is not installed.
    """
    result_dir = Path(result_dir)
    scene = read_scene(result_dir / "scene.json")
    viser = _viser()
    server = viser.ViserServer(host=host, port=port, label="isr_jax", verbose=False)
    try:
        server.scene.set_up_direction("+z")
        _light(server)
        _look_into(server, scene)
        has_map = (result_dir / "map" / "panoptic.ply").exists()
        for name in LAYERS:
            if has_map or name not in _MAP_LAYERS:
                _add_switch(server, name, scene, result_dir)
        server.gui.add_markdown(_summary(scene))
    except BaseException:
        server.stop()
        raise
    return server


def _viser() -> Any:
    try:
        return importlib.import_module("viser")
    except ImportError:
        raise OutputError(
            "the viewer needs viser, which is not installed", "pip install 'isr_jax[viewer]'"
        ) from None


def _light(server: Any) -> None:
    """Weaker than viser's own lights, in which the light walls of a room are all white."""
    server.scene.configure_default_lights(enabled=False)
    server.scene.configure_environment_map(hdri=None)
    server.scene.set_background_image(np.full((8, 8, 3), (226, 231, 236), np.uint8))
    server.scene.add_light_ambient("/light/everywhere", intensity=1.8)
    server.scene.add_light_directional("/light/above", intensity=1.4, position=(1.5, -1.0, 4.0))


def _look_into(server: Any, scene: SceneFile) -> None:
    """Start above the corner with the least tall furniture in it, the whole room in view."""
    if not scene.entities:
        return
    corners = [np.asarray(box_corners(jax.tree.map(np.asarray, e.box))) for e in scene.entities]
    low, high = np.concatenate(corners).min(0), np.concatenate(corners).max(0)
    middle, radius = (low + high) / 2, float(np.linalg.norm((high - low)[:2])) / 2
    things = [c for c, e in zip(corners, scene.entities, strict=True) if e.type != "layout"]
    sides = [np.array([x, y]) for x in (-0.7, 0.7) for y in (-0.7, 0.7)]

    def hidden(side: np.ndarray) -> float:
        return sum(max(0.0, (c.mean(0) - middle)[:2] @ side) * c[:, 2].max() for c in things)

    side = min(sides, key=hidden)
    target = np.array([middle[0], middle[1], 0.6])
    server.initial_camera.look_at = target
    server.initial_camera.position = target + radius * np.array([*side, 0.8])


def _add_switch(server: Any, name: str, scene: SceneFile, result_dir: Path) -> None:
    """A checkbox; its layer is sent to the browser when it is first switched on."""
    box = server.gui.add_checkbox(name, initial_value=name in _SHOWN)
    handles: list[Any] | None = None

    def update(_: object = None) -> None:
        nonlocal handles
        if handles is None and box.value:
            handles = LAYERS[name](server, scene, result_dir)
        for handle in handles or ():
            handle.visible = box.value

    box.on_update(update)
    update()


def _summary(scene: SceneFile) -> str:
    rows = ["| entity | stands as | on |", "| --- | --- | --- |"]
    rows += [
        f"| {e.name} | {_stands_as(e)} | {e.parent or 'nothing'} |"
        for e in scene.entities
        if e.type != "layout"
    ]
    return "\n".join(rows)


def _stands_as(entity: EntityRecord) -> str:
    return entity.cad.id if entity.cad else entity.type
