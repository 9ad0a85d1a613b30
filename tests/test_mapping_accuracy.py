"""The surface against the truth: rooms turned off the voxel lattice, and no face where none is.

Distances are those of the scores of a map (`isr_jax.evaluation`): accuracy from points spread over
the map to the whole true meshes, completeness from what was seen to the map.
"""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
import pytest

from isr_jax.cad import default_library
from isr_jax.config import MappingSettings, NoiseModel
from isr_jax.evaluation.maps.surface_scores import SurfaceScores, score_surface
from isr_jax.evaluation.maps.true_surface import distance_to_surface
from isr_jax.evaluation.result_files import Result, Truth
from isr_jax.mapping import PanopticMapper
from isr_jax.synthetic import NO_NOISE, builtin_room
from isr_jax.synthetic.camera.cameras import named_camera
from isr_jax.synthetic.camera.walk import camera_path
from isr_jax.synthetic.film.film import Film
from isr_jax.synthetic.room import merge_meshes
from isr_jax.types import Camera, Frame, FrameSegments, Mesh

from .reference.mapping_reference import Solid, look_at, render

VOXEL_M = 0.01
SETTINGS = MappingSettings(voxel_size_m=VOXEL_M, block_capacity=8192)
NEAREST_M = 0.1


def off_lattice() -> np.ndarray:
    """T_map_world: a turn of 17 and a tilt of 9 degrees, and no whole number of voxels."""
    (c, s), (d, t) = ((np.cos(a), np.sin(a)) for a in np.radians([17.0, 9.0]))
    T = np.eye(4)
    T[:3, :3] = np.array([[1, 0, 0], [0, d, -t], [0, t, d]]) @ [[c, -s, 0], [s, c, 0], [0, 0, 1]]
    T[:3, 3] = 0.0137, -0.0211, 0.0053
    return T


@dataclasses.dataclass(frozen=True)
class Filmed:
    """Depth of a walk through the built-in room, and the truth of what it shows."""

    frames: tuple[Frame, ...]
    truth: Mesh
    seen: np.ndarray
    """[points, 3]: true points in range, world frame."""


