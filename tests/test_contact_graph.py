"""Contact graph: parity with a slow twin, analytic scenes, and what must always hold."""

from __future__ import annotations

import dataclasses

import jax
import networkx as nx
import numpy as np
import pytest

from isr_jax.classes import class_named
from isr_jax.config import DEFAULT_SUPPORT, ContactGraphSettings, preset
from isr_jax.contact_graph import build_contact_graphs, to_networkx
from isr_jax.contact_graph.proximal import _depths
from isr_jax.contact_graph.scoring import _polygons, _scores, _vertices
from isr_jax.types import ROOM, UNSUPPORTED, Entities, Entity

from .builders import box_entity, box_mesh, box_planes, floor_entity, scene_of
from .reference import contact_graph_reference as slow

DEFAULT = ContactGraphSettings()
SEEN_ONLY = dataclasses.replace(DEFAULT, layout_whole_polygon=False)
SCORE = 2e-3
"""A vertex within rounding of a footprint's rim moves one side of a rectangle by one spacing cut
back to the footprint: only rounding of float32 remains, relative to sides of centimetres."""


def dense(entity: Entity) -> Entity:
    """With a vertex every 2 cm, as a map of that voxel size gives."""
    yaw = float(entity.box.yaw)
    mesh = box_mesh(entity.box.size, entity.box.center, yaw, spacing_m=0.02)
    return dataclasses.replace(entity, mesh=mesh)


def thing(id, class_name, center, size, yaw=0.0) -> Entity:
    return dense(box_entity(id, class_name, center, size, yaw))


def wall_entity(id=90) -> Entity:
    """The wall x = 0; its normal points into the room, towards +x."""
    return box_entity(id, "wall", (-0.05, 0, 1.25), (0.1, 4.0, 2.5), faces=(2,))


def ceiling_entity(id=91) -> Entity:
    return box_entity(id, "ceiling", (0, 0, 2.55), (5.0, 4.0, 0.1), faces=(1,))


def only(scene: Entities, settings=DEFAULT):
    return build_contact_graphs([scene], settings)[0]


def random_scene(seed: int, count: int = 8) -> Entities:
    """A floor and boxes thrown about in a small volume, so that many touch and overlap."""
    rng = np.random.default_rng(seed)
    names = ["table", "chair", "cup", "book", "cabinet", "wall_cabinet", "bin", "monitor"]
    items = [dense(floor_entity(1, (1.4, 1.2)))]
    for i in range(count):
        size = rng.uniform(0.06, 0.7, 3)
        on = items[rng.integers(len(items))].box
        base = on.center[2] + on.size[2] / 2 + rng.normal(0, 0.03)
        spread = np.minimum(0.6, on.size[:2] / 2)
        center = (*(on.center[:2] + rng.uniform(-1, 1, 2) * spread), base + size[2] / 2)
        items.append(thing(i + 2, str(rng.choice(names)), center, size, rng.uniform(-0.7, 0.7)))
    return scene_of(*items)


@pytest.mark.parametrize("settings", [DEFAULT, SEEN_ONLY], ids=["whole", "seen"])
@pytest.mark.parametrize("seed", range(4))
def test_agrees_with_twin(seed, settings):
    scene = random_scene(seed)
    graph, found = only(scene, settings), slow.supports(scene, settings)
    np.testing.assert_array_equal(graph.parent, [f[0] for f in found])
    np.testing.assert_array_equal(graph.support_plane, [f[1] for f in found])
    np.testing.assert_allclose(graph.score, [f[2] for f in found], atol=SCORE)
    box = graph.refined_box
    upright = np.stack([box.center[:, 2], box.size[:, 2]], 1)
    np.testing.assert_allclose(upright, slow.refined(scene, found), atol=1e-5)
    expected = slow.proximal(scene, graph)
    assert [tuple(pair) for pair in graph.proximal.tolist()] == list(expected)
    np.testing.assert_allclose(graph.proximal_depth_m, list(expected.values()), atol=1e-5)


def test_random_scenes_hold_supports_on_several_levels():
    """The scenes above mean something: things on floor, things on things, things on nothing."""
    parents = np.concatenate([only(random_scene(seed)).parent for seed in range(4)])
    assert np.sum(parents == 0) > 4 and np.sum(parents > 0) > 2 and np.sum(parents < -1) > 0


