"""Made rooms: nothing touches what does not carry it, and the truth is true."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from isr_jax.borders.raycast import RayScene
from isr_jax.cad import default_library
from isr_jax.errors import LibraryError, SettingError
from isr_jax.geometry import convex_part, depth_inside
from isr_jax.library import CadLibrary
from isr_jax.robot_model import link_transforms
from isr_jax.scene_file import ROOM_NAME, read_scene, write_scene
from isr_jax.synthetic import (
    NoiseModel,
    Room,
    builtin_room,
    make_room,
    true_entities,
    truth_scene,
)
from isr_jax.synthetic.camera.walk import camera_path
from isr_jax.synthetic.cutting import cut_edges
from isr_jax.synthetic.exterior import exterior_parts, open_planes
from isr_jax.synthetic.film.film import SURFACE_GRID_M, Film, joined
from isr_jax.synthetic.film.render import default_camera
from isr_jax.synthetic.furnishing.placement import MARGIN_M, overlap_depths
from isr_jax.synthetic.furnishing.tops import carrying_planes
from isr_jax.synthetic.room import ROOM_KINDS, upright_from_gravity
from isr_jax.synthetic.surface import open_surface
from isr_jax.types import Entities, Mesh

from .builders import box_mesh, library_of, parts_model, table_model
from .furniture import block_model, bookshelf_model, cabinet_model, chair_model, furniture_library

SEEDS = range(5)
FLOAT32_M = 4e-6
"""Roundings of coordinates of a few metres, a few times over."""
CONTACT_M = 1e-4
KIT_SEED = 3
MUST: dict[str, tuple[set[str], ...]] = {
    "kitchen": ({"table"}, {"chair"}, {"counter", "cabinet"}),
    "office": ({"desk"}, {"chair"}),
    "living": ({"sofa"},),
    "bedroom": ({"bed"},),
    "meeting": ({"table"}, {"chair"}),
}
"""At least one of each set."""


@pytest.fixture(scope="module")
def library() -> CadLibrary:
    return furniture_library()


@pytest.fixture(scope="module")
def rooms(library: CadLibrary) -> list[Room]:
    """Of a few plain models, kinds as the seeds draw them."""
    return [make_room(seed, library) for seed in SEEDS]


@pytest.fixture(scope="module")
def kit_rooms() -> dict[str, Room]:
    """One of each kind, of the package's own library."""
    library = default_library()
    return {kind: make_room(KIT_SEED, library, kind=kind) for kind in ROOM_KINDS}


@pytest.fixture(scope="module")
def every(rooms: list[Room], kit_rooms: dict[str, Room]) -> list[Room]:
    return [*rooms, *kit_rooms.values()]


@pytest.fixture(scope="module")
def entities(rooms: list[Room]) -> list[Entities]:
    return [true_entities(room) for room in rooms[:2]]


def test_boxes_keep_their_margin(every):
    """But for what carries, what leans on or near its host, and seats under tables."""
    for room in every:
        depth = overlap_depths([i.box for i in room.items], [i.box for i in room.items])
        for a, first in enumerate(room.items):
            for b, second in enumerate(room.items[:a]):
                pair = {first.attachment, second.attachment}
                if _carries(room, first, second) or _carries(room, second, first):
                    continue
                if "leaning" in pair or _tucked(room, first, second):
                    continue
                assert depth[a, b] <= -MARGIN_M + 1e-5, (room.name, first.name, second.name)


def _carries(room, upper, lower) -> bool:
    """``lower`` carries ``upper``, directly or not."""
    by_name = {item.name: item for item in room.items}
    while upper.parent in by_name:
        if upper.parent == lower.name:
            return True
        upper = by_name[upper.parent]
    return False


def _tucked(room, first, second) -> bool:
    """A seat, and a table, a desk, or what stands on them."""
    for seat, other in ((first, second), (second, first)):
        if seat.model.class_name in ("chair", "stool") and (
            other.model.class_name in ("table", "desk")
            or any(
                _carries(room, other, host)
                for host in room.items
                if host.model.class_name in ("table", "desk")
            )
        ):
            return True
    return False


