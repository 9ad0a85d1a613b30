"""Border: trimesh. How fast rooms are filmed: each step alone, the whole, and a peer's rays."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import jax
import numpy as np
import trimesh
from trimesh.ray.ray_pyembree import RayMeshIntersector

from isr_jax.cad import default_library
from isr_jax.config import NoiseModel
from isr_jax.runtime.caches import enable_compilation_cache
from isr_jax.synthetic import Room, make_room, render_sequence
from isr_jax.synthetic.camera.cameras import default_camera
from isr_jax.synthetic.camera.free_space import free_space
from isr_jax.synthetic.camera.walk import camera_path
from isr_jax.synthetic.film.film import Film, Look
from isr_jax.synthetic.film.render import make_folders, write_shot
from isr_jax.synthetic.film.views import Views

from .figures import Figure, seconds_each, show

FRAMES_PER_S = 5.0
"""The bound: frames of 640 x 480 per second on two cores, noise and files included."""
_CAMERA = default_camera(640, 480)


def render(frames: int = 60, repeats: int = 9, seed: int = 7) -> None:
    """Time the renderer of synthetic rooms on a furnished room.

    Steps are timed alone, one after the other in one thread (the shading kernel uses as many as it
    likes); the whole is `render_sequence`, where threads make and write the images of one frame
    while the rays of the next are cast, without what it does once per room. The peer is trimesh's
    interface to the same Embree: the same rays, first hits only.

    Args:
        frames: Of the whole film.
        repeats: Of each step.
        seed: Of the room.
    """
    enable_compilation_cache()
    room = make_room(seed, default_library())
    steps = _steps(room, repeats)
    rate, core_s = _whole(room, frames)
    peer, ours = steps["peer: trimesh"][1], steps["cast"][1]
    figures = [
        *(Figure(n, 1000 * wall, "ms per frame", "lower") for n, (wall, _) in steps.items()),
        *(Figure(n, 1000 * core, "core ms per frame", "lower") for n, (_, core) in steps.items()),
        Figure("whole film", rate, "frames/s", "higher", FRAMES_PER_S),
        Figure("whole film", 1000 * core_s, "core ms per frame", "lower"),
        Figure("cast: trimesh / ours", peer / ours, "x of core time", "higher"),
    ]
    things = f"{len(room.items)} items, {frames} frames of 640 x 480"
    show(f"render: {room.kind} of seed {seed}, {things}", figures)


def _steps(room: Room, repeats: int) -> dict[str, tuple[float, float]]:
    """Wall and core seconds of each step of a frame."""
    film = Film(room, _CAMERA, NoiseModel(), 0)
    pose = camera_path(room, 30, 0)[7]
    look = film.look(pose)
    developed = jax.block_until_ready(film.expose(look))
    shot = film.shot(0, look, developed)
    views = Views(film.surfaces, film.scene, free_space(room, 0), _CAMERA, NoiseModel(), 0)
    eyes = np.broadcast_to(look.eye, look.directions.shape)
    with tempfile.TemporaryDirectory() as folder:
        make_folders(Path(folder))
        work = {
            "cast": lambda: film.scene.cast_into(eyes, look.directions),
            "cast and lamp": lambda: film.look(pose),
            "shade": lambda: jax.block_until_ready(film.expose(look)),
            "noise": lambda: film.sense(0, shot.true_depth_m, developed),
            "noise and seen surface": lambda: film.shot(0, look, developed),
            "views": lambda: views.frame(pose, shot.instance, shot.true_depth_m),
            "encode and write": lambda: write_shot(Path(folder), 0, shot),
            "peer: trimesh": _peer(film, eyes, look),
        }
        return {name: seconds_each(call, repeats) for name, call in work.items()}


def _peer(film: Film, eyes: np.ndarray, look: Look):
    mesh = trimesh.Trimesh(film.scene.vertices, film.scene.faces, process=False)
    peer = RayMeshIntersector(mesh)
    return lambda: peer.intersects_id(eyes, look.directions, multiple_hits=False)


def _whole(room: Room, frames: int) -> tuple[float, float]:
    """Frames per second, and seconds of any core per frame, between the first and the last."""
    walls: list[float] = []
    cores: list[float] = []

    def tick(done: int, of: int) -> None:
        walls.append(time.perf_counter())
        cores.append(time.process_time())

    with tempfile.TemporaryDirectory() as folder:
        render_sequence(room, Path(folder), frames=frames, progress=tick)
    count = len(walls) - 1
    return count / (walls[-1] - walls[0]), (cores[-1] - cores[0]) / count