def test_scenes_together_are_scenes_alone():
    scenes = [random_scene(seed, count) for seed, count in ((0, 9), (1, 0), (2, 14), (3, 5))]
    scenes.append(Entities((), np.eye(4), 0.02))
    for together, scene in zip(build_contact_graphs(scenes, DEFAULT), scenes, strict=True):
        alone = only(scene)
        for field in dataclasses.fields(together):
            if field.name != "refined_box":
                np.testing.assert_array_equal(
                    getattr(together, field.name), getattr(alone, field.name)
                )
        np.testing.assert_array_equal(together.refined_box.center, alone.refined_box.center)


def test_no_scene_and_an_empty_scene():
    assert build_contact_graphs([], DEFAULT) == []
    graph = only(Entities((), np.eye(4), 0.02))
    assert len(graph.parent) == len(graph.proximal) == len(graph.refined_box.yaw) == 0


def stacked_scene() -> Entities:
    return scene_of(
        floor_entity(1),
        thing(2, "table", (0, 0, 0.37), (1.2, 0.8, 0.74), 0.3),
        thing(3, "book", (0.1, 0.1, 0.76), (0.2, 0.15, 0.04), 0.1),
        thing(4, "cup", (0.1, 0.1, 0.83), (0.08, 0.08, 0.1), 0.1),
        thing(5, "cup", (-0.3, 0.05, 0.79), (0.08, 0.08, 0.1)),
    )


def test_a_stack_on_a_table():
    graph = only(stacked_scene())
    np.testing.assert_array_equal(graph.parent, [ROOM, 0, 1, 2, 1])
    np.testing.assert_allclose(graph.score, [0, 1, 1, 1, 1], atol=0.02)
    np.testing.assert_array_equal(graph.children(1), [2, 4])
    assert set(graph.attachment) == {"none"} and len(graph.proximal) == 0


@pytest.mark.parametrize("seed", range(6))
def test_support_tree_has_no_cycle_and_every_edge_meets_the_paper(seed):
    scene = random_scene(seed, 16)
    graph = only(scene)
    tree = nx.DiGraph([(int(p), c) for c, p in enumerate(graph.parent) if p >= 0])
    assert nx.is_forest(tree)
    for child in np.flatnonzero(graph.parent >= 0).tolist():
        parent, k = int(graph.parent[child]), int(graph.support_plane[child])
        if k < 0:  # in furniture, on a board that was not seen
            assert not class_named(scene[parent].class_name).movable
            continue
        assert scene[parent].planes.normal[k, 2] >= DEFAULT_SUPPORT.up_cosine
        _, contact, _ = slow.terms(scene, scene[child], scene[parent], k, DEFAULT)
        assert contact >= DEFAULT_SUPPORT.min_contact - SCORE


def test_equal_boxes_in_one_place_make_no_cycle():
    cup = thing(3, "cup", (0, 0, 0.05), (0.1, 0.1, 0.1))
    twins = [dataclasses.replace(cup, id=i, name=f"cup_{i}") for i in (4, 5, 6)]
    graph = only(scene_of(floor_entity(1), *twins))
    np.testing.assert_array_equal(graph.parent, [ROOM, 0, 0, 0])
    assert len(graph.proximal) == 3


@pytest.mark.parametrize("yaw", [0.4, 1.9, -2.6])
def test_graph_follows_a_turn_of_the_world(yaw):
    """Turning about up and shifting sideways changes places, not relations."""
    base, moved = random_scene(5, 6), []
    turn, shift = slow.rotation_z(yaw), np.array([0.7, -1.1, 0.0])
    for entity in base:
        size, center = entity.box.size, turn @ entity.box.center + shift
        faces = (0,) if entity.is_layout else (0, 2, 3, 4, 5)
        yaw_here = yaw + float(entity.box.yaw)
        item = box_entity(entity.id, entity.class_name, center, size, yaw_here, faces)
        vertices = entity.mesh.vertices @ turn.T + shift
        mesh = dataclasses.replace(entity.mesh, vertices=vertices.astype(np.float32))
        moved.append(dataclasses.replace(item, mesh=mesh))
    before, after = only(base), only(scene_of(*moved))
    np.testing.assert_array_equal(before.parent, after.parent)
    np.testing.assert_allclose(before.score, after.score, atol=SCORE)
    np.testing.assert_array_equal(before.proximal, after.proximal)
    np.testing.assert_allclose(before.proximal_depth_m, after.proximal_depth_m, atol=1e-4)


