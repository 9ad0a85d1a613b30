"""What may furnish a room, where it stands, leans and hangs: small cases whose answer is known."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from isr_jax.borders.raycast import RayScene
from isr_jax.geometry import canonical_box
from isr_jax.library import CadModel
from isr_jax.synthetic import LayoutPatch, PlacedModel, Room, make_room
from isr_jax.synthetic.furnishing.clearance import meshes_apart
from isr_jax.synthetic.furnishing.kinds import DEMONSTRATION, RECIPES
from isr_jax.synthetic.furnishing.placement import Occupancy
from isr_jax.synthetic.furnishing.proposal import ON_FLOOR, Proposal
from isr_jax.synthetic.furnishing.recipe import roles_of
from isr_jax.synthetic.furnishing.roles import ROLES
from isr_jax.synthetic.furnishing.stock import Stock, stands
from isr_jax.synthetic.furnishing.tops import carrying_planes, top_of
from isr_jax.synthetic.room import ROOM_KINDS
from isr_jax.types import Mesh

from .builders import library_of, parts_model, table_model
from .furniture import block_model, bookshelf_model, cabinet_model, chair_model, furniture_library

SEEDS = range(6)
TOUCH_M = 5e-4


def _wall_mounted(model: CadModel) -> CadModel:
    return dataclasses.replace(model, mount="wall")


def _stock(*models: CadModel) -> Stock:
    return Stock(library_of(*models), np.random.default_rng(0))


@pytest.fixture(scope="module")
def rooms() -> list[Room]:
    """With a lamp that hangs, a picture, a flat bag that can lean, and a rug."""
    lamp = _wall_mounted(block_model("lamp/hanging_bowl", (0.4, 0.4, 0.3)))
    picture = _wall_mounted(block_model("picture/flat", (0.6, 0.03, 0.4)))
    more = library_of(
        *furniture_library().models,
        lamp,
        picture,
        block_model("bag/flat", (0.4, 0.06, 0.35)),
        block_model("rug/mat", (0.7, 0.5, 0.01)),
        block_model("bed/a", (1.4, 2.0, 0.5)),
    )
    return [make_room(seed, more) for seed in SEEDS]


def test_recipes_name_roles_that_exist():
    assert tuple(RECIPES) == ROOM_KINDS
    for recipe in (*RECIPES.values(), DEMONSTRATION):
        named = {role for step in recipe.steps for role in roles_of(step)}
        hosts = {role for step in recipe.steps for role in getattr(step, "hosts", ())}
        needed = {role for roles in recipe.needs for role in roles}
        assert named | hosts | needed <= set(ROLES)
        assert needed <= named  # what a room cannot be without is in it


def test_sizes_that_no_chair_has_are_refused():
    """3 m tall: the role allows 1.1 m."""
    tall = block_model("chair/tower", (0.45, 0.45, 3.0))
    assert "dining chair" not in _stock(tall)
    assert "dining chair" in _stock(tall, chair_model())
    drawn = {_stock(tall, chair_model()).draw("dining chair")[0].id for _ in range(4)}
    assert drawn == {"chair/test"}


def test_what_stands_on_a_thin_foot_is_refused():
    """A block of 0.2 m on a foot of 1 cm, 0.3 m high: it falls at atan(0.005 / 0.4) = 0.7 degrees.

    On a foot of 0.16 m, whose mass is nearly that of the block, the centre of mass is at 0.28 m,
    and it falls at atan(0.08 / 0.28) = 16 degrees.
    """
    block = ((0.2, 0.2, 0.2), (0, 0, 0.15))
    thin = parts_model("vase/thin", "vase", [block, ((0.01, 0.01, 0.3), (0, 0, -0.1))])
    wide = parts_model("vase/wide", "vase", [block, ((0.16, 0.16, 0.3), (0, 0, -0.1))])
    assert not stands(thin) and stands(wide)
    assert "vase" not in _stock(thin) and "vase" in _stock(wide)


def test_a_table_without_a_top_carries_nothing_and_is_refused():
    """Four legs and rails around nothing: no plane of 0.35 m2."""
    rails = [((1.2, 0.04, 0.06), (0, s * 0.38, 0.34)) for s in (-1, 1)]
    legs = [((0.05, 0.05, 0.74), (sx * 0.55, sy * 0.38, 0)) for sx in (-1, 1) for sy in (-1, 1)]
    frame = parts_model("table/frame", "table", [*rails, *legs])
    assert "dining table" not in _stock(frame)
    assert "dining table" in _stock(frame, table_model())


def test_a_top_is_where_the_surface_is():
    """An L of 1 x 1 m without a quarter: 0.75 of the rectangle; the missing quarter carries not."""
    low = [((1.0, 0.5, 0.7), (0, 0.25, 0)), ((0.5, 0.5, 0.7), (-0.25, -0.25, 0))]
    model = parts_model("desk/corner", "desk", low)
    plane = int(carrying_planes(model)[0])
    top = top_of(model, plane)
    square = np.array([(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)])
    assert top.carries(square + np.array([-0.3, 0.3]))
    assert not top.carries(square + np.array([0.3, -0.3]))
    assert not top.carries(square + np.array([0.95, 0.3]))


def test_a_chair_under_a_table_is_apart_until_it_meets_a_leg():
    """The seat, 0.44 wide, fits between legs 1.08 m apart; 0.5 m to the side it meets one."""
    table, chair = table_model(), chair_model()
    under = Proposal(table, 1.0, 0.0, np.array([0.0, 0, 0.37]), ON_FLOOR)
    seat = Proposal(chair, 1.0, np.pi, np.array([0.0, -0.5, 0.44]), ON_FLOOR)
    assert meshes_apart(seat, under) and meshes_apart(under, seat)
    moved = dataclasses.replace(seat, center=np.array([0.42, -0.5, 0.44]))
    assert not meshes_apart(moved, under) and not meshes_apart(under, moved)


def test_zones_before_doors_stay_clear():
    empty = Occupancy(np.array([4.0, 4.0, 2.5]))
    box = Proposal(block_model("box/a", (0.4, 0.4, 0.4)), 1.0, 0.0, np.array([0, 0, 0.2]), ON_FLOOR)
    assert empty.first_free([box]) is box
    closed = Occupancy(np.array([4.0, 4.0, 2.5]), [canonical_box(box.center, 0.0, np.full(3, 0.4))])
    assert closed.first_free([box]) is None


def _leaning(rooms: list[Room]) -> list[tuple[Room, PlacedModel]]:
    return [(room, i) for room in rooms for i in room.items if i.attachment == "leaning"]


def test_what_leans_is_tilted_between_8_and_15_degrees(rooms):
    """The angle between the vertical and the axis of the model that points up most."""
    leaning = _leaning(rooms)
    assert len(leaning) >= len(rooms)
    for _, item in leaning:
        assert np.linalg.det(item.T_world_cad[:3, :3]) == pytest.approx(1, abs=1e-5)
        tilt = np.degrees(np.arccos(np.abs(item.T_world_cad[2, :3]).max()))
        assert 7.99 <= tilt <= 15.01


def test_what_leans_touches_below_and_above(rooms):
    """Its lowest edge a floor or a plane, its rearmost a wall or a side of what it stands on.

    Rays from 1 mm above the one, and from 1 mm before the other, are met after 1 mm.
    """
    for room, item in _leaning(rooms):
        points = item.to_world(item.model.mesh.vertices)
        low = points[points[:, 2] < points[:, 2].min() + 1e-4]
        back = low.mean(0) - points.mean(0)
        back = -np.array([*_axis_across(item), 0.0]) * np.sign(back[:2] @ _axis_across(item))
        rear = points[points @ back > (points @ back).max() - 1e-4]
        others = [o for o in room.items if o is not item]
        meshes = [Mesh(o.to_world(o.model.mesh.vertices), o.model.mesh.faces) for o in others]
        walls = np.array([_gap(rear, patch) for patch in room.layout if patch.class_name == "wall"])
        scene = RayScene(meshes, list(range(1, len(meshes) + 1)))
        assert _met(scene, low, np.array([0.0, 0, -1])) or abs(low[:, 2]).max() < TOUCH_M
        assert _met(scene, rear, back) or abs(walls).min() < TOUCH_M, item.name
        assert walls.min() > -1e-5  # into no wall


def _axis_across(item: PlacedModel) -> np.ndarray:
    """[2] unit: level direction in which the upright axis of the model is tilted."""
    upright = int(np.abs(item.T_world_cad[2, :3]).argmax())
    axis = item.T_world_cad[:2, upright]
    return axis / np.linalg.norm(axis)


def _gap(points: np.ndarray, patch: LayoutPatch) -> float:
    return float(((points - patch.corners[0]) @ patch.normal).min())


def _met(scene: RayScene, points: np.ndarray, direction: np.ndarray) -> bool:
    """Whether something lies within `TOUCH_M` of all points, in a direction."""
    inner = points.mean(0) + 0.98 * (points - points.mean(0))
    hits = scene.cast(inner - 0.001 * direction, np.tile(direction, (len(inner), 1)))
    return bool(np.all((hits.instance > 0) & (abs(hits.distance - 0.001) < TOUCH_M)))


def test_what_leans_falls_back_and_not_over(rooms):
    """Its centre of mass lies between the edge that it stands on and the one that touches."""
    for _, item in _leaning(rooms):
        points = item.to_world(item.model.mesh.vertices)
        level = points[points[:, 2] > points[:, 2].max() - 0.005].mean(0)[:2]
        low = points[points[:, 2] < points[:, 2].min() + 1e-4].mean(0)[:2]
        middle = points.mean(0)[:2]  # blocks: the mean of the corners
        back = (level - low) / np.linalg.norm(level - low)
        assert 0.0 < (middle - low) @ back < (level - low) @ back + 0.05


def test_lamps_hang_from_the_ceiling_only_where_there_is_one(rooms):
    hanging = [(room, i) for room in rooms for i in room.items if i.attachment == "hanging"]
    assert len(hanging) == len(rooms)
    for room, item in hanging:
        top = item.center[2] + item.scale * item.model.size[2] / 2
        assert top == pytest.approx(float(room.size[2]), abs=1e-5)
        assert item.model.id == "lamp/hanging_bowl"
    lamp = hanging[0][1].model
    bare = make_room(1, library_of(*furniture_library().models, lamp), ceiling=False)
    assert all(item.attachment != "hanging" for item in bare.items)


def test_pictures_hang_flat_on_a_wall(rooms):
    found = 0
    for room in rooms:
        for item in (i for i in room.items if i.model.class_name == "picture"):
            if item.attachment == "wall":
                points = item.to_world(item.model.mesh.vertices)
                gaps = [((points - p.corners[0]) @ p.normal).min() for p in room.layout[1:5]]
                assert min(gaps) == pytest.approx(0.003, abs=1e-4)
                found += 1
    assert found >= 2


def test_shells_without_models_say_so():
    models = (table_model(), chair_model(), cabinet_model(), bookshelf_model())
    room = make_room(0, library_of(*models, block_model("cup/a", (0.08, 0.08, 0.1))))
    assert any("door" in note for note in room.notes)
