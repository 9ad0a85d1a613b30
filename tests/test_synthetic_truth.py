"""The truth about a room: openings, planes, supports, joints and parts, against hand-made cases."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from isr_jax.borders.raycast import RayScene
from isr_jax.cad import default_library
from isr_jax.classes import class_named
from isr_jax.config import ExportSettings
from isr_jax.errors import OutputError
from isr_jax.export.bodies import scene_bodies
from isr_jax.export.hull_meshes import part_of
from isr_jax.export.slabs import slab_part, slabs_of
from isr_jax.geometry import box_corners, moved_part, penetration
from isr_jax.robot_model import Texture, link_transforms
from isr_jax.scene_file import ROOM_NAME, read_scene
from isr_jax.synthetic import Room, make_room, true_entities, true_graph, true_placements
from isr_jax.synthetic.film.film import SeenSurface
from isr_jax.synthetic.furnishing.shell import DOOR_CLEAR_M, make_shell
from isr_jax.synthetic.furnishing.stock import Stock
from isr_jax.synthetic.openings import (
    JOINT_M,
    rectangle_corners,
    solid_mesh,
    solid_rectangles,
)
from isr_jax.synthetic.room import LayoutPatch
from isr_jax.synthetic.surface import first_parts, layout_surface, room_parts, whole_surface
from isr_jax.synthetic.truth import scene_of_entities
from isr_jax.synthetic.truth_files import joint_records, room_record, write_truth
from isr_jax.types import ROOM, UNSUPPORTED, PlaneSet

from .builders import library_of, table_model
from .furniture import block_model, cabinet_model
from .hand_made_rooms import LAYOUT, placed, room_with

WALL = LayoutPatch(
    2,
    "wall",
    np.array([(0, 0, 0), (4, 0, 0), (4, 0, 2.5), (0, 0, 2.5)], np.float32),
    np.array([(1, 0, 2, 2), (2.5, 0.9, 3.5, 2.1)], np.float32),
)
"""4 m by 2.5 m, normal -y, with a doorway and a window."""
EXACT_M = 1e-5


@pytest.fixture(scope="module")
def room() -> Room:
    """Of the package's models: doors, windows, what stands on the floor, and on that."""
    whole = make_room(1, default_library())
    layout = {patch.name for patch in whole.layout}
    low = [item for item in whole.items if item.parent in (None, *layout)]
    upper = [item for item in whole.items if item not in low][-10:]
    carriers = {whole.item(i.parent).parent for i in upper if i.parent} | {i.parent for i in upper}
    kept = [i for i in whole.items if i in low or i in upper or i.name in carriers]
    return dataclasses.replace(whole, items=tuple(kept))


def mesh_area(mesh) -> float:
    corners = mesh.vertices[mesh.faces].astype(np.float64)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(np.linalg.norm(cross, axis=1).sum() / 2)


def test_a_wall_less_its_openings_is_these_rectangles():
    """Piers of 1, 0.5 and 0.5 m, a lintel over the door, wall below and above the window."""
    expected = {
        (0.0, 0.0, 1.0, 2.5): 2.5,
        (2.0, 0.0, 2.5, 2.5): 1.25,
        (3.5, 0.0, 4.0, 2.5): 1.25,
        (2.5, 0.0, 3.5, 0.9): 0.9,
        (1.0, 2.0, 2.0, 2.5): 0.5,
        (2.5, 2.1, 3.5, 2.5): 0.4,
    }
    found = solid_rectangles(WALL)
    assert {tuple(np.round(r.astype(float), 5).tolist()) for r in found} == set(expected)
    area = np.prod(found[:, 2:] - found[:, :2], axis=1)
    np.testing.assert_allclose(area, sorted(expected.values(), reverse=True), atol=1e-6)
    assert area.sum() == pytest.approx(4 * 2.5 - 1 * 2 - 1 * 1.2, abs=1e-5)