def test_a_chair_whose_legs_were_not_seen_stands_on_the_floor():
    chair = thing(2, "chair", (0.5, 0.2, 0.7), (0.45, 0.45, 0.5))  # seen from 0.45 m up
    graph = only(scene_of(floor_entity(1), chair))
    assert graph.parent[1] == 0
    assert graph.score[1] == pytest.approx(0.55, abs=1e-4)
    assert graph.refined_box.center[1, 2] == pytest.approx(0.95 / 2, abs=1e-5)
    assert graph.refined_box.size[1, 2] == pytest.approx(0.95, abs=1e-5)  # top fixed


def tilted(entity: Entity, slope: float) -> Entity:
    """With its surface and planes[0] sheared about the middle of planes[0]: dz = slope dx."""
    planes, corners = entity.planes, np.array(entity.planes.corners)
    middle = corners[0].mean(0)
    corners[0, :, 2] += slope * (corners[0, :, 0] - middle[0])
    normal, offset = np.array(planes.normal), np.array(planes.offset)
    normal[0] = np.sign(normal[0, 2]) * np.array([-slope, 0, 1]) / np.sqrt(1 + slope**2)
    offset[0] = -normal[0] @ middle
    turned = dataclasses.replace(planes, normal=normal, offset=offset, corners=corners)
    vertices = np.array(entity.mesh.vertices)
    vertices[:, 2] += slope * (vertices[:, 0] - middle[0])
    mesh = dataclasses.replace(entity.mesh, vertices=vertices)
    return dataclasses.replace(entity, planes=turned, mesh=mesh)


@pytest.mark.parametrize(
    ("slope", "layout", "rise_m"), [(0.1, True, 0.0), (0.3, True, 0.15), (0.1, False, 0.05)]
)
def test_a_thing_is_carried_where_its_support_is_written(slope, layout, rise_m):
    """A floor that leans a little is written level; one that leans more, or a desk, as it is."""
    desk = thing(2, "desk", (0, 0, 0.35), (2.0, 2.0, 0.7))
    carrier = tilted(floor_entity(1) if layout else desk, slope)
    top = 0.0 if layout else 0.7
    cup = thing(3, "cup", (0.5, 0, top + rise_m + 0.05), (0.08, 0.08, 0.1))
    graph = only(scene_of(carrier, cup))
    assert graph.parent[1] == 0
    assert graph.support_height_m[1] == pytest.approx(top + rise_m, abs=1e-5)


@pytest.mark.parametrize("seed", range(4))
def test_what_is_carried_stands_at_its_support_height(seed):
    graph = only(random_scene(seed))
    bottom = graph.refined_box.center[:, 2] - graph.refined_box.size[:, 2] / 2
    np.testing.assert_allclose(bottom, graph.support_height_m, atol=1e-6)


def test_a_table_top_alone_still_stands_on_the_floor_and_carries():
    top = thing(2, "table", (0, 0, 0.72), (1.2, 0.8, 0.05))
    cup = thing(3, "cup", (0.2, 0.1, 0.795), (0.08, 0.08, 0.1))
    graph = only(scene_of(floor_entity(1), top, cup))
    np.testing.assert_array_equal(graph.parent, [ROOM, 0, 1])
    assert graph.refined_box.size[1, 2] == pytest.approx(0.745, abs=1e-5)


def test_a_chair_pushed_under_a_table_does_not_stand_on_it():
    table = thing(2, "table", (0, 0, 0.37), (1.2, 0.8, 0.74))
    chair = thing(3, "chair", (0.1, 0.1, 0.65), (0.45, 0.45, 0.4))  # its bottom seen at 0.45 m
    assert only(scene_of(floor_entity(1), table, chair)).parent[2] == 0
    paper = preset("paper").contact_graph
    assert only(scene_of(floor_entity(1), table, chair), paper).parent[2] == 1  # S = 0.71


def test_a_cup_in_the_air_is_not_stretched_to_the_floor():
    cup = thing(2, "cup", (0, 0, 0.8), (0.08, 0.08, 0.1))
    graph = only(scene_of(floor_entity(1), cup))
    assert graph.parent[1] == UNSUPPORTED and graph.score[1] == 0
    np.testing.assert_array_equal(graph.refined_box.size[1], cup.box.size)


