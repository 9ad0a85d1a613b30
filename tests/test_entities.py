"""Entities: least rectangles, robust boxes, planes by RANSAC, pieces, layout, names."""

from __future__ import annotations

import dataclasses
import logging

import jax
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isr_jax.classes import class_named
from isr_jax.config import EntitySettings
from isr_jax.entities import (
    extract_entities,
    facing_direction,
    gravity_box,
)
from isr_jax.entities.planes import find_planes, plane_set
from isr_jax.entities.ransac import best_plane, peel_planes
from isr_jax.entities.rectangles import robust_rectangle
from isr_jax.entities.submesh import main_pieces, submesh
from isr_jax.geometry import box_corners
from isr_jax.geometry.tight_box import min_area_angle
from isr_jax.types import Mesh, PanopticSurface

from .builders import box_mesh, rotation_z
from .reference import entities_reference as twin

SETTINGS = EntitySettings()
TRIM = SETTINGS.box_trim
VOXEL_M = 0.02
MM = 1e-3


def joined(*meshes: Mesh) -> Mesh:
    starts = np.cumsum([0, *(len(m.vertices) for m in meshes[:-1])])
    return Mesh(
        np.concatenate([m.vertices for m in meshes]),
        np.concatenate([m.faces + s for m, s in zip(meshes, starts, strict=True)]),
        np.concatenate([m.colors for m in meshes]),
        np.concatenate([m.normals for m in meshes]),
    )


def noisy(mesh: Mesh, sigma_m: float, seed=0) -> Mesh:
    rng = np.random.default_rng(seed)
    shift = rng.normal(0, sigma_m, mesh.vertices.shape).astype(np.float32)
    tilted = mesh.normals + rng.normal(0, 0.1, mesh.normals.shape).astype(np.float32)
    tilted /= np.linalg.norm(tilted, axis=1, keepdims=True)
    return Mesh(mesh.vertices + shift, mesh.faces, mesh.colors, tilted)


def surface_of(*parts: tuple[str, Mesh]) -> PanopticSurface:
    """One instance per part, but all of one layout class is one instance."""
    names = list(
        dict.fromkeys(n if n in ("floor", "wall") else f"{n}#{i}" for i, (n, _) in enumerate(parts))
    )
    rows = [
        names.index(n if n in ("floor", "wall") else f"{n}#{i}") for i, (n, _) in enumerate(parts)
    ]
    instance = np.concatenate(
        [
            np.full(len(m.vertices), row + 1, np.int32)
            for row, (_, m) in zip(rows, parts, strict=True)
        ]
    )
    class_ids = np.array([class_named(n.split("#")[0]).id for n in names], np.int32)
    ids = np.arange(1, len(names) + 1, dtype=np.int32)
    return PanopticSurface(joined(*(m for _, m in parts)), instance, ids, class_ids, VOXEL_M)


def upper_side(mesh: Mesh) -> Mesh:
    return submesh(mesh, mesh.normals[:, 2] > 0.9)


def floor_mesh(x=4.0, y=3.0, z=0.0) -> Mesh:
    return upper_side(box_mesh((x, y, 0.02), (0, 0, z - 0.01)))


def wall_mesh(yaw: float, distance_m: float, length=3.0, height=2.0) -> Mesh:
    """A wall at a distance from the origin that faces it."""
    mesh = box_mesh((length, 0.1, height), (0, distance_m + 0.05, height / 2))
    facing = submesh(mesh, mesh.normals[:, 1] < -0.9)
    R = rotation_z(yaw)
    return Mesh(facing.vertices @ R.T, facing.faces, facing.colors, facing.normals @ R.T)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10_000), st.integers(3, 60))
def test_least_rectangle_is_least(seed, count):
    """Never worse than the best of a fine grid of directions."""
    points = np.random.default_rng(seed).normal(0, 1, (count, 2)) * [2, 1]
    angle = min_area_angle(points)
    c, s = np.cos(angle), np.sin(angle)
    turned = points @ np.array([[c, -s], [s, c]])
    area = np.prod(np.ptp(turned, axis=0))
    assert area <= twin.least_rectangle_area(points) * (1 + 1e-9)
    assert -np.pi / 4 <= angle < np.pi / 4