def test_a_wall_without_openings_is_one_rectangle():
    plain = dataclasses.replace(WALL, openings=np.zeros((0, 4), np.float32))
    np.testing.assert_allclose(solid_rectangles(plain), [[0, 0, 4, 2.5]])
    np.testing.assert_allclose(
        rectangle_corners(plain, solid_rectangles(plain)[0]), plain.corners, atol=1e-6
    )


def test_openings_side_by_side_share_the_lintel():
    """Two doorways of one height that touch are one gap below one lintel."""
    twin = np.array([(1, 0, 2, 2), (2, 0, 3, 2)], np.float32)
    found = solid_rectangles(dataclasses.replace(WALL, openings=twin))
    assert {tuple(np.round(r.astype(float), 5).tolist()) for r in found} == {
        (0, 0, 1, 2.5),
        (3, 0, 4, 2.5),
        (1, 2, 3, 2.5),
    }


@pytest.mark.parametrize("spacing_m", [np.inf, 0.3])
def test_the_mesh_of_a_wall_has_its_area_and_no_cracks(spacing_m):
    """Free edges: the outline less the door's base, and the outlines of both openings."""
    mesh = solid_mesh(WALL, spacing_m, 0.0)
    assert mesh_area(mesh) == pytest.approx(6.8, abs=1e-4)
    assert mesh.normals is not None and np.allclose(mesh.normals, [0, -1, 0])
    edges = np.sort(np.concatenate([mesh.faces[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    distinct, count = np.unique(edges, axis=0, return_counts=True)
    free = mesh.vertices[distinct[count == 1]]
    length = np.linalg.norm(free[:, 0] - free[:, 1], axis=1).sum()
    assert length == pytest.approx(2 * (4 + 2.5) - 1 + (2 + 1 + 2) + 2 * (1 + 1.2), abs=1e-3)
    assert count.max() == 2


def test_reveals_add_the_sides_of_the_openings():
    """Door: two jambs of 2 m and a head of 1 m; window: 2 x 1.2 m and 2 x 1 m; all 0.12 deep."""
    mesh = solid_mesh(WALL, 0.3, 0.12)
    assert mesh_area(mesh) == pytest.approx(6.8 + 0.12 * (5 + 4.4), abs=1e-4)
    corners, normals = mesh.vertices[mesh.faces], mesh.normals
    assert normals is not None
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.all(np.sum(cross * normals[mesh.faces[:, 0]], axis=1) > 0)
    assert mesh.vertices[:, 1].max() == pytest.approx(0.12, abs=1e-6)  # outwards: +y


def test_a_ray_through_a_bare_opening_meets_nothing():
    scene = RayScene([layout_surface(WALL, np.inf, 0.12).mesh], [2])
    origins = np.array([(1.5, -3, 1), (0.5, -3, 1), (3.0, -3, 1.5), (3.0, -3, 0.5)])
    hits = scene.cast(origins, np.tile([0.0, 1.0, 0.0], (4, 1)))
    assert hits.instance.tolist() == [0, 2, 0, 2]
    np.testing.assert_allclose(hits.distance, [0, 3, 0, 3], atol=EXACT_M)
    # From (1.9, -0.1) along (0.5, 1): x is 1.95 at y = 0, still open; the jamb, 5 mm of filled
    # joint before x = 2, is met 0.095 / 0.5 = 0.19 on.
    slanted = scene.cast(np.array([(1.9, -0.1, 1)]), np.array([(0.5, 1.0, 0.0)]))
    assert slanted.distance[0] == pytest.approx(0.19, abs=EXACT_M)
    np.testing.assert_allclose(slanted.normal[0], [-1, 0, 0], atol=1e-6)


def test_doors_and_windows_fill_their_openings():
    library = default_library()
    filled = 0
    for seed in range(12):
        rng = np.random.default_rng(seed)
        size = np.array([4.5, 3.8, 2.5])
        shell = make_shell(size, Stock(library, rng), rng, ceiling=True)
        assert [p.id for p in shell.layout] == list(range(1, 7))
        assert shell.layout[0].class_name == "floor"
        openings = [(p, o) for p in shell.layout for o in p.openings]
        assert 1 <= len(openings) <= 4 and len(shell.zones) == len(openings)
        for item in shell.items:
            front = item.center + item.R_room @ [0, -item.scale * item.model.size[1] / 2, 0]
            wall = min(shell.layout[1:5], key=lambda p: abs((front - p.corners[0]) @ p.normal))
            assert abs((front - wall.corners[0]) @ wall.normal) < EXACT_M  # flush
            np.testing.assert_allclose(item.R_room @ [0, -1, 0], wall.normal, atol=1e-6)
            half = item.scale * item.model.size[[0, 2]] / 2
            base = wall.corners[1] - wall.corners[0]
            at = np.array(
                [(item.center - wall.corners[0]) @ base / np.linalg.norm(base), item.center[2]]
            )
            rectangle = np.array([*(at - half - JOINT_M), *(at + half + JOINT_M)])
            if item.model.class_name == "door":
                assert at[1] == pytest.approx(half[1], abs=EXACT_M)
                rectangle[1] = 0.0
            assert np.abs(wall.openings - rectangle).max(1).min() < EXACT_M
            filled += 1
        for zone in shell.zones:
            inside = np.abs(box_corners(zone)[:, :2]) <= size[:2] / 2 + EXACT_M
            assert inside.all() and zone.size[1] <= DOOR_CLEAR_M + EXACT_M
    assert filled >= 18


def test_a_library_without_doors_leaves_a_bare_doorway():
    for seed in range(8):
        rng = np.random.default_rng(seed)
        stock = Stock(library_of(table_model()), rng)
        shell = make_shell(np.array([4.0, 4.0, 2.4]), stock, rng, ceiling=False)
        assert len(shell.layout) == 5 and not shell.items
        assert 1 <= sum(len(p.openings) for p in shell.layout) <= 2
        assert all(opening[1] == 0 for p in shell.layout for opening in p.openings)
        assert "no model of class door for an opening" in shell.notes
        assert "no model of class window for an opening" in shell.notes


def test_a_wall_with_openings_has_a_plane_for_each_rectangle(room):
    entities = {entity.name: entity for entity in true_entities(room, spacing_m=0.2)}
    assert any(len(patch.openings) for patch in room.layout)
    for patch in room.layout:
        entity = entities[patch.name]
        assert len(entity.planes.area_m2) == len(solid_rectangles(patch)) <= 8
        assert entity.planes.area_m2[0] == entity.planes.area_m2.max()
        flat = mesh_area(layout_surface(patch, 0.2).mesh)
        assert entity.planes.area_m2.sum() == pytest.approx(flat, rel=1e-4)
        assert (mesh_area(entity.mesh) > flat + 0.01) == (len(patch.openings) > 0)
        heights = np.einsum("pi,pci->pc", entity.planes.normal, entity.planes.corners)
        assert np.abs(heights + entity.planes.offset[:, None]).max() < EXACT_M


def test_slabs_leave_openings_free(room):
    """A door in its opening overlaps no slab of its wall, which one slab per wall could not do."""
    entities = true_entities(room, spacing_m=1.0, with_stuff=True)
    graph, placements = true_graph(room, entities), true_placements(room, entities)
    library = default_library()
    slabs, bodies = scene_bodies(entities, graph, placements, library, ExportSettings())
    filling = [b for b in bodies if class_named(b.name.rsplit("_", 1)[0]).mount == "opening"]
    assert 2 <= len(filling) <= sum(len(patch.openings) for patch in room.layout)
    walls = [slab for slab in slabs if slab.class_name == "wall"]
    poses = [(body, link_transforms(body.robot)) for body in filling]
    hulls = [
        moved_part(part_of(hull), body.T_world_root @ pose[link.name])
        for body, pose in poses
        for link in body.robot.links
        for hull in link.hulls
    ]
    assert max(penetration(a, slab_part(s))[0] for a in hulls for s in walls) == 0.0
    plain = dataclasses.replace(room.layout[0], class_name="floor")
    assert [s.name for s in slabs if s.entity_name == plain.name] == [plain.name]


def test_slabs_of_one_wall_are_named_and_share_its_scan():
    entities = true_entities(room_with(), spacing_m=0.5)
    wall = dataclasses.replace(
        entities[1], planes=_planes_of(WALL), mesh=layout_surface(WALL, 0.5).mesh
    )
    slabs = slabs_of(wall, ExportSettings(), np.zeros((0, 3)))
    ends = ("", "_b", "_c", "_d", "_e", "_f")
    assert [s.name for s in slabs] == [f"{wall.name}{end}" for end in ends]
    assert {s.entity_name for s in slabs} == {wall.name}
    for slab in slabs:
        assert mesh_area(slab.scan) == pytest.approx(slab.size[0] * slab.size[1], rel=1e-4)
    many = np.stack([(0.1 * k, 0, 0.1 * k + 0.05, 2) for k in range(30)]).astype(np.float32)
    split = dataclasses.replace(wall, planes=_planes_of(dataclasses.replace(WALL, openings=many)))
    names = [s.name for s in slabs_of(split, ExportSettings(), np.zeros((0, 3)))]
    assert len(set(names)) == len(names) == 60
    assert names[25:28] == [f"{wall.name}{end}" for end in ("_z", "_ba", "_bb")]


def test_a_door_that_was_found_cuts_its_opening_into_a_wall_seen_whole():
    """Area by hand: the wall less the door and 5 mm on three sides (it stands at v = 0)."""
    whole = dataclasses.replace(WALL, openings=np.zeros((0, 4), np.float32))
    wall = dataclasses.replace(
        true_entities(room_with(), spacing_m=0.5)[1],
        planes=_planes_of(whole),
        mesh=layout_surface(whole, 0.5).mesh,
    )
    (slab,) = slabs_of(wall, ExportSettings(), np.zeros((0, 3)))
    inside = [(u, v, z) for u in (0.5, 1.4) for v in (0.0, 2.0) for z in (-0.04, 0.03)]
    corner = slab.T_world_slab @ np.array([*(-slab.size[:2] / 2), slab.size[2] / 2, 1.0])
    door = np.array(inside) @ slab.T_world_slab[:3, :3].T + corner[:3]
    parts = slabs_of(wall, ExportSettings(), np.zeros((0, 3)), [door])
    left = sum(float(s.size[0] * s.size[1]) for s in parts)
    assert left == pytest.approx(float(slab.size[0] * slab.size[1]) - 0.91 * 2.005, abs=1e-5)
    assert all(len(s.scan.faces) for s in parts)
    flush = door + 0.492 * slab.T_world_slab[:3, 0] * -1  # 3 mm of wall are left at its side
    widths = [s.size[0] for s in slabs_of(wall, ExportSettings(), np.zeros((0, 3)), [flush])]
    assert min(widths) > 0.5
    before = door + 0.2 * slab.T_world_slab[:3, 2]
    assert len(slabs_of(wall, ExportSettings(), np.zeros((0, 3)), [before])) == 1


def _planes_of(patch: LayoutPatch):
    room = dataclasses.replace(room_with(), layout=(patch,))
    return true_entities(room, spacing_m=1.0)[0].planes


def test_the_true_graph_has_the_parents_of_the_room(room):
    entities = true_entities(room, spacing_m=1.0)
    graph = true_graph(room, entities)
    names = [entity.name for entity in entities]
    assert names == [p.name for p in room.layout] + [item.name for item in room.things]
    for i, entity in enumerate(entities):
        if entity.is_layout:
            assert graph.parent[i] == ROOM and graph.support_plane[i] == -1
            continue
        item = room.item(entity.name)
        parent = None if graph.parent[i] == UNSUPPORTED else names[graph.parent[i]]
        assert parent == item.parent and graph.attachment[i] == item.attachment
        assert (graph.score[i] > 0) == (item.parent is not None)
        if parent is not None:
            plane = entities[int(graph.parent[i])].planes
            bottom = float(entity.box.center[2] - entity.box.size[2] / 2)
            assert -plane.offset[graph.support_plane[i]] == pytest.approx(bottom, abs=1e-4)
    for i in range(len(names)):  # every chain ends: no cycle
        chain = [i]
        while graph.parent[chain[-1]] >= 0:
            chain.append(int(graph.parent[chain[-1]]))
            assert len(chain) == len(set(chain))


def test_stuff_is_no_entity_and_carries_for_what_stands_on_it():
    """A cup on a rug stands on the floor, which carries the rug."""
    rug = placed(2, block_model("rug/a", (1.0, 1.0, 0.01)), (0, 0, 0.005), "floor_1")
    cup = placed(3, block_model("cup/a", (0.08, 0.08, 0.1)), (0, 0, 0.06), "rug_2")
    room = room_with(rug, cup)
    entities = true_entities(room, spacing_m=1.0)
    names = [entity.name for entity in entities]
    assert "rug_2" not in names
    graph = true_graph(room, entities)
    assert names[graph.parent[names.index("cup_3")]] == "floor_1"
    assert graph.support_plane[names.index("cup_3")] == 0
    with_stuff = true_entities(room, spacing_m=1.0, with_stuff=True)
    names = [entity.name for entity in with_stuff]
    graph = true_graph(room, with_stuff)
    assert names[graph.parent[names.index("cup_3")]] == "rug_2"


def test_boxes_that_overlap_without_carrying_are_proximal():
    """A chair pushed 0.2 m under a table: their boxes share 0.2 x 0.4 x 0.7 m."""
    table = placed(2, table_model(), (0, 0, 0.37), "floor_1")
    chair = placed(3, block_model("chair/a", (0.4, 0.4, 0.7)), (0, 0.4, 0.35), "floor_1")
    book = placed(4, block_model("book/a", (0.2, 0.2, 0.05)), (0, 0, 0.765), "table_2")
    room = room_with(table, chair, book)
    entities = true_entities(room, spacing_m=1.0)
    graph = true_graph(room, entities)
    named = [(entities[a].name, entities[b].name) for a, b in graph.proximal.tolist()]
    assert named == [("table_2", "chair_3")]
    assert graph.proximal_depth_m[0] == pytest.approx(0.2, abs=1e-5)
    scene = scene_of_entities(room, entities)
    assert scene.proximal[0][:2] == ("table_2", "chair_3")


def test_true_placements_are_the_models_without_error(room):
    entities = true_entities(room, spacing_m=1.0)
    for entity, placement in zip(entities, true_placements(room, entities), strict=True):
        assert placement.entity_id == entity.id
        if entity.is_layout:
            assert placement.cad_id is None and placement.reason == "layout"
            continue
        item = room.item(entity.name)
        assert placement.cad_id == item.model.id and placement.alignment_error_m == 0
        assert [candidate.cad_id for candidate in placement.candidates] == [item.model.id]
        np.testing.assert_array_equal(placement.T_world_cad, item.T_world_cad)
        np.testing.assert_array_equal(placement.scale, np.full(3, item.scale, np.float32))


def test_planes_of_what_leans_are_tilted_with_it():
    """A board of 0.6 x 0.02 x 0.8 m tilted by 0.3 rad about x: its front looks (0, -cos, sin)."""
    tilt = 0.3
    c, s = np.cos(tilt), np.sin(tilt)
    T = np.eye(4, dtype=np.float32)
    T[:3, :3] = [[1, 0, 0], [0, c, -s], [0, s, c]]
    T[:3, 3] = [0.5, 0.2, 0.4 * c + 0.01 * s]
    board = dataclasses.replace(
        placed(2, block_model("box/a", (0.6, 0.02, 0.8)), (0.0, 0.0, 0.0), None),
        T_world_cad=T,
        attachment="leaning",
    )
    room = room_with(board)
    entity = true_entities(room, spacing_m=0.1)[len(room.layout)]
    wanted = np.array([0, -c, -s])
    front = int(np.argmax(entity.planes.normal @ wanted))
    np.testing.assert_allclose(entity.planes.normal[front], wanted, atol=1e-6)
    # p . n for a point of the front: the centre's, and half the thickness.
    offset = -(T[:3, 3] @ wanted + 0.01)
    assert entity.planes.offset[front] == pytest.approx(offset, abs=1e-6)
    beyond = entity.mesh.vertices @ entity.planes.normal.T + entity.planes.offset
    assert beyond.max() < EXACT_M  # a convex thing lies behind all of its planes
    size = [0.6, 0.02 * c + 0.8 * s, 0.02 * s + 0.8 * c]
    np.testing.assert_allclose(np.sort(entity.box.size), np.sort(size), atol=1e-5)
    graph = true_graph(room, true_entities(room, spacing_m=1.0))
    row = len(room.layout)
    assert graph.parent[row] == UNSUPPORTED and graph.attachment[row] == "leaning"


def test_joints_in_the_world_move_links_as_the_robot_model_does(room):
    """Turning about the stated axis, or sliding along it, is where the model's own joint leads."""
    rng, kinds = np.random.default_rng(0), set()
    for item in room.items:
        rest = link_transforms(item.model.robot)
        for joint in joint_records(item):
            if joint["kind"] == "fixed":
                continue
            kinds.add(joint["kind"])
            low, high = joint["range"] or (-3.0, 3.0)
            at = rng.uniform(low, high)
            own = at / item.scale if joint["kind"] == "prismatic" else at
            moved = link_transforms(item.model.robot, {joint["name"]: own})
            points = rng.uniform(-0.5, 0.5, (5, 3))
            before, after = (
                item.to_world(points @ T[:3, :3].T + T[:3, 3])
                for T in (rest[joint["child"]], moved[joint["child"]])
            )
            np.testing.assert_allclose(_moved_by(joint, before, at), after, atol=1e-5)
    assert kinds >= {"revolute", "prismatic"}


def _moved_by(joint: dict, points: np.ndarray, at: float) -> np.ndarray:
    axis, anchor = np.array(joint["axis"]), np.array(joint["anchor"])
    if joint["kind"] == "prismatic":
        return points + at * axis
    arm = points - anchor  # Rodrigues' rotation formula
    return (
        anchor
        + arm * np.cos(at)
        + np.cross(axis, arm) * np.sin(at)
        + np.outer(arm @ axis, axis) * (1 - np.cos(at))
    )


def test_parts_are_links_in_one_order(room):
    parts, first = room_parts(room), first_parts(room)
    assert [part.id for part in parts] == list(range(1, len(parts) + 1))
    assert len(parts) == len(room.layout) + sum(len(i.model.robot.links) for i in room.items)
    for item in room.items:
        surface = whole_surface(item)
        assert len(surface.face_part) == len(surface.mesh.faces) == len(surface.face_rgb)
        for k, link in enumerate(item.model.robot.links):
            part = parts[first[item.id] + k - 1]
            assert (part.entity_id, part.link) == (item.id, link.name)
            faces = sum(len(visual.mesh.faces) for visual in link.visuals)
            assert np.sum(surface.face_part == k) == faces
    assert layout_surface(room.layout[0], np.inf).face_part.max() == 0


def test_textures_are_held_once_and_keep_their_corners():
    image = Texture("wood.png", b"not read here")
    item = placed(2, cabinet_model(), (0, 0, 0.43), "floor_1")
    links = list(item.model.robot.links)
    panel = links[1].visuals[0]
    uv = np.random.default_rng(0).random((len(panel.mesh.faces), 3, 2)).astype(np.float32)
    textured = dataclasses.replace(
        panel, mesh=dataclasses.replace(panel.mesh, uv=uv), texture=image
    )
    links[1] = dataclasses.replace(links[1], visuals=(textured, panel, textured))
    robot = dataclasses.replace(item.model.robot, links=tuple(links))
    model = dataclasses.replace(item.model, load_robot=lambda: robot)
    surface = whole_surface(dataclasses.replace(item, model=model))
    assert surface.textures == (image,) and surface.uv is not None
    assert surface.face_texture is not None
    plain = sum(len(visual.mesh.faces) for visual in links[0].visuals)
    n = len(panel.mesh.faces)
    expected = np.repeat([-1, 0, -1, 0], [plain, n, n, n])
    np.testing.assert_array_equal(surface.face_texture, expected)
    np.testing.assert_array_equal(surface.uv[expected == 0], np.concatenate([uv, uv]))
    assert whole_surface(item).uv is None


def test_the_truth_on_disk_says_what_the_room_is(room, tmp_path: Path):
    ids = [patch.id for patch in room.layout] + [item.id for item in room.items]
    points = np.zeros((len(ids), 3), np.float32)
    write_truth(room, tmp_path / "truth", SeenSurface(points, points, np.array(ids)))
    data = json.loads((tmp_path / "truth" / "room.json").read_text())
    assert data == json.loads(json.dumps(room_record(room)))
    assert (data["kind"], data["seed"]) == (room.kind, room.seed)
    assert {item["name"] for item in data["items"]} == {item.name for item in room.items}
    filled = {opening["item"] for opening in data["openings"]} - {None}
    mounted = {i.name for i in room.items if class_named(i.model.class_name).mount == "opening"}
    assert filled == mounted
    with np.load(tmp_path / "truth" / "observed.npz") as seen:
        names = [p.class_name for p in room.layout] + [i.model.class_name for i in room.items]
        assert seen["class_id"].tolist() == [class_named(name).id for name in names]
    parts = json.loads((tmp_path / "truth" / "parts.json").read_text())
    assert [(p["id"], p["entity"], p["link"]) for p in parts] == [
        dataclasses.astuple(part) for part in room_parts(room)
    ]
    scene = read_scene(tmp_path / "truth" / "scene.json")
    assert [e.name for e in scene.entities] == [
        *(patch.name for patch in room.layout),
        *(item.name for item in room.things),
    ]
    assert all((tmp_path / "truth" / e.mesh).is_file() for e in scene.entities if e.mesh)
    assert scene.entity("floor_1").parent == ROOM_NAME


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="file"):
        write_truth(room_with(), tmp_path / "file" / "truth")


def test_hand_made_layout_is_closed():
    """The helper's own room: floor, four walls; normals inwards."""
    for patch in LAYOUT:
        assert (np.array([0, 0, 1.0]) - patch.corners.mean(0)) @ patch.normal > 0.5


def test_a_model_without_planes_is_an_entity_without_planes():
    """Round imported things have no flat part."""
    block = block_model("vase/a", (0.1, 0.1, 0.2))
    none = PlaneSet(*(np.asarray(getattr(block.planes, f))[:0] for f in vars(block.planes)))
    bare = dataclasses.replace(
        block, planes=none, plane_link=(), plane_supporting=np.zeros(0, bool)
    )
    room = room_with(placed(2, bare, (0.0, 0.0, 0.1), "floor_1"))
    entities = true_entities(room, spacing_m=1.0)
    entity = entities[len(room.layout)]
    assert entity.planes.normal.shape == (0, 3) and entity.planes.corners.shape == (0, 4, 3)
    record = scene_of_entities(room, entities).entity("vase_2")
    assert record.planes == () and record.parent == "floor_1"
