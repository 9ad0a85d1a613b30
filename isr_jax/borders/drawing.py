"""Border: pictures of scenes and maps by ray casting, without a window or OpenGL (mujoco, cv2)."""

# MuJoCo's compiled names have no stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from pathlib import Path

import cv2
import mujoco
import numpy as np
from jaxtyping import Float, UInt8

from ..errors import OutputError
from ..types import Camera, Mesh
from .raycast import RayScene, camera_rays
from .simulation import load_model

_SUPERSAMPLING = 2
_SKY = np.array([236, 240, 244], np.float32)
_LIGHT = np.array([0.35, -0.25, 0.9]) / np.linalg.norm([0.35, -0.25, 0.9])
_FIELD_OF_VIEW_RAD = 0.75
_LAYERS = 12
"""Surfaces seen from behind that a ray may pass, so that a room can be seen into."""
_VISUAL_GROUPS = (0, 1, 2)
"""MuJoCo shows these; collision hulls are in group 3."""


def draw_scene(
    scene_xml: Path, path_png: Path, *, after_s: float = 0.0, width: int = 960, height: int = 720
) -> None:
    """Draw an MJCF scene to a PNG, if wished after it has moved for a while.

    Walls between the viewer and the room are left out.

    Raises:
        SceneError: the scene cannot be loaded.
        OutputError: the picture cannot be written.
    """
    model = load_model(scene_xml)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mujoco.mj_step(model, data, round(after_s / model.opt.timestep))
    meshes = [
        _geom_mesh(model, data, g)
        for g in range(model.ngeom)
        if model.geom_group[g] in _VISUAL_GROUPS and model.geom_rgba[g, 3] > 0
    ]
    _draw([m for m in meshes if m is not None], path_png, width, height)


def draw_mesh(mesh: Mesh, path_png: Path, *, width: int = 960, height: int = 720) -> None:
    """Draw a coloured mesh, a panoptic map for one, to a PNG.

    Raises:
        OutputError: the picture cannot be written.
    """
    _draw([mesh], path_png, width, height)


def instance_colors(instance: np.ndarray) -> UInt8[np.ndarray, "vertices 3"]:
    """A colour per vertex that tells instances apart; grey for none."""
    hue = (np.asarray(instance, np.int64) * 47) % 180
    saturation = np.where(instance % 2 == 0, 170, 110)
    hsv = np.stack([hue, saturation, np.full_like(hue, 225)], -1).astype(np.uint8)
    colors = cv2.cvtColor(hsv[None], cv2.COLOR_HSV2RGB)[0]
    colors[np.asarray(instance) == 0] = 150
    return np.asarray(colors, np.uint8)


def _geom_mesh(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> Mesh | None:
    kind = model.geom_type[geom]
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        vertices, faces = _box(model.geom_size[geom])
    elif kind == mujoco.mjtGeom.mjGEOM_MESH:
        vertices, faces = _stored_mesh(model, int(model.geom_dataid[geom]))
    else:  # planes have no end; nothing else is exported
        return None
    vertices = vertices @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
    rgb = (255 * model.geom_rgba[geom, :3]).astype(np.uint8)
    colors = np.tile(rgb, (len(vertices), 1))
    return Mesh(vertices.astype(np.float32), faces.astype(np.int32), colors)


def _stored_mesh(model: mujoco.MjModel, mesh: int) -> tuple[np.ndarray, np.ndarray]:
    v, n = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
    f, m = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
    return model.mesh_vert[v : v + n], model.mesh_face[f : f + m]


def _box(half: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    return corners, np.array(faces)


def _draw(meshes: list[Mesh], path_png: Path, width: int, height: int) -> None:
    width, height = width * _SUPERSAMPLING, height * _SUPERSAMPLING
    everything = np.concatenate([m.vertices for m in meshes])
    low, high = np.percentile(everything, 1, axis=0), np.percentile(everything, 99, axis=0)
    eye, camera, T = _viewpoint(low, high, width, height)
    kept = [m for m in meshes if not _hides_the_room(m, eye, low, high)]
    image = _shoot(kept, camera, T).reshape(height, width, 3)
    size = (width // _SUPERSAMPLING, height // _SUPERSAMPLING)
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    if not cv2.imwrite(str(path_png), small[..., ::-1]):
        raise OutputError(f"cannot write {path_png}", "give a writable path that ends in .png")


def _viewpoint(
    low: np.ndarray, high: np.ndarray, width: int, height: int
) -> tuple[np.ndarray, Camera, Float[np.ndarray, "4 4"]]:
    """From above a corner, so that the whole fits."""
    center, radius = (low + high) / 2, np.linalg.norm(high - low) / 2
    direction = np.array([-0.55, -0.6, 0.75])
    direction /= np.linalg.norm(direction)
    eye = center + direction * radius / np.sin(_FIELD_OF_VIEW_RAD / 2)
    forward = -direction
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    T = np.eye(4)
    T[:3, :3] = np.stack([right, np.cross(forward, right), forward], 1)
    T[:3, 3] = eye
    focal = height / 2 / np.tan(_FIELD_OF_VIEW_RAD / 2)
    return eye, Camera(focal, focal, width / 2, height / 2, width, height), T


def _hides_the_room(mesh: Mesh, eye: np.ndarray, low: np.ndarray, high: np.ndarray) -> bool:
    """Large, thin and upright, on the viewer's side: a wall."""
    size = np.ptp(mesh.vertices, axis=0)
    center = mesh.vertices.mean(0)
    tall = size[2] > 0.5 * (high[2] - low[2]) and max(size[:2]) > 1.0
    outward, to_eye = center - (low + high) / 2, eye - (low + high) / 2
    thin = len(mesh.vertices) == 8  # walls are boxes
    return bool(tall and thin and outward[:2] @ to_eye[:2] > 0)


def _shoot(meshes: list[Mesh], camera: Camera, T: np.ndarray) -> UInt8[np.ndarray, "pixels 3"]:
    scene = RayScene(meshes, [i + 1 for i in range(len(meshes))])
    colors = np.concatenate([_colors_of(m) for m in meshes]).astype(np.float32)
    directions = (camera_rays(camera).reshape(-1, 3) @ T[:3, :3].T).astype(np.float32)
    origins = np.tile(T[:3, 3].astype(np.float32), (len(directions), 1))
    image = np.tile(_SKY, (len(directions), 1))
    open_rays = np.arange(len(directions))
    for _ in range(_LAYERS):
        hits = scene.cast(origins[open_rays], directions[open_rays])
        hit = hits.instance > 0
        facing = np.sum(hits.normal * directions[open_rays], -1) < 0
        shown = hit & facing
        corners = scene.faces[hits.triangle[shown]]
        brightness = 0.45 + 0.55 * np.clip(hits.normal[shown] @ _LIGHT, 0, 1)
        image[open_rays[shown]] = colors[corners].mean(1) * brightness[:, None]
        passed = hit & ~facing
        step = hits.distance[passed, None] + 1e-3
        behind = open_rays[passed]
        origins[behind] += directions[behind] * step
        open_rays = behind
        if not len(open_rays):
            break
    return np.clip(image, 0, 255).astype(np.uint8)


def _colors_of(mesh: Mesh) -> np.ndarray:
    return np.full((len(mesh.vertices), 3), 180) if mesh.colors is None else mesh.colors