@pytest.mark.parametrize("yaw", [-0.7, -0.2, 0.0, 0.3, 0.78])
def test_box_of_a_box(yaw):
    mesh = box_mesh((1.2, 0.7, 0.5), (3, -2, 0.25), yaw)
    box = gravity_box(mesh.vertices, TRIM, 2 * VOXEL_M, VOXEL_M)
    assert np.allclose(box.size, (1.2, 0.7, 0.5), atol=1e-4)
    assert np.allclose(box.center, (3, -2, 0.25), atol=1e-4)
    assert abs(float(box.yaw) - yaw) < 1e-4


def test_strays_do_not_stretch_the_box():
    mesh = noisy(box_mesh((1.2, 0.7, 0.5), (3, -2, 0.25), 0.4), 3 * MM)
    rng = np.random.default_rng(1)
    strays = rng.normal((3, -2, 0.25), 0.6, (8, 3)).astype(np.float32)
    clean = gravity_box(mesh.vertices, TRIM, 2 * VOXEL_M, VOXEL_M)
    box = gravity_box(np.concatenate([mesh.vertices, strays]), TRIM, 2 * VOXEL_M, VOXEL_M)
    assert np.allclose(clean.size, (1.2, 0.7, 0.5), atol=0.02)
    assert np.allclose(box.size, clean.size, atol=2 * VOXEL_M)
    assert abs(float(box.yaw) - 0.4) < 0.05
    assert np.ptp(strays, axis=0).min() > 1.2 / 2  # the strays would have stretched it


@pytest.mark.parametrize("yaw", [-0.6, 0.0, 0.27, 0.5])
def test_two_faces_of_a_cabinet_give_its_yaw(yaw):
    """From above two faces are a right triangle: by area alone the hypotenuse is as good."""
    size = (0.6, 0.8, 0.9)
    mesh = noisy(box_mesh(size, (1, 2, 0.45), yaw, 0.03), 4 * MM)
    local = mesh.normals @ rotation_z(yaw)
    seen = submesh(mesh, (local[:, 0] > 0.7) | (local[:, 1] > 0.7))
    box = gravity_box(
        seen.vertices,
        TRIM,
        2 * VOXEL_M,
        VOXEL_M,
        facing=facing_direction(seen.normals),
        weight=SETTINGS.box_normal_weight,
    )
    assert abs(float(box.yaw) - yaw) < 0.03
    assert np.allclose(box.size, size, atol=0.03)


def test_a_round_thing_faces_nowhere():
    angles = np.linspace(0, 2 * np.pi, 360, endpoint=False)
    around = np.stack([np.cos(angles), np.sin(angles), 0 * angles], 1)
    assert abs(facing_direction(around)) < 1e-6
    assert abs(facing_direction(np.array([[0.0, 0.0, 1.0]]))) < 1e-6


def test_points_on_a_line_have_a_rectangle():
    line = np.linspace(0, 1, 20)[:, None] * [np.cos(0.3), np.sin(0.3)]
    angle, low, high = robust_rectangle(line, TRIM, 0.01)
    assert abs(angle - 0.3) < 1e-6
    assert np.allclose(high - low, (1, 0), atol=1e-6)


def test_kernel_equals_its_twin_on_the_same_draws():
    mesh = noisy(box_mesh((0.6, 0.5, 0.4), (0.2, 0, 0), 0.3, 0.04), 4 * MM)
    size = 2048
    points, normals = np.zeros((size, 3), np.float32), np.zeros((size, 3), np.float32)
    count = len(mesh.vertices)
    points[:count], normals[:count] = mesh.vertices, mesh.normals
    live = np.arange(size) < count
    live[:count:7] = False
    draws = np.random.default_rng(3).uniform(size=25).astype(np.float32)
    args = np.array(0.015, np.float32), np.array(np.cos(0.5), np.float32)
    normal, offset, inside = jax.jit(best_plane)(points, normals, live, draws, *args)
    n, d, chosen = twin.best_plane(points[:count], normals[:count], live[:count], draws, *args)
    assert np.allclose(normal, n, atol=1e-4) and abs(float(offset) - d) < 1e-4
    assert set(np.flatnonzero(inside)) == set(chosen)


def find(mesh, **changes):
    given = {
        "threshold_m": 0.03,
        "min_ratio": 0.1,
        "max_planes": 8,
        "iterations": 200,
        "seed": 0,
    }
    return find_planes(mesh, **(given | changes))