def test_where_boxes_overlap_no_surface_reaches_into_the_other(kit_rooms):
    """Points of either surface against the convex parts of the other, which the kit states."""
    overlaps = 0
    for room in kit_rooms.values():
        depth = overlap_depths([i.box for i in room.items], [i.box for i in room.items])
        for a, b in np.argwhere(np.triu(depth > 1e-5, 1)):
            first, second = room.items[a], room.items[b]
            overlaps += _tucked(room, first, second)
            for one, other in ((first, second), (second, first)):
                points = one.to_world(one.model.samples.points)
                deepest = max(depth_inside(part, points).max() for part in _parts(other))
                assert deepest < 5e-4, (room.kind, one.name, other.name, deepest)
    assert overlaps >= 5  # seats are really pushed under


def _parts(item):
    poses = link_transforms(item.model.robot)
    for link in item.model.robot.links:
        for hull in link.hulls:
            moved = hull.vertices @ poses[link.name][:3, :3].T + poses[link.name][:3, 3]
            yield convex_part(item.to_world(moved))


def test_everything_is_carried_or_fixed_or_leans(every):
    for room in every:
        names = {room.layout[0].name, *(item.name for item in room.items)}
        for item in room.items:
            if item.attachment == "none":
                assert item.parent in names and item.parent_plane is not None
            else:
                assert item.parent is None and item.parent_plane is None
                assert item.attachment in ("wall", "hanging", "leaning")
        assert any(item.attachment == "leaning" for item in room.items) or room in every[:5]


def test_things_stand_exactly_on_the_plane_that_carries_them(every):
    for room in every:
        by_name = {item.name: item for item in room.items}
        for item in (i for i in room.items if i.parent is not None):
            bottom = item.center[2] - item.scale * item.model.size[2] / 2
            lowest = item.to_world(item.model.mesh.vertices)[:, 2].min()
            height = 0.0
            if item.parent in by_name:
                carrier = by_name[item.parent]
                corners = carrier.model.planes.corners[item.parent_plane]
                height = carrier.to_world(corners)[:, 2].mean()
            assert bottom == pytest.approx(height, abs=FLOAT32_M)
            assert lowest == pytest.approx(height, abs=CONTACT_M)


def test_footprints_lie_on_the_surface_that_carries_them(every):
    """Rays straight down from points of the footprint meet the carrier at once, and nothing else:
    on a round table too, whose rectangle is larger than its top."""
    share = np.linspace(-0.5, 0.5, 5)
    grid = np.stack([g.ravel() for g in np.meshgrid(share, share)], 1)
    for room in every:
        by_name = {item.name: item for item in room.items}
        for item in (i for i in room.items if i.parent in by_name):
            carrier = by_name[item.parent]
            surface = Mesh(carrier.to_world(carrier.model.mesh.vertices), carrier.model.mesh.faces)
            local = item.scale * item.model.size * np.insert(grid, 2, -0.5, axis=1)
            points = local @ item.T_world_cad[:3, :3].T + item.center + [0, 0, 0.001]
            hits = RayScene([surface], [1]).cast(points, np.tile([0.0, 0, -1], (len(points), 1)))
            assert np.abs(hits.distance - 0.001).max() < CONTACT_M, (item.name, carrier.name)


@pytest.mark.parametrize("kind", ROOM_KINDS)
def test_each_kind_holds_what_makes_it_one(kit_rooms, kind):
    room = kit_rooms[kind]
    classes = [item.model.class_name for item in room.items]
    assert room.kind == kind
    assert all(set(classes) & wanted for wanted in MUST[kind])
    assert 28 <= len(classes) <= 70
    assert max(room.support_depth(item.name) for item in room.items) == 3
    assert sum(item.attachment == "leaning" for item in room.items) >= 1
    assert "other" not in classes and "toilet" not in classes


