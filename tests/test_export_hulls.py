"""Hulls of export: cutting, standing hulls of scans, simplification."""

from __future__ import annotations

import numpy as np
import pytest

from isr_jax.export.hull_meshes import cut_hull, hull_mesh, part_of
from isr_jax.export.scan_bodies import Niche, scan_hulls
from isr_jax.export.simplify import simplified
from isr_jax.geometry import penetration, vertical_gap
from isr_jax.geometry.convex import box_part
from isr_jax.robot_model import solid_properties

from .builders import box_mesh

FLOAT32 = 1e-6  # hull meshes are stored in float32, extents of a metre


def test_cut_keeps_the_part_in_front_of_the_plane():
    mesh = hull_mesh(box_mesh((1, 1, 1)).vertices, 64)
    half = cut_hull(mesh, np.array([1.0, 0, 0]), 0.2, 64)
    assert half is not None
    assert abs(solid_properties(half, 1.0)[0] - 0.3) < FLOAT32
    assert half.vertices[:, 0].min() > 0.2 - FLOAT32
    assert cut_hull(mesh, np.array([1.0, 0, 0]), 0.499, 64) is None
    assert cut_hull(mesh, np.array([1.0, 0, 0]), -0.6, 64) is mesh


def test_hull_mesh_is_closed_outward_and_bounded():
    points = np.random.default_rng(1).normal(size=(5000, 3))
    mesh = hull_mesh(points, 64)
    assert len(mesh.vertices) <= 64
    volume, _, inertia = solid_properties(mesh, 1.0)
    assert volume > 0 and np.all(np.linalg.eigvalsh(inertia) > 0)
    edges = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]])
    assert len(np.unique(edges, axis=0)) == len(edges)  # every edge once in each direction
    assert {tuple(e) for e in edges} == {tuple(e) for e in edges[:, ::-1]}


@pytest.mark.parametrize("flat_axis", [0, 1, 2])
def test_flat_points_grow_to_a_solid(flat_axis):
    points = np.random.default_rng(2).uniform(size=(50, 3))
    points[:, flat_axis] = 0.3
    mesh = hull_mesh(points, 64)
    assert abs(np.ptp(mesh.vertices[:, flat_axis]) - 0.01) < FLOAT32


def test_standing_hull_has_a_flat_base_on_its_support():
    rng = np.random.default_rng(3)
    points = box_mesh((0.4, 0.4, 0.8), (1, 2, 0.45)).vertices + rng.normal(0, 0.004, (1, 3))
    points = points + rng.normal(0, 0.004, points.shape)
    (hull,) = scan_hulls(points, 0.0, (), 64)
    base = hull.vertices[np.abs(hull.vertices[:, 2]) < FLOAT32]
    assert hull.vertices[:, 2].min() > -FLOAT32 and len(base) >= 3
    com = solid_properties(hull, 1.0)[1]
    assert np.all(np.abs(base[:, :2] - com[:2]).max(0) > 0.1)
    assert len(hull.vertices) <= 64


def niche(x, y, plane, top, half=0.05) -> Niche:
    return Niche(plane, top, np.array([x, y], float), 0.0, np.array([half, half]))


def test_carrying_scan_is_cut_level():
    points = box_mesh((1.0, 0.6, 0.7), (0, 0, 0.35)).vertices
    points = np.concatenate([points, [[0.2, 0.1, 0.715]]])  # noise above the top
    (hull,) = scan_hulls(points, 0.0, (niche(0, 0, 0.7, 0.8), niche(0.2, 0, 0.7, 0.8)), 64)
    assert abs(hull.vertices[:, 2].max() - 0.7) < FLOAT32
    back = box_mesh((1.0, 0.1, 0.4), (0, 0.25, 0.9)).vertices
    hulls = scan_hulls(np.concatenate([points, back]), 0.0, (niche(0, 0, 0.7, 0.8),), 64)
    assert len(hulls) == 5  # below, above, left, right and behind the carried box
    assert_free(hulls, (0, 0, 0.75), (0.1, 0.1, 0.1))


def test_a_shelf_leaves_room_on_every_board():
    w, d, t = 0.8, 0.3, 0.02
    boards = [((w, d, t), (0, 0, z)) for z in (0.01, 0.5, 1.0, 1.5)]
    sides = [((t, d, 1.5), (x, 0, 0.75)) for x in (-0.39, 0.39)]
    meshes = [box_mesh(*part) for part in (*boards, *sides, ((w, t, 1.5), (0, 0.14, 0.75)))]
    points = np.concatenate([m.vertices for m in meshes])
    niches = (niche(-0.1, 0, 0.51, 0.7), niche(0.2, 0, 0.51, 0.6), niche(0, -0.05, 1.01, 1.2))
    hulls = scan_hulls(points, 0.0, niches, 64)
    for n in niches:
        middle = (*n.center, (n.plane_m + n.top_m) / 2)
        assert_free(hulls, middle, (0.09, 0.09, n.top_m - n.plane_m - 1e-3))
        below = box_part(np.array([0.05, 0.05, 0.01]), at(*n.center, n.plane_m + 0.02))
        gaps = [vertical_gap(below, part_of(h)) for h in hulls]
        assert abs(min(gaps) - 0.015) < FLOAT32  # the board is right below


def at(x, y, z) -> np.ndarray:
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


def assert_free(hulls, center, size):
    box = box_part(np.array(size), at(*center))
    assert all(penetration(box, part_of(h))[0] < FLOAT32 for h in hulls)


def test_simplified_stays_near_and_below_the_bound():
    mesh = box_mesh((1, 1, 1), spacing_m=0.02)
    small = simplified(mesh, 500)
    assert 50 < len(small.faces) <= 500 < len(mesh.faces)
    # a cell's mean lies on the box's flat faces, up to the cells along its edges
    surface = np.abs(np.abs(small.vertices).max(1) - 0.5)
    assert surface.max() < 0.15
    assert small.colors is not None and np.all(small.colors == 128)
    assert simplified(mesh, 10**6) is mesh


def test_simplified_board_keeps_both_sides():
    board = box_mesh((1.0, 0.8, 0.01), spacing_m=0.01)
    small = simplified(board, 400)
    corners = small.vertices[small.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    for side in (1, -1):
        area = normal[:, 2][side * normal[:, 2] > 0].sum() * side
        assert 0.75 * 0.8 < area < 0.8
    assert len(small.faces) <= 400