def test_a_box_has_its_six_planes_to_the_millimetre():
    size, center, yaw = (0.8, 0.6, 0.5), (1, 2, 0.25), 0.35
    mesh = noisy(box_mesh(size, center, yaw, 0.02), 2 * MM)
    planes = plane_set(mesh, find(mesh), trim=TRIM, margin_m=2 * VOXEL_M)
    assert len(planes.offset) == 6
    local = planes.normal @ rotation_z(yaw)
    axis = np.abs(local).argmax(1)
    assert sorted(zip(axis.tolist(), np.sign(local[range(6), axis]).tolist())) == [
        (a, s) for a in range(3) for s in (-1.0, 1.0)
    ]
    assert np.abs(local[range(6), axis]).min() > 0.9999
    reach = -(planes.offset + planes.normal @ np.array(center, np.float32))
    assert np.allclose(-reach, -np.array(size)[axis] / 2, atol=MM)
    true_area = np.prod(size) / np.array(size)[axis]
    assert np.allclose(planes.area_m2, true_area, rtol=0.1)


def test_rectangles_lie_in_their_plane_and_turn_about_its_normal():
    mesh = box_mesh((0.8, 0.6, 0.5), (1, 2, 0.25), 0.35, 0.04)
    planes = plane_set(mesh, find(mesh), trim=TRIM, margin_m=2 * VOXEL_M)
    heights = np.einsum("pkc,pc->pk", planes.corners, planes.normal) + planes.offset[:, None]
    assert np.abs(heights).max() < 1e-5
    first = planes.corners[:, 1] - planes.corners[:, 0]
    second = planes.corners[:, 2] - planes.corners[:, 1]
    assert np.all(np.sum(np.cross(first, second) * planes.normal, 1) > 0)
    sides = np.sort(np.linalg.norm(np.stack([first, second], 1), axis=2), 1)
    assert np.allclose(np.unique(np.round(sides, 3), axis=0), [(0.5, 0.6), (0.5, 0.8), (0.6, 0.8)])


def test_the_steps_of_an_l_are_two_planes():
    mesh = joined(
        box_mesh((0.6, 0.4, 0.4), (0, 0, 0.2), spacing_m=0.03),
        box_mesh((0.6, 0.4, 0.8), (0, 0.4, 0.4), spacing_m=0.03),
    )
    up = [f for f in find(mesh, min_ratio=0.05) if f.normal[2] > 0.9]
    assert sorted(round(-f.offset, 3) for f in up) == [0.4, 0.8]


def test_planes_stop_at_the_least_share():
    ball = np.random.default_rng(0).normal(size=(2000, 3)).astype(np.float32)
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    mesh = Mesh(ball, np.zeros((0, 3), np.int32), None, ball)
    assert find(mesh, threshold_m=0.01, min_ratio=0.1) == []


def test_the_same_seed_gives_the_same_planes():
    mesh = noisy(box_mesh((0.8, 0.6, 0.5), spacing_m=0.04), 5 * MM)
    a, b = find(mesh, seed=3), find(mesh, seed=3)
    assert all(np.array_equal(x.normal, y.normal) for x, y in zip(a, b, strict=True))


def test_padding_does_not_change_the_kernel():
    mesh = box_mesh((0.8, 0.6, 0.5), spacing_m=0.06)
    n = len(mesh.vertices)
    out = []
    for size in (n, 2 * n):
        points, normals = np.zeros((size, 3), np.float32), np.zeros((size, 3), np.float32)
        points[:n], normals[:n] = mesh.vertices, mesh.normals
        scalars = np.float32(0.02), np.float32(0.9), np.float32(0.1), np.int32(8)
        found = peel_planes(
            points, normals, np.arange(size) < n, jax.random.key(0), *scalars, iterations=60
        )
        assert all(np.all(np.isfinite(f)) for f in found)
        out.append(found)
    assert np.array_equal(out[0][2], out[1][2])
    assert np.allclose(out[0][0], out[1][0], atol=1e-5)


def test_far_small_pieces_go_and_near_ones_stay():
    body = box_mesh((0.5, 0.5, 0.05), (0, 0, 0.5))
    leg = box_mesh((0.04, 0.04, 0.4), (0.2, 0.2, 0.25), spacing_m=0.02)
    stray = box_mesh((0.1, 0.1, 0.1), (2, 0, 0.5))
    kept = main_pieces(joined(body, leg, stray), 0.1, 0.2)
    assert len(kept.vertices) == len(body.vertices) + len(leg.vertices)


