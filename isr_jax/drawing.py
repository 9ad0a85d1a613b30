"""Border: pictures of an exported scene, without a window (mujoco, cv2)."""

from __future__ import annotations

import importlib
import os
import sys
from pathlib import Path

import cv2
import mujoco
import numpy as np

from .errors import SceneError
from .simulation import load_model


def _draw(model, data, camera: str, width: int, height: int) -> np.ndarray:
    """RGB image of a state. `mujoco.Renderer` would bind the backend when mujoco is imported,
    and take one that needs a display."""
    default = "egl" if sys.platform == "linux" else "glfw"
    backend = importlib.import_module(f"mujoco.{os.environ.get('MUJOCO_GL') or default}")
    context = backend.GLContext(width, height)
    try:
        context.make_current()
        target = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, target)
        view, scene = mujoco.MjvCamera(), mujoco.MjvScene(model, 10_000)
        view.type, view.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, model.camera(camera).id
        all_parts = mujoco.mjtCatBit.mjCAT_ALL
        mujoco.mjv_updateScene(model, data, mujoco.MjvOption(), None, view, all_parts, scene)
        area, image = mujoco.MjrRect(0, 0, width, height), np.zeros((height, width, 3), np.uint8)
        mujoco.mjr_render(area, scene, target)
        mujoco.mjr_readPixels(image, None, area, target)
        target.free()
    finally:
        context.free()
    return image[::-1]


def render(
    scene_xml: Path,
    path_png: Path,
    *,
    camera: str = "overview",
    after_s: float = 0.0,
    width: int = 1280,
    height: int = 960,
) -> None:
    """Draw the scene to a PNG, if wished after it has moved for a while.

    Raises:
        SceneError: there is no OpenGL (EGL, OSMesa or a display) to draw with.
    """
    model = load_model(scene_xml)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    mujoco.mj_step(model, data, round(after_s / model.opt.timestep))
    try:
        image = _draw(model, data, camera, width, height)
    except Exception as error:  # each GL backend raises its own kind
        raise SceneError(
            f"cannot draw {scene_xml}: {error}",
            "install EGL (Debian: libegl1) or set MUJOCO_GL, or look at scene.glb",
        ) from error
    if not cv2.imwrite(str(path_png), image[..., ::-1]):
        raise SceneError(f"cannot write {path_png}", "give a path ending in .png that is writable")