@functools.cache
def filmed(width: int, frames: int, farthest_m: float, noise: NoiseModel) -> Filmed:
    room = builtin_room(default_library())
    camera = named_camera("kinect", width, width * 3 // 4)
    film = Film(room, camera, noise, 0)
    taken, seen = [], []
    for i, T in enumerate(camera_path(room, frames, 0, camera=camera, sensor=noise)):
        shot = film.shoot(i, T)
        believed = (shot.depth_m > NEAREST_M) & (shot.depth_m <= farthest_m)
        depth_m = np.where(believed, shot.depth_m, 0).astype(np.float32)
        color = np.ascontiguousarray(shot.color)
        taken.append(Frame(i, f"{i:06d}", color, depth_m, T.astype(np.float32), camera))
        along = (shot.seen.points - T[:3, 3]) @ T[:3, 2]
        seen.append(shot.seen.points[along < farthest_m - 0.1])
    truth = merge_meshes([surface.mesh for surface in film.surfaces.values()])
    return Filmed(tuple(taken), truth, np.concatenate(seen))


def mapped(frames) -> Mesh:
    """The surface of a map that is turned off the lattice, back in the world."""
    T = off_lattice()
    mapper = PanopticMapper(frames[0].camera, SETTINGS)
    nothing = np.zeros(frames[0].depth_m.shape, np.int32)
    segments = FrameSegments(nothing, np.zeros(1, np.int32), np.zeros(1, np.int32))
    for frame in frames:
        turned = (T @ frame.T_world_camera).astype(np.float32)
        mapper.integrate(dataclasses.replace(frame, T_world_camera=turned), segments)
    mesh = mapper.surface().mesh
    vertices = (mesh.vertices - T[:3, 3]) @ T[:3, :3]
    return Mesh(vertices.astype(np.float32), mesh.faces)


def scores(mesh: Mesh, film: Filmed) -> SurfaceScores:
    zeros = np.zeros(len(film.seen), np.int32)
    truth = forged(Truth, points=film.seen, instance=zeros, mesh=film.truth)
    result = forged(Result, points=mesh.vertices.astype(np.float64), faces=mesh.faces)
    return score_surface(truth, result)


def forged(kind: type, **fields):
    """An instance with these fields alone: surfaces are scored without entities or graphs."""
    item = object.__new__(kind)
    for name, value in fields.items():
        object.__setattr__(item, name, value)
    return item


def face_distances_voxels(mesh: Mesh, truth: Mesh) -> np.ndarray:
    """Distance of the middle of every fifth face to the true surface."""
    middle = mesh.vertices[mesh.faces[::5]].mean(1).astype(np.float64)
    return distance_to_surface(middle, truth, 0.5) / VOXEL_M


def check_without_noise(film: Filmed) -> None:
    mesh = mapped(film.frames)
    found = scores(mesh, film)
    assert found.accuracy_median_m < 0.001  # the bound that is promised is twice that
    assert found.completeness_median_m < 0.001
    assert found.rate(0.02).f_score > 0.99
    far = face_distances_voxels(mesh, film.truth)
    assert np.mean(far > 1) < 0.005 and far.max() < 4  # the truncation distance


def check_with_noise(film: Filmed) -> None:
    found = scores(mapped(film.frames), film)
    assert found.rate(0.02).f_score > 0.95
    assert found.rate(0.02).recall > 0.97
    assert found.accuracy_median_m < 0.005


def test_a_turned_room_without_noise_lies_on_the_truth():
    check_without_noise(filmed(320, 10, 2.5, NO_NOISE))


def test_a_turned_room_seen_by_a_kinect_is_whole_and_near_the_truth():
    check_with_noise(filmed(320, 16, 2.5, NoiseModel()))


@pytest.mark.slow
@pytest.mark.parametrize("noise", [NO_NOISE, NoiseModel()], ids=["true", "kinect"])
def test_a_whole_turned_room_at_full_size(noise):
    film = filmed(640, 120, 4.0, noise)
    (check_without_noise if noise is NO_NOISE else check_with_noise)(film)


SOLIDS = [
    Solid("plane", (0, 0, 1), 0.013),
    Solid("plane", (0, 1, 0), 1.4),
    Solid("box", (0, 0, 0.37), (0.4, 0.3, 0.37), yaw=0.35),
    Solid("box", (0.7, -0.4, 0.25), (0.02, 0.02, 0.25), yaw=0.2),
    Solid("ball", (0.1, 0.05, 0.86), 0.12),
]
CAMERA = Camera(262.0, 262.0, 159.5, 119.5, 320, 240)


def views(count: int) -> list[tuple[Frame, FrameSegments]]:
    """Over a table with a ball on it and a post beside it, before a wall."""
    angles = np.linspace(-1, 1, count) + 0.01
    eyes = [(1.6 * np.sin(a), -1.6 * np.cos(a), 1.3) for a in angles]
    return [
        render(SOLIDS, look_at(eye, (0, 0, 0.4)), CAMERA, index=i) for i, eye in enumerate(eyes)
    ]


@pytest.mark.parametrize("count", [1, 3])
def test_no_face_bridges_a_silhouette_or_leaves_the_surface(count):
    """Behind edges nothing was seen: the map ends there, it spans no gap between near and far."""
    mapper = PanopticMapper(CAMERA, SETTINGS)
    for frame, segments in views(count):
        mapper.integrate(frame, segments)
    mesh = mapper.surface().mesh
    corners = mesh.vertices[mesh.faces].astype(np.float64)
    points = np.concatenate([corners.mean(1), *np.moveaxis(corners, 1, 0)])
    distance_m = np.min([solid.distance(points) for solid in SOLIDS], 0)
    assert len(mesh.faces) > 100_000
    assert distance_m.max() < 1.5 * VOXEL_M
    assert np.median(distance_m) < 0.0015
    edges = np.linalg.norm(corners - np.roll(corners, 1, 1), axis=-1)
    assert edges.max() < 2 * np.sqrt(3) * VOXEL_M  # vertices of neighbouring cells