def room():
    return surface_of(
        ("floor", floor_mesh()),
        ("wall", wall_mesh(0.0, 1.5, 4.0)),
        ("wall", wall_mesh(np.pi / 2, 2.0)),
        ("wall", wall_mesh(np.pi, 1.5, 0.4, 0.4)),
        ("table", box_mesh((1.2, 0.8, 0.7), (0, 0, 0.35), 0.3)),
        ("chair", box_mesh((0.4, 0.4, 0.5), (1.2, 0.6, 0.25), 0.1, 0.03)),
        ("chair", box_mesh((0.4, 0.4, 0.9), (-1.2, 0.6, 0.45), -0.4, 0.03)),
        ("cup", box_mesh((0.01, 0.01, 0.01), (0, 0, 0.71))),
    )


def test_entities_of_a_room():
    entities = extract_entities(room(), np.eye(4), SETTINGS)
    names = [e.name for e in entities]
    assert names == ["floor", "wall_1", "wall_2", "chair_1", "chair_2", "table_1"]
    by_name = dict(zip(names, entities, strict=True))
    assert by_name["chair_1"].box.size[2] > by_name["chair_2"].box.size[2]
    assert [e.is_layout for e in entities] == [True] * 3 + [False] * 3
    assert len({e.id for e in entities}) == len(entities)
    assert {e.id for e in entities if not e.is_layout} == {3, 4, 5}
    assert np.allclose(by_name["table_1"].box.size, (1.2, 0.8, 0.7), atol=MM)
    assert abs(float(by_name["table_1"].box.yaw) - 0.3) < 1e-3


def test_layout_is_one_plane_with_its_normal_into_the_room():
    entities = extract_entities(room(), np.eye(4), SETTINGS)
    layout = {e.name: e for e in entities if e.is_layout}
    expected = {
        "floor": ((0, 0, 1), 0, 4 * 3),
        "wall_1": ((0, -1, 0), 1.5, 4 * 2),
        "wall_2": ((1, 0, 0), 2.0, 3 * 2),
    }
    for name, (normal, offset, area) in expected.items():
        planes = layout[name].planes
        assert planes.normal.shape == (1, 3)
        assert np.allclose(planes.normal[0], normal, atol=1e-4)
        assert abs(planes.offset[0] - offset) < MM
        sides = np.linalg.norm(planes.corners[0][[1, 3]] - planes.corners[0][0], axis=1)
        assert abs(np.prod(sides) - area) < 0.05
        # the box lies behind the plane, its face on it
        signed = np.asarray(box_corners(layout[name].box)) @ planes.normal[0] + planes.offset[0]
        assert abs(signed.max()) < 1e-3 and signed.min() < -0.01


def test_a_bent_wall_is_one_wall():
    """Depth sensors bend flat walls: two parts 6 cm apart in depth are one wall."""
    near = wall_mesh(0.0, 1.5)
    far = Mesh(near.vertices + np.float32([3.0, 0.06, 0]), near.faces, near.colors, near.normals)
    entities = extract_entities(
        surface_of(("floor", floor_mesh()), ("wall", near), ("wall", far)), np.eye(4), SETTINGS
    )
    assert [e.name for e in entities] == ["floor", "wall_1"]


def test_a_floor_nobody_labelled_is_replaced_and_said(caplog):
    parts = [("table", box_mesh((1.2, 0.8, 0.7), (0, 0, 0.35), 0.3))]
    with caplog.at_level(logging.WARNING, logger="isr_jax"):
        entities = extract_entities(surface_of(*parts), np.eye(4), SETTINGS)
    assert "no floor was labelled" in caplog.text
    floor = entities[0]
    assert floor.name == "floor" and floor.is_layout
    assert np.allclose(floor.planes.normal, [[0, 0, 1]]) and floor.planes.offset[0] == 0
    assert abs(float(floor.box.center[2] + floor.box.size[2] / 2)) < 1e-6


def test_an_empty_surface_has_no_entities():
    empty = PanopticSurface(
        Mesh(
            np.zeros((0, 3), np.float32),
            np.zeros((0, 3), np.int32),
            np.zeros((0, 3), np.uint8),
            np.zeros((0, 3), np.float32),
        ),
        np.zeros(0, np.int32),
        np.zeros(0, np.int32),
        np.zeros(0, np.int32),
        VOXEL_M,
    )
    assert len(extract_entities(empty, np.eye(4), SETTINGS)) == 0


