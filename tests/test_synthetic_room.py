"""Made rooms: nothing touches what does not carry it, and the truth is true."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from isr_jax.cad import default_library
from isr_jax.cad_types import CadLibrary
from isr_jax.errors import LibraryError
from isr_jax.scene_file import ROOM_NAME, read_scene, write_scene
from isr_jax.synthetic import (
    NoiseModel,
    Room,
    builtin_room,
    make_room,
    true_entities,
    truth_scene,
)
from isr_jax.synthetic.cutting import cut_edges
from isr_jax.synthetic.exterior import exterior_parts, open_planes
from isr_jax.synthetic.filming import SURFACE_GRID_M, Film, joined
from isr_jax.synthetic.placement import MARGIN_M, overlap_depths
from isr_jax.synthetic.render import default_camera
from isr_jax.synthetic.room import upright_from_gravity
from isr_jax.synthetic.support_rules import carrying_planes
from isr_jax.synthetic.surface import open_surface
from isr_jax.synthetic.walk import camera_path
from isr_jax.types import Entities

from .builders import box_mesh, library_of, parts_model, table_model
from .furniture import block_model, bookshelf_model, cabinet_model, chair_model, furniture_library

SEEDS = range(5)
FLOAT32_M = 2e-6
"""Roundings of coordinates of a few metres, a few times over."""


@pytest.fixture(scope="module")
def library() -> CadLibrary:
    return furniture_library()


@pytest.fixture(scope="module")
def rooms(library: CadLibrary) -> list[Room]:
    return [make_room(seed, library) for seed in SEEDS]


@pytest.fixture(scope="module")
def entities(rooms: list[Room]) -> list[Entities]:
    return [true_entities(room) for room in rooms[:2]]


def test_boxes_keep_their_margin(rooms):
    for room in rooms:
        depth = overlap_depths([i.box for i in room.items], [i.box for i in room.items])
        for a, first in enumerate(room.items):
            for b, second in enumerate(room.items[:a]):
                if not _carries(room, first, second) and not _carries(room, second, first):
                    assert depth[a, b] <= -MARGIN_M + 1e-5, (room.name, first.name, second.name)


def _carries(room, upper, lower) -> bool:
    """``lower`` carries ``upper``, directly or not."""
    by_name = {item.name: item for item in room.items}
    while upper.parent in by_name:
        if upper.parent == lower.name:
            return True
        upper = by_name[upper.parent]
    return False


def test_things_stand_exactly_on_the_plane_that_carries_them(rooms):
    for room in rooms:
        by_name = {item.name: item for item in room.items}
        for item in room.items:
            bottom = item.center[2] - item.scale * item.model.size[2] / 2
            height = 0.0
            if item.parent in by_name:
                carrier = by_name[item.parent]
                corners = carrier.model.planes.corners[item.parent_plane]
                height = carrier.to_world(corners)[:, 2].mean()
            assert bottom == pytest.approx(height, abs=FLOAT32_M)


def test_footprints_lie_within_the_plane_that_carries_them(rooms):
    for room in rooms:
        by_name = {item.name: item for item in room.items}
        for item in (i for i in room.items if i.parent in by_name):
            carrier = by_name[item.parent]
            corners = carrier.to_world(carrier.model.planes.corners[item.parent_plane])
            half = item.scale * item.model.size / 2
            signs = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
            turn = item.T_world_cad[:2, :2]
            feet = (signs * half[:2]) @ turn.T + item.center[:2]
            for k in range(4):  # counter-clockwise edges: the inside is on the left
                edge = (corners[(k + 1) % 4] - corners[k])[:2]
                left = edge[0] * (feet - corners[k][:2])[:, 1]
                assert np.all(left - edge[1] * (feet - corners[k][:2])[:, 0] > 0)


def test_rooms_hold_what_they_promise(rooms):
    for room in rooms:
        classes = [item.model.class_name for item in room.items]
        assert len(classes) >= 8 and "table" in classes and classes.count("chair") >= 2
        assert any(item.model.articulated for item in room.items)
        assert max(room.support_depth(item.name) for item in room.items) >= 3
        ids = [p.id for p in room.layout] + [i.id for i in room.items]
        assert ids == list(range(1, len(ids) + 1))
        assert all(0.9 <= item.scale <= 1.1 for item in room.items)


def test_everything_stands_between_the_walls(rooms, entities):
    for room, scene in zip(rooms, entities, strict=False):
        for patch in room.layout[1:]:
            for entity in scene.items[len(room.layout) :]:
                gap = (entity.mesh.vertices - patch.corners[0]) @ patch.normal
                assert gap.min() >= MARGIN_M - 1e-4


def test_the_walls_do_not_follow_the_axes(rooms):
    yaws = [float(abs(room.layout[1].box.yaw)) for room in rooms]
    assert all(0.15 < yaw < 0.65 for yaw in yaws) and len(set(yaws)) == len(yaws)


def test_true_planes_bound_their_meshes(entities):
    """Vertices of an outermost plane lie on it; its rectangle spans the area that it states."""
    for scene in entities:
        for entity in scene:
            planes = entity.planes
            on_plane = np.einsum("pi,pci->pc", planes.normal, planes.corners)
            assert np.abs(on_plane + planes.offset[:, None]).max() < 1e-5
            sides = np.linalg.norm(np.diff(planes.corners[:, :3], axis=1), axis=2)
            assert np.all(planes.area_m2 <= sides.prod(1) * 1.001 + 1e-6)
            near = entity.mesh.vertices @ planes.normal.T + planes.offset
            assert np.all(np.abs(near).min(0) < 1e-5)


def test_true_meshes_fill_their_boxes(rooms, entities):
    for room, scene in zip(rooms, entities, strict=False):
        for item in room.items:
            entity = next(e for e in scene if e.name == item.name)
            low, high = entity.mesh.vertices[:, 2].min(), entity.mesh.vertices[:, 2].max()
            assert high - low == pytest.approx(float(entity.box.size[2]), abs=1e-5)


def test_layout_normals_point_into_the_room(rooms):
    for room in rooms:
        middle = np.asarray(room.T_world_room)[:3, 3] + [0, 0, 1.0]
        for patch in room.layout:
            assert (middle - patch.corners.mean(0)) @ patch.normal > 0.5


def test_a_ceiling_looks_down(library):
    room = make_room(0, library, ceiling=True)
    assert room.layout[-1].class_name == "ceiling"
    np.testing.assert_allclose(room.layout[-1].normal, [0, 0, -1], atol=1e-6)


def test_the_truth_passes_the_schema_and_comes_back(rooms, tmp_path: Path):
    for room in rooms[:2]:
        write_scene(truth_scene(room), tmp_path / "scene.json")
        scene = read_scene(tmp_path / "scene.json")
        for item in room.items:
            record = scene.entity(item.name)
            assert record.parent == item.parent and record.cad.id == item.model.id
            np.testing.assert_allclose(record.cad.T_world_cad, item.T_world_cad, atol=1e-6)
            assert record.type == ("articulated" if item.model.articulated else "rigid")
        assert all(scene.entity(p.name).parent == ROOM_NAME for p in room.layout)
        assert scene.proximal == ()


def test_the_support_plane_of_the_truth_is_below_the_thing(rooms):
    for room in rooms[:3]:
        scene = truth_scene(room)
        for record in scene.entities[len(room.layout) :]:
            plane = scene.entity(record.parent).planes[record.support_plane]
            bottom = record.box.center[2] - record.box.size[2] / 2
            assert plane.normal[2] > 0.99
            assert -plane.offset == pytest.approx(float(bottom), abs=1e-5)


def test_the_dataset_frame_is_found_from_gravity_alone(rooms):
    for room in rooms:
        T, gravity = room.T_world_dataset, room.gravity_dataset
        np.testing.assert_allclose(T[:3, :3] @ gravity, [0, 0, -1], atol=1e-12)
        np.testing.assert_allclose(T, upright_from_gravity(gravity, T[2, 3]), atol=1e-12)
        np.testing.assert_allclose(T[:3, :3] @ T[:3, :3].T, np.eye(3), atol=1e-12)
        # The smallest rotation keeps what is perpendicular to both directions.
        axis = np.cross(gravity, [0, 0, -1])
        np.testing.assert_allclose(T[:3, :3] @ axis, axis, atol=1e-12)
        assert np.degrees(np.arccos(-gravity[2])) > 35


def test_the_same_seed_makes_the_same_room(library):
    first, second, other = (make_room(seed, furniture_library()) for seed in (2, 2, 3))
    assert [i.name for i in first.items] == [i.name for i in second.items]
    for a, b in zip(first.items, second.items, strict=True):
        np.testing.assert_array_equal(a.T_world_cad, b.T_world_cad)
        np.testing.assert_array_equal(a.tint, b.tint)
    assert not np.array_equal(first.size, other.size)


def test_four_classes_are_enough():
    cups, cabinets = block_model("cup/a", (0.08, 0.08, 0.1)), cabinet_model()
    room = make_room(1, library_of(table_model(), chair_model(), cabinets, cups))
    assert max(room.support_depth(item.name) for item in room.items) == 2


def test_a_library_without_chairs_is_refused():
    with pytest.raises(LibraryError, match="chair"):
        make_room(0, library_of(table_model(), cabinet_model(), block_model("cup/a", (0.1,) * 3)))


def test_cut_edges_keeps_the_surface():
    mesh = box_mesh((1.2, 0.05, 0.7), spacing_m=10.0)
    fine = cut_edges(mesh.vertices, mesh.faces, 0.03)
    corners = fine.vertices[fine.faces]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    assert edges.max() <= 0.03 + FLOAT32_M
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = 2 * (1.2 * 0.05 + 1.2 * 0.7 + 0.05 * 0.7)
    assert np.linalg.norm(cross, axis=1).sum() / 2 == pytest.approx(area, rel=1e-4)
    volume = np.einsum("fi,fi->f", corners[:, 0], cross).sum() / 6
    assert volume == pytest.approx(1.2 * 0.05 * 0.7, rel=1e-4)  # still closed, windings kept
    # A halving per edge at most: long thin parts do not explode.
    assert len(fine.faces) < 20 * area / 0.03**2


def test_instances_of_one_model_differ_in_colour(rooms):
    chairs = [i for i in rooms[0].items if i.model.class_name == "chair"]
    tints = np.array([chair.tint for chair in chairs])
    assert np.abs(tints[0] - tints[1]).max() > 0.01


def test_settings_of_the_room_are_frozen(rooms):
    with pytest.raises(dataclasses.FrozenInstanceError):
        rooms[0].seed = 5


def test_the_open_surface_leaves_out_what_no_view_shows():
    """A hollow box with a shelf inside: the shelf and the inner faces go, the outer stay."""
    wall = 0.02
    shell = [
        ((1.0, wall, 1.0), (0, -0.49, 0)),
        ((1.0, wall, 1.0), (0, 0.49, 0)),
        ((wall, 0.96, 1.0), (-0.49, 0, 0)),
        ((wall, 0.96, 1.0), (0.49, 0, 0)),
        ((0.96, 0.96, wall), (0, 0, -0.49)),
        ((0.96, 0.96, wall), (0, 0, 0.49)),
    ]
    shelf = ((0.96, 0.96, wall), (0, 0, 0.0))
    model = parts_model("cabinet/hollow", "cabinet", [*shell, shelf])
    vertices = np.concatenate([
        mesh.vertices[np.unique(mesh.faces)] for mesh, _ in exterior_parts(model)
    ])  # fmt: skip
    assert np.abs(vertices).max(1).min() > 0.49
    planes = model.planes
    outer = np.abs(-planes.offset - 0.5) < 1e-5
    seen = open_planes(model)
    assert np.all(seen[outer & (planes.area_m2 > 0.9)])
    inner = (planes.offset + 0.5 > 0.015) & (planes.area_m2 > 0.5)
    assert inner.sum() >= 7 and not seen[inner].any()


def test_open_shelves_are_seen_and_carry(rooms):
    model = bookshelf_model()
    shelves = carrying_planes(model)
    assert len(shelves) == 4 and open_planes(model)[shelves].all()
    standing = [i for room in rooms for i in room.items if (i.parent or "").startswith("bookshelf")]
    assert len(standing) >= len(rooms)
    assert max(i.center[2] for i in standing) < 1.5  # in reach, and in sight


@pytest.mark.slow
def test_the_builtin_room_is_seen_whole():
    """With the package's library: three supports deep, articulated, nothing hidden on the walk."""
    room = builtin_room(default_library())
    depth = {item.name: room.support_depth(item.name) for item in room.items}
    assert max(depth.values()) == 3 and any(i.model.articulated for i in room.items)
    film = Film(room, default_camera(160, 120), NoiseModel(), 0)
    path = camera_path(room, 120, 0)
    seen = joined([film.shoot(i, pose).seen for i, pose in enumerate(path)])
    for item in room.items:
        cells = np.floor(open_surface(item, 0.01).mesh.vertices / SURFACE_GRID_M)
        share = np.sum(seen.instance == item.id) / len(np.unique(cells, axis=0))
        # Backs stand before walls and undersides are never seen: a third is much.
        assert share > 0.08, (item.name, share)