def test_less_than_half_the_bottom_is_no_support():
    def parent_at(x):
        desk = thing(2, "desk", (0, 0, 0.35), (1.0, 0.6, 0.7))
        return only(
            scene_of(desk, thing(3, "book", (x, 0, 0.72), (0.4, 0.3, 0.04))), DEFAULT
        ).parent[1]

    assert parent_at(0.45) == 0  # 62 % of it on the desk
    assert parent_at(0.58) == UNSUPPORTED  # 30 %


def test_a_flat_book_below_the_plane_by_noise_keeps_a_height():
    desk = thing(2, "desk", (0, 0, 0.35), (1.0, 0.6, 0.7))
    book = thing(3, "book", (0, 0, 0.68), (0.3, 0.2, 0.02))
    graph = only(scene_of(desk, book))
    assert graph.parent[1] == 0
    box = graph.refined_box
    assert box.size[1, 2] == pytest.approx(0.02, abs=1e-6)
    assert box.center[1, 2] - box.size[1, 2] / 2 == pytest.approx(0.7, abs=1e-5)


@pytest.mark.parametrize("side", [-1, 1])
def test_of_two_boards_at_one_height_the_one_below_carries(side):
    halves = [box_planes((0.5, 0.4, 0.8), (s * 0.25, 0, 0.4), faces=(0,)) for s in (-1, 1)]
    both = jax.tree.map(lambda *leaves: np.concatenate(leaves), *halves)
    shelf = dataclasses.replace(thing(2, "bookshelf", (0, 0, 0.4), (1.0, 0.4, 0.8)), planes=both)
    book = thing(3, "book", (side * 0.1, 0, 0.82), (0.3, 0.2, 0.04))
    graph = only(scene_of(floor_entity(1), shelf, book))
    assert graph.parent[2] == 1 and graph.support_plane[2] == (side > 0)


def test_a_floor_seen_only_in_part_carries_with_its_whole_polygon():
    floor = floor_entity(1, (2.0, 2.0))
    vertices = floor.mesh.vertices
    seen = vertices[:, 0] < -0.4
    keep = seen[floor.mesh.faces].all(1)
    mesh = dataclasses.replace(floor.mesh, faces=floor.mesh.faces[keep])
    mesh = dataclasses.replace(mesh, vertices=np.where(seen[:, None], vertices, vertices[0]))
    floor = dataclasses.replace(floor, mesh=mesh)
    sofa = thing(2, "sofa", (0.3, 0, 0.4), (1.0, 0.8, 0.8))
    assert only(scene_of(floor, sofa)).parent[1] == 0
    assert only(scene_of(floor, sofa), SEEN_ONLY).parent[1] == UNSUPPORTED


def test_a_coarse_modelled_table_top_carries_as_a_scanned_one():
    scene = stacked_scene()
    table = scene[1]
    coarse = box_mesh(table.box.size, table.box.center, float(table.box.yaw), spacing_m=10.0)
    items = [dataclasses.replace(table, mesh=coarse) if i == 1 else e for i, e in enumerate(scene)]
    np.testing.assert_array_equal(only(scene_of(*items)).parent, only(scene).parent)


def test_a_wall_cabinet_hangs_on_the_wall_also_above_a_counter():
    counter = thing(2, "counter", (0.3, 0, 0.45), (0.6, 2.0, 0.9))
    cabinet = thing(3, "wall_cabinet", (0.2, 0, 1.5), (0.38, 0.8, 0.7))
    graph = only(scene_of(floor_entity(1), counter, cabinet, wall_entity()))
    np.testing.assert_array_equal(graph.parent, [ROOM, 0, UNSUPPORTED, ROOM])
    assert graph.attachment == ("none", "none", "wall", "none")


def test_a_lamp_hangs_from_the_ceiling_and_a_far_one_from_nothing():
    near = thing(2, "lamp", (1.0, 0, 2.3), (0.2, 0.2, 0.3))
    far = thing(3, "lamp", (-1.0, 0, 1.5), (0.2, 0.2, 0.3))
    graph = only(scene_of(floor_entity(1), near, far, ceiling_entity()))
    assert graph.attachment == ("none", "hanging", "none", "none")


def test_what_counts_as_a_ceiling_follows_a_th():
    lamp = thing(2, "lamp", (0, 0, 2.3), (0.2, 0.2, 0.3))
    scene = scene_of(floor_entity(1), lamp, tilted(ceiling_entity(), 0.15))  # n . up = -0.989
    for up_cosine, attached in ((0.9, "hanging"), (0.995, "none")):
        support = dataclasses.replace(DEFAULT_SUPPORT, up_cosine=up_cosine)
        graph = build_contact_graphs([scene], DEFAULT, support)[0]
        assert graph.attachment[1] == attached