def things(*parts, settings=SETTINGS):
    surface = surface_of(("floor", floor_mesh()), *parts)
    return [e for e in extract_entities(surface, np.eye(4), settings) if not e.is_layout]


def test_fragments_are_left_out_and_counted(caplog):
    crumb = ("sofa", box_mesh((0.02, 0.17, 0.16), (0, 1, 0.5), spacing_m=0.01))
    chair = ("chair", box_mesh((0.4, 0.4, 0.9), (1, 0, 0.45), spacing_m=0.03))
    with caplog.at_level(logging.INFO, logger="isr_jax"):
        assert [e.name for e in things(crumb, chair)] == ["chair_1"]
    assert "1 fragments left out: sofa" in caplog.text
    kept = dataclasses.replace(SETTINGS, drop_fragments=False)
    assert [e.name for e in things(crumb, chair, settings=kept)] == ["chair_1", "sofa_1"]


def test_flakes_scattered_in_a_large_box_are_no_thing():
    spots = [(x, y, z) for x in (0, 1.0) for y in (0, 0.5) for z in (0.2, 1.2)]
    flakes = joined(*(box_mesh((0.06, 0.06, 0.02), s, spacing_m=0.02) for s in spots))
    reach = dataclasses.replace(SETTINGS, piece_link_m=1.5)  # one piece
    assert things(("cabinet", flakes), settings=reach) == []
    every = dataclasses.replace(reach, min_coverage=0.0)
    assert len(things(("cabinet", flakes), settings=every)) == 1


def test_parts_of_one_thing_are_joined_and_neighbours_are_not():
    desk = box_mesh((1.4, 0.7, 0.03), (0, 0, 0.73), spacing_m=0.03)
    legs = box_mesh((1.3, 0.6, 0.7), (0, 0, 0.35), spacing_m=0.05)
    near = submesh(legs, legs.normals[:, 0] > 0.9)
    top = joined(desk, submesh(legs, legs.normals[:, 0] < -0.9))
    (found,) = things(("desk", top), ("desk", near))
    assert found.id == 2 and found.merged_ids == (3,)
    assert len(found.mesh.vertices) == len(top.vertices) + len(near.vertices)
    halves = [
        ("cup", box_mesh((0.04, 0.08, 0.08), (x, 0, 0.04), spacing_m=0.01)) for x in (0, 0.045)
    ]
    assert [e.name for e in things(*halves)] == ["cup_1"]
    books = [
        ("book", box_mesh((0.15, 0.21, 0.03), (0, 0, z), spacing_m=0.01)) for z in (0.015, 0.05)
    ]
    cabinets = [
        ("cabinet", box_mesh((0.6, 0.6, 0.8), (x, 2, 0.4), spacing_m=0.05)) for x in (0, 0.6)
    ]
    names = [e.name for e in things(*books, *cabinets)]
    assert names == ["book_1", "book_2", "cabinet_1", "cabinet_2"]


@pytest.mark.parametrize(("bottom_m", "name"), [(0.0, "cabinet_1"), (1.4, "wall_cabinet_1")])
def test_a_cabinet_high_up_is_a_wall_cabinet(bottom_m, name):
    mesh = box_mesh((0.8, 0.35, 0.7), (0, 0, bottom_m + 0.35))
    (found,) = things(("cabinet", mesh))
    assert found.name == name and found.class_name == name[:-2]


def test_the_boards_of_a_shelf_are_planes_and_those_of_a_cup_are_not():
    shell = box_mesh((0.8, 0.3, 2.0), (0, 0, 1.0), spacing_m=0.02)
    sides = submesh(shell, (np.abs(shell.normals[:, 0]) > 0.9) | (shell.normals[:, 1] > 0.9))
    heights = (0.05, 0.4, 0.75, 1.1, 1.45, 1.8)
    boards = [
        upper_side(box_mesh((0.76, 0.28, 0.02), (0, 0, z - 0.01), spacing_m=0.03)) for z in heights
    ]
    (shelf,) = things(("bookshelf", joined(sides, *boards)))
    up = shelf.planes.normal[:, 2] > 0.9
    np.testing.assert_allclose(np.sort(-shelf.planes.offset[up]), heights, atol=5 * MM)
    (cup,) = things(("cup", box_mesh((0.08, 0.08, 0.1), (0, 0, 0.05), spacing_m=0.01)))
    assert len(cup.planes.offset) == 0