def test_seats_of_a_meeting_stand_on_both_long_sides(kit_rooms):
    room = kit_rooms["meeting"]
    table = next(i for i in room.items if i.model.class_name == "table")
    short = int(np.argmin(table.model.size[:2]))
    chairs = [i for i in room.items if i.model.class_name == "chair"]
    across = [
        float((chair.center - table.center) @ table.T_world_cad[:3, short]) for chair in chairs
    ]
    near = [a for a in across if abs(a) < 1.2]
    assert sum(a > 0.2 for a in near) >= 2 and sum(a < -0.2 for a in near) >= 2


def test_rooms_hold_what_they_promise(every):
    for room in every:
        ids = [p.id for p in room.layout] + [i.id for i in room.items]
        assert ids == list(range(1, len(ids) + 1)) and len(room.items) >= 8
        assert max(room.support_depth(item.name) for item in room.items) == 3
        assert all(0.9 <= item.scale <= 1.1 for item in room.items)
        assert all(
            set(room_classes) & wanted
            for wanted in MUST[room.kind]
            for room_classes in [[i.model.class_name for i in room.items]]
        )


def test_everything_stands_between_the_walls(every):
    """What stands free keeps 2 cm; what is fixed or leans may touch; frames are in their walls."""
    for room in every:
        for item in (i for i in room.items if i.model.mount != "opening"):
            least = MARGIN_M if item.attachment == "none" else 0.0
            points = item.to_world(item.model.mesh.vertices)
            for patch in room.layout[1:]:
                gap = (points - patch.corners[0]) @ patch.normal
                least_here = 0.0 if patch.class_name == "ceiling" else least
                assert gap.min() >= least_here - 1e-4, (room.name, item.name, patch.name)


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
            assert record.attachment == item.attachment
            np.testing.assert_allclose(record.cad.T_world_cad, item.T_world_cad, atol=1e-6)
            assert record.type == ("articulated" if item.model.articulated else "rigid")
        assert all(scene.entity(p.name).parent == ROOM_NAME for p in room.layout)
        # Without seats under tables and things that lean, no boxes overlap.
        may = ("chair", "stool", "book")
        assert all(a.startswith(may) or b.startswith(may) for a, b, _ in scene.proximal)


def test_the_support_plane_of_the_truth_is_below_the_thing(rooms):
    for room in rooms[:3]:
        scene = truth_scene(room)
        for record in (r for r in scene.entities[len(room.layout) :] if r.attachment == "none"):
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


def test_four_classes_are_enough_and_notes_say_what_is_missing():
    cups, cabinets = block_model("cup/a", (0.08, 0.08, 0.1)), cabinet_model()
    room = make_room(1, library_of(table_model(), chair_model(), cabinets, cups), kind="kitchen")
    assert max(room.support_depth(item.name) for item in room.items) == 2
    assert {item.model.class_name for item in room.items} == {"table", "chair", "cabinet", "cup"}
    lacking = next(note for note in room.notes if note.startswith("the library has nothing for"))
    assert "fridge" in lacking and "dining chair" not in lacking


def test_a_library_without_chairs_is_refused():
    with pytest.raises(LibraryError, match="chair"):
        make_room(0, library_of(table_model(), cabinet_model(), block_model("cup/a", (0.1,) * 3)))


def test_a_kind_that_the_library_cannot_furnish_is_refused(library):
    with pytest.raises(LibraryError, match="bed"):
        make_room(0, library, kind="bedroom")
    with pytest.raises(SettingError, match="living"):
        make_room(0, library, kind="ballroom")


def test_the_builtin_room_shows_every_rule():
    room = builtin_room(default_library())
    held = {item.model.class_name for item in room.items}
    assert held >= {"fridge", "oven", "wall_cabinet", "table", "chair", "desk", "book", "cup"}
    assert {"none", "wall", "leaning"} <= {item.attachment for item in room.items}
    assert 30 <= len(room.items) <= 46
    assert any(item.model.articulated for item in room.items)


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
    vertices = np.concatenate(
        [mesh.vertices[np.unique(mesh.faces)] for mesh, _ in exterior_parts(model)]
    )
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