def test_a_board_on_the_edge_of_a_table_leans_against_the_wall():
    table = thing(2, "table", (0.15, 0, 0.35), (0.26, 1.0, 0.7))  # ends 0.28 m from the wall
    board = thing(3, "box", (0.4, 0, 1.0), (0.76, 0.5, 0.6))  # a third of its bottom over it
    scene = scene_of(floor_entity(1), table, board, wall_entity())
    graph = only(scene)
    assert graph.parent[2] == UNSUPPORTED
    assert graph.attachment == ("none", "none", "leaning", "none")


def test_what_stands_one_in_the_other_is_proximal_but_supports_are_not():
    table = thing(2, "table", (0, 0, 0.37), (1.2, 0.8, 0.74))
    chair = thing(3, "chair", (0.5, 0.5, 0.45), (0.5, 0.5, 0.9))
    cup = thing(4, "cup", (0, 0, 0.77), (0.08, 0.08, 0.1))  # sunk by 2 cm
    graph = only(scene_of(floor_entity(1), table, chair, cup))
    np.testing.assert_array_equal(graph.proximal, [[1, 2]])
    np.testing.assert_allclose(graph.proximal_depth_m, [0.15], atol=1e-5)


def test_networkx_view_is_the_tree_below_the_room():
    scene = stacked_scene()
    view = to_networkx(scene, only(scene))
    support = nx.DiGraph([(a, b) for a, b, kind in view.edges(data="kind") if kind == "support"])
    assert nx.is_arborescence(support)
    assert list(nx.dfs_preorder_nodes(support, "room")) == [
        "room",
        "floor_1",
        "table_2",
        "book_3",
        "cup_4",
        "cup_5",
    ]
    assert view.edges["table_2", "cup_5"]["score"] == pytest.approx(1.0, abs=0.02)


def test_networkx_view_has_proximal_edges_both_ways():
    table = thing(2, "table", (0, 0, 0.37), (1.2, 0.8, 0.74))
    chair = thing(3, "chair", (0.5, 0.5, 0.45), (0.5, 0.5, 0.9))
    scene = scene_of(floor_entity(1), table, chair)
    view = to_networkx(scene, only(scene))
    for names in (("table_2", "chair_3"), ("chair_3", "table_2")):
        assert view.edges[names]["depth_m"] == pytest.approx(0.15, abs=1e-5)


def test_a_second_scene_compiles_nothing_new():
    kernels = (_scores, _polygons, _vertices, _depths)
    only(random_scene(0, 10))
    before = [kernel._cache_size() for kernel in kernels]
    build_contact_graphs([random_scene(11, 7), random_scene(12, 15)], DEFAULT)
    assert [kernel._cache_size() for kernel in kernels] == before
    assert all(size > 0 for size in before)


def test_a_book_on_a_board_that_was_not_seen_stands_in_its_shelf():
    shelf = box_entity(2, "bookshelf", (0, 0, 1.0), (0.8, 0.3, 2.0), faces=(2, 3))
    book = thing(3, "book", (0.1, 0, 1.2), (0.2, 0.2, 0.04))
    beside = thing(4, "book", (1.5, 0, 1.2), (0.2, 0.2, 0.04))
    scene = scene_of(floor_entity(1), shelf, book, beside)
    graph = only(scene)
    assert graph.parent.tolist() == [ROOM, 0, 1, UNSUPPORTED]
    assert graph.support_plane[2] == -1
    np.testing.assert_array_equal(graph.refined_box.size[2], book.box.size)
    strict = dataclasses.replace(DEFAULT, inside_furniture=False)
    assert only(scene, strict).parent[2] == UNSUPPORTED


@pytest.mark.parametrize(("class_name", "attached"), [("wall_cabinet", "wall"), ("cup", "none")])
def test_what_hangs_by_its_class_may_be_seen_from_the_front_only(class_name, attached):
    wall = box_entity(2, "wall", (0, 1.01, 1.25), (4, 0.02, 2.5), faces=(5,))
    front = thing(3, class_name, (0, 0.7, 1.8), (0.8, 0.1, 0.6))
    assert only(scene_of(floor_entity(1), wall, front)).attachment[2] == attached
