"""From what a reader found to a library model: pose, size, class, and what is said about it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from isr_jax.cad.importing.converting.class_guess import class_of_words, guess_class
from isr_jax.cad.importing.converting.convert import convert
from isr_jax.cad.importing.converting.orientation import base_share, find_up, rotation_to_canonical
from isr_jax.cad.importing.converting.plausible import UNITS_M, largest_side_range, unit_of
from isr_jax.cad.importing.found import FoundModel
from isr_jax.cad.kit import make
from isr_jax.cad.planes import MIN_SUPPORT_SIDE_M
from isr_jax.errors import LibraryError
from isr_jax.library import CadModel
from isr_jax.robot_model import Joint, Link, RobotModel, Visual, link_transforms
from isr_jax.types import Mesh

from .builders import box_mesh

GREY = (0.5, 0.5, 0.5, 1.0)
Y_UP = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
"""From z up, front -y, to y up, front +z."""


def rigid(mesh: Mesh, name: str = "thing", visual: str = "body") -> RobotModel:
    link = Link(name, (Visual(visual, mesh, GREY),), (), 0.0, np.zeros(3), np.zeros((3, 3)))
    return RobotModel(name, (link,), ())


def found_of(mesh: Mesh, name: str = "thing", **said) -> FoundModel:
    return FoundModel(name, f"{name}.obj", rigid(mesh), **said)


def joined(*meshes: Mesh) -> Mesh:
    counts = np.cumsum([0, *(len(m.vertices) for m in meshes)])
    return Mesh(
        np.concatenate([m.vertices for m in meshes]),
        np.concatenate([m.faces + count for m, count in zip(meshes, counts)]).astype(np.int32),
    )


def block(size, center=(0.0, 0, 0)) -> Mesh:
    mesh = box_mesh(size, center, spacing_m=1.0)
    return Mesh(mesh.vertices, mesh.faces)


def chair_mesh() -> Mesh:
    """Four legs, a seat and a backrest at +y: it faces -y. 0.42 x 0.44 x 0.9 m."""
    legs = [block((0.04, 0.04, 0.43), (x, y, 0.215)) for x in (-0.19, 0.19) for y in (-0.2, 0.2)]
    seat, back = (
        block((0.42, 0.44, 0.03), (0, 0, 0.445)),
        block((0.42, 0.03, 0.44), (0, 0.205, 0.68)),
    )
    return joined(*legs, seat, back)


def shelf_mesh() -> Mesh:
    """Two sides, a back and four boards. 0.8 x 0.3 x 1.2 m."""
    sides = [block((0.02, 0.3, 1.2), (x, 0, 0.6)) for x in (-0.39, 0.39)]
    boards = [block((0.76, 0.28, 0.02), (0, -0.01, z)) for z in (0.01, 0.4, 0.8, 1.19)]
    return joined(*sides, *boards, block((0.76, 0.02, 1.2), (0, 0.14, 0.6)))


def turned(mesh: Mesh, A: np.ndarray, scale: float = 1.0, shift=(0.0, 0, 0)) -> Mesh:
    moved = mesh.vertices.astype(np.float64) @ A.T * scale + np.asarray(shift)
    return Mesh(moved.astype(np.float32), mesh.faces)


def extent(model: CadModel) -> np.ndarray:
    return np.ptp(model.mesh.vertices, axis=0)


def supporting(model: CadModel) -> list[tuple[float, float]]:
    """Height above the bottom, and area, of each supporting plane."""
    bottom = float(model.mesh.vertices[:, 2].min())
    corners = np.asarray(model.planes.corners)[model.plane_supporting]
    areas = np.asarray(model.planes.area_m2)[model.plane_supporting]
    return sorted((float(c[:, 2].mean()) - bottom, float(a)) for c, a in zip(corners, areas))


def test_stated_up_front_and_unit_are_taken():
    mesh = turned(chair_mesh(), Y_UP, 100.0, (7.0, 3.0, -5.0))
    model = convert(
        found_of(mesh, "chair", up=np.array([0.0, 1, 0]), front=np.array([0.0, 0, 1]), unit_m=0.01)
    )
    assert model.id == "chair/chair" and model.collision == "none"
    np.testing.assert_allclose(model.size, (0.42, 0.44, 0.9), atol=1e-5)
    low, high = model.mesh.vertices.min(0), model.mesh.vertices.max(0)
    np.testing.assert_allclose(low + high, 0, atol=1e-5)
    upper = model.mesh.vertices[model.mesh.vertices[:, 2] > 0.1]
    assert upper[:, 1].min() > 0.1, "the backrest is at +y"
    assert not any("front" in note or "unit" in note for note in model.notes)


@pytest.mark.parametrize("unit", ["millimetres", "centimetres", "inches", "metres"])
def test_without_a_word_a_chair_comes_out_upright_and_in_metres(unit):
    mesh = turned(chair_mesh(), Y_UP, 1 / UNITS_M[unit])
    model = convert(found_of(mesh, "chair"))
    np.testing.assert_allclose(model.size, (0.42, 0.44, 0.9), rtol=1e-4)
    said = " ".join(model.notes)
    assert all(word in said for word in ("class guessed", "up assumed", "front", unit))


@pytest.mark.parametrize("quarter", range(4))
def test_the_front_is_found_whichever_way_the_file_turned_it(quarter):
    c, s = [(1, 0), (0, 1), (-1, 0), (0, -1)][quarter]
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    model = convert(found_of(turned(chair_mesh(), R), "chair", up=np.array([0.0, 0, 1])))
    upper = model.mesh.vertices[model.mesh.vertices[:, 2] > 0.1]
    assert upper[:, 1].min() > 0.1


def test_a_model_that_cannot_stand_on_its_habitual_base_is_stood_up():
    chair = chair_mesh()
    assert base_share(chair.vertices.astype(float), np.array([0.0, 0, 1])) > 0.6
    pyramid = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [0, 0, 1]], float)
    up = find_up(pyramid, "cone.obj", "lamp")
    np.testing.assert_array_equal(up.vector, (0, 0, 1))
    assert "estimated" in up.note
    up = find_up(pyramid, "cone.stl", "lamp")
    np.testing.assert_array_equal(up.vector, (0, 0, 1))
    assert "assumed" in up.note


def test_rotation_to_canonical_is_a_rotation_that_does_what_it_says():
    rng = np.random.default_rng(3)
    for _ in range(20):
        up, front = rng.normal(size=(2, 3))
        R = rotation_to_canonical(up, front)
        np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(R) > 0
        np.testing.assert_allclose(R @ up / np.linalg.norm(up), (0, 0, 1), atol=1e-12)
        assert abs((R @ front)[0]) < 1e-12 and (R @ front)[1] < 0


def test_rigid_models_stretch_to_their_stated_size():
    stated = np.array([0.5, 0.44, 0.9])
    model = convert(
        found_of(
            chair_mesh(),
            "chair",
            up=np.array([0.0, 0, 1]),
            front=np.array([0.0, -1, 0]),
            size_m=stated,
        )
    )
    np.testing.assert_allclose(model.size, stated, rtol=1e-5)
    assert any("stretched" in note for note in model.notes)


@pytest.mark.parametrize(("unit_m", "name"), [(1.0, "millimetres"), (0.001, "metres")])
def test_a_unit_wrong_by_a_thousand_is_repaired_and_said(unit_m, name):
    mesh = turned(chair_mesh(), np.eye(3), 1 / UNITS_M[name])
    model = convert(found_of(mesh, "chair", up=np.array([0.0, 0, 1]), unit_m=unit_m))
    np.testing.assert_allclose(model.size, (0.42, 0.44, 0.9), rtol=1e-4)
    assert any("stated unit" in note and name in note for note in model.notes)


def test_a_size_that_no_unit_explains_is_refused_with_the_bounds():
    with pytest.raises(LibraryError, match=r"no unit of length makes a chair"):
        convert(found_of(turned(chair_mesh(), np.eye(3), 1e7), "chair"))


def test_unit_guesses_are_plausible():
    for name in ("chair", "cup", "wardrobe", "other"):
        low, high = largest_side_range(name)
        for unit_m in UNITS_M.values():
            guess = unit_of(np.sqrt(low * high) / unit_m, name, None)
            assert guess is not None and low <= np.sqrt(low * high) / unit_m * guess.unit_m <= high


def test_no_faces_and_no_numbers_are_refused():
    empty = Mesh(np.zeros((3, 3), np.float32), np.zeros((0, 3), np.int32))
    with pytest.raises(LibraryError, match="no faces"):
        convert(found_of(empty))
    broken = block((1, 1, 1))
    broken.vertices[0, 0] = np.nan
    with pytest.raises(LibraryError, match="no numbers"):
        convert(found_of(broken))


@pytest.mark.parametrize(
    ("words", "class_name"),
    [
        ("StorageFurniture", "cabinet"),
        ("TrashCan", "bin"),
        ("base_cabinet_0", "cabinet"),
        ("Bedside table", "nightstand"),
        ("Table lamp", "lamp"),
        ("Chair with cushion", "chair"),
        ("slidecabinet", "cabinet"),
        ("OfficeChair", "chair"),
        ("Shelves", "bookshelf"),
        ("Wheelchair", "other"),
        ("Toilet brush", "other"),
        ("Glasses", "other"),
    ],
)
def test_the_head_of_a_name_says_the_class(words, class_name):
    assert guess_class([words]).class_name == class_name


def test_words_that_say_nothing_give_other_and_tags_come_after_the_name():
    assert guess_class(["xk12", ""]).class_name == "other"
    assert guess_class(["xk12", "Couch"]).class_name == "sofa"
    assert class_of_words("12345") is None
    model = convert(found_of(block((0.3, 0.2, 0.1)), "xk12", up=np.array([0.0, 0, 1])))
    assert model.class_name == "other" and any("class unknown" in n for n in model.notes)


def test_a_guessed_class_gives_way_to_the_size_and_a_stated_one_does_not():
    stated = {"up": np.array([0.0, 0, 1]), "front": np.array([0.0, -1, 0])}
    giant = np.array([3.0, 3.0, 6.0])
    guessed = convert(found_of(chair_mesh(), "chair", size_m=giant, **stated))
    assert guessed.class_name == "other" and any("no size of a chair" in n for n in guessed.notes)
    said = convert(found_of(chair_mesh(), "chair", size_m=giant, class_name="chair", **stated))
    assert said.class_name == "chair"


def test_every_board_of_a_shelf_carries():
    model = convert(found_of(shelf_mesh(), "shelf", up=np.array([0.0, 0, 1])))
    heights = [height for height, _ in supporting(model)]
    np.testing.assert_allclose(heights, (0.02, 0.41, 0.81, 1.2), atol=1e-4)
    for _, area in supporting(model)[:3]:
        assert area == pytest.approx(0.76 * 0.28, rel=0.02)
    assert model.plane_link == ("thing",) * len(model.plane_link)


def test_planes_of_a_box_are_its_faces():
    size = np.array([0.6, 0.4, 0.3], np.float32)
    model = convert(found_of(block(size), "box", up=np.array([0.0, 0, 1])))
    assert len(model.plane_link) == 6 and model.plane_supporting.sum() == 1
    normals, areas = np.asarray(model.planes.normal), np.asarray(model.planes.area_m2)
    for normal, offset, corners, area in zip(
        normals, np.asarray(model.planes.offset), np.asarray(model.planes.corners), areas
    ):
        axis = int(np.argmax(np.abs(normal)))
        assert -offset == pytest.approx(size[axis] / 2, abs=1e-4)
        assert area == pytest.approx(np.prod(np.delete(size, axis)), rel=1e-3)
        turn = np.cross(corners[1] - corners[0], corners[2] - corners[1])
        assert turn @ normal > 0, "counter-clockwise seen against the normal"
        np.testing.assert_allclose(
            np.ptp(corners, axis=0), size * (np.arange(3) != axis), atol=1e-4
        )


def test_a_cylinder_has_two_planes_and_is_round():
    angle = np.linspace(0, 2 * np.pi, 49)[:-1]
    ring = np.stack([np.cos(angle), np.sin(angle)], 1) * 0.2
    points = np.concatenate([np.c_[ring, np.zeros(48)], np.c_[ring, np.full(48, 0.5)]])
    points = np.concatenate([points, [[0, 0, 0], [0, 0, 0.5]]]).astype(np.float32)
    k, n = np.arange(48), (np.arange(48) + 1) % 48
    faces = np.concatenate(
        [
            np.stack([k, n, n + 48], 1),
            np.stack([k, n + 48, k + 48], 1),
            np.stack([n, k, np.full(48, 96)], 1),
            np.stack([k + 48, n + 48, np.full(48, 97)], 1),
        ]
    ).astype(np.int32)
    model = convert(found_of(Mesh(points, faces), "vase", up=np.array([0.0, 0, 1])))
    assert model.symmetry == 0
    assert sorted(np.round(np.asarray(model.planes.normal)[:, 2], 3)) == [-1, 1]


@pytest.mark.parametrize(("size", "order"), [((0.5, 0.5, 0.2), 4), ((0.6, 0.3, 0.2), 2)])
def test_symmetry_of_blocks(size, order):
    model = convert(found_of(block(size), "table", up=np.array([0.0, 0, 1])))
    assert model.symmetry == order


def test_a_chair_has_no_symmetry_and_carries_on_its_seat():
    model = convert(found_of(chair_mesh(), "chair", up=np.array([0.0, 0, 1])))
    assert model.symmetry == 1
    assert any(abs(height - 0.46) < 1e-3 for height, _ in supporting(model))


def test_inside_out_models_are_turned_and_said():
    chair = chair_mesh()
    wrong = Mesh(chair.vertices, chair.faces[:, ::-1].copy())
    uv = np.arange(len(wrong.faces) * 6, dtype=np.float32).reshape(-1, 3, 2)
    wrong = dataclasses.replace(wrong, uv=uv)
    model = convert(found_of(wrong, "chair", up=np.array([0.0, 0, 1])))
    right = convert(found_of(chair, "chair", up=np.array([0.0, 0, 1])))
    mesh = model.robot.links[0].visuals[0].mesh
    np.testing.assert_array_equal(mesh.faces, chair.faces)
    np.testing.assert_array_equal(mesh.uv, uv[:, ::-1])
    assert any("inside out" in note for note in model.notes)
    assert not any("inside out" in note for note in right.notes)
    assert len(model.plane_link) == len(right.plane_link)


def test_a_soup_with_random_winding_has_the_planes_of_the_sound_mesh():
    rng = np.random.default_rng(0)
    shelf = shelf_mesh()
    flip = rng.random(len(shelf.faces)) < 0.5
    soup = Mesh(
        shelf.vertices[shelf.faces].reshape(-1, 3),
        np.where(flip[:, None], np.arange(3)[::-1], np.arange(3)).astype(np.int32)
        + 3 * np.arange(len(flip), dtype=np.int32)[:, None],
    )
    sound = convert(found_of(shelf, "shelf", up=np.array([0.0, 0, 1])))
    model = convert(found_of(soup, "shelf", up=np.array([0.0, 0, 1])))
    np.testing.assert_allclose(supporting(model), supporting(sound), atol=1e-3)


def test_a_single_sheet_has_both_sides():
    sheet = Mesh(
        np.array([[0, 0, 0], [1, 0, 0], [1, 0.6, 0], [0, 0.6, 0]], np.float32),
        np.array([[0, 1, 2], [0, 2, 3]], np.int32),
    )
    legs = block((0.05, 0.05, 0.7), (0.5, 0.3, -0.35))
    model = convert(found_of(joined(sheet, legs), "table", up=np.array([0.0, 0, 1])))
    level = np.asarray(model.planes.normal)[:, 2]
    assert (level > 0.99).any() and (level < -0.99).any()
    assert len(supporting(model)) == 1


def test_upholstery_that_is_not_flat_still_carries():
    u, v = np.meshgrid(np.linspace(-1, 1, 21), np.linspace(-1, 1, 21))
    z = 0.45 + 0.02 * (1 - u**2) * (1 - v**2)
    points = np.stack([0.3 * u, 0.3 * v, z], -1).reshape(-1, 3).astype(np.float32)
    corner = (np.arange(20)[:, None] * 21 + np.arange(20)).ravel()
    quads = np.stack([corner, corner + 1, corner + 22, corner + 21], 1)
    top = Mesh(points, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int32))
    model = convert(
        found_of(
            joined(top, block((0.6, 0.6, 0.44), (0, 0, 0.22))), "stool", up=np.array([0.0, 0, 1])
        )
    )
    assert any(0.44 < height < 0.475 and area > 0.1 for height, area in supporting(model))


def cabinet_robot(scale: float = 1.0) -> RobotModel:
    """A carcass, a hinged door with a handle, a drawer; they open towards +x in this file."""
    carcass = joined(
        block((0.5, 0.02, 0.8), (0, -0.29, 0.4)),
        block((0.5, 0.02, 0.8), (0, 0.29, 0.4)),
        block((0.02, 0.56, 0.8), (-0.24, 0, 0.4)),
        block((0.5, 0.6, 0.02), (0, 0, 0.81)),
    )
    door, handle = block((0.02, 0.56, 0.5), (0, 0.28, 0)), block((0.04, 0.1, 0.02), (0.03, 0.5, 0))
    drawer = block((0.4, 0.5, 0.2))
    unit = 1 / scale

    def link(name: str, *visuals: tuple[str, Mesh]) -> Link:
        parts = tuple(Visual(n, turned(m, np.eye(3), unit), GREY) for n, m in visuals)
        return Link(name, parts, (), 0.0, np.zeros(3), np.zeros((3, 3)))

    def at(x: float, y: float, z: float) -> np.ndarray:
        T = np.eye(4)
        T[:3, 3] = np.array([x, y, z]) * unit
        return T

    hinge = Joint(
        "door_hinge",
        "revolute",
        "carcass",
        "door",
        at(0.26, -0.28, 0.26),
        np.array([0.0, 0, -1]),
        0.0,
        1.6,
    )
    slide = Joint(
        "drawer_slide",
        "prismatic",
        "carcass",
        "drawer",
        at(0.0, 0, 0.68),
        np.array([1.0, 0, 0]),
        0.0,
        0.3 * unit,
    )
    links = (
        link("carcass", ("body", carcass)),
        link("door", ("panel", door), ("handle", handle)),
        link("drawer", ("body", drawer)),
    )
    return RobotModel("cabinet", links, (hinge, slide))


def test_joints_follow_the_pose_and_the_unit():
    found = FoundModel("cabinet", "cabinet.urdf", cabinet_robot(0.001), up=np.array([0.0, 0, 1]))
    model = convert(found)
    assert any("millimetres" in note for note in model.notes)
    assert any("open" in note for note in model.notes)
    hinge, slide = model.robot.joints
    assert (hinge.lower, hinge.upper) == (0.0, 1.6)
    assert slide.upper == pytest.approx(0.3)
    assert model.moving_joints == ("door_hinge", "drawer_slide") and model.symmetry == 1
    opened = link_transforms(model.robot, {"drawer_slide": 0.3})["drawer"]
    closed = link_transforms(model.robot)["drawer"]
    np.testing.assert_allclose((opened - closed)[:3, 3], (0, -0.3, 0), atol=1e-9)


def test_a_sliding_door_does_not_turn_the_cabinet():
    robot = cabinet_robot()
    slide = dataclasses.replace(robot.joints[1], axis=np.array([0.0, 1, 0]))
    panel = dataclasses.replace(robot.links[2].visuals[0], mesh=block((0.02, 0.5, 0.5)))
    door = dataclasses.replace(robot.links[2], visuals=(panel,))
    robot = RobotModel("cabinet", (robot.links[0], door), (slide,))
    model = convert(FoundModel("cabinet", "c.urdf", robot, up=np.array([0.0, 0, 1])))
    assert not any("open to" in note for note in model.notes)
    # Its flat back is at -x in this file, so the panel slides to the side.
    moved = link_transforms(model.robot, {"drawer_slide": 0.3})["drawer"]
    shift = (moved - link_transforms(model.robot)["drawer"])[:3, 3]
    assert abs(shift[1]) < 1e-9 < abs(shift[0])


def test_handles_are_found_by_name_or_estimated_and_left_out_of_the_box():
    model = convert(FoundModel("cabinet", "c.urdf", cabinet_robot(), up=np.array([0.0, 0, 1])))
    door, drawer = model.handles
    assert (door.joint, door.link, door.estimated) == ("door_hinge", "door", False)
    np.testing.assert_allclose(door.position, (0.03, 0.5, 0), atol=1e-6)
    assert drawer.estimated and drawer.position[0] == pytest.approx(0.2, abs=1e-6)
    # Deep: carcass 0.5 m and the door before it; the handle sticks out of that.
    assert model.size[1] == pytest.approx(0.02 + 0.5, abs=1e-4)
    assert extent(model)[1] == pytest.approx(0.56, abs=1e-4)
    stated = {"door_hinge": np.array([0.01, 0.2, 0.1])}
    said = convert(
        FoundModel("cabinet", "c.urdf", cabinet_robot(), up=np.array([0.0, 0, 1]), handles=stated)
    )
    np.testing.assert_array_equal(said.handles[0].position, stated["door_hinge"])


def is_inertia(inertia: np.ndarray) -> bool:
    moments = np.linalg.eigvalsh(inertia)
    return bool(moments[0] > 0 and moments[0] + moments[1] >= moments[2] * (1 - 1e-9))


def test_masses_are_plausible_and_inertias_possible():
    sheet = Mesh(np.eye(3, dtype=np.float32), np.array([[0, 1, 2]], np.int32))
    for found in (
        FoundModel("cabinet", "c.urdf", cabinet_robot(), up=np.array([0.0, 0, 1])),
        found_of(sheet, "picture", up=np.array([0.0, 0, 1])),
        found_of(chair_mesh(), "chair", up=np.array([0.0, 0, 1])),
    ):
        model = convert(found)
        assert any("mass estimated" in note for note in model.notes)
        assert 0.001 < model.robot.mass_kg < 100
        assert all(is_inertia(np.asarray(link.inertia)) for link in model.robot.links)


def test_a_shell_of_a_cube_has_its_known_inertia():
    side, mass = 0.5, 6.0
    model = convert(found_of(block((side,) * 3), "box", up=np.array([0.0, 0, 1]), mass_kg=mass))
    assert model.robot.mass_kg == pytest.approx(mass)
    link = model.robot.links[0]
    np.testing.assert_allclose(link.com, 0, atol=1e-6)
    # Thin cube: 5/18 m a^2 about each axis.
    np.testing.assert_allclose(link.inertia, 5 / 18 * mass * side**2 * np.eye(3), atol=1e-3)


def test_stated_masses_hold_where_they_are_believable():
    for mass, kept in ((6.0, True), (0.001, False), (5000.0, False)):
        robot = rigid(chair_mesh())
        link = dataclasses.replace(robot.links[0], mass_kg=mass, inertia=10 * np.eye(3))
        found = FoundModel("chair", "c.urdf", dataclasses.replace(robot, links=(link,)))
        model = convert(dataclasses.replace(found, up=np.array([0.0, 0, 1])))
        assert (model.robot.mass_kg == mass) == kept
        assert np.trace(model.robot.links[0].inertia) < 10.0, "no chair has that"


@pytest.mark.parametrize(
    "cad_id", ["chair/dining_oak", "bookshelf/wide", "table/dining_small", "fridge/tall"]
)
def test_kit_models_taken_apart_to_triangles_come_back_the_same(cad_id):
    """The planes that rays find on a mesh are those that the kit knows from its solids."""
    from isr_jax.cad.kit import KIT

    cad_id = cad_id if cad_id in KIT else next(i for i in KIT if i.startswith(cad_id.split("/")[0]))
    kit = make(cad_id)
    found = FoundModel(
        cad_id.split("/")[1],
        "kit.urdf",
        kit.robot,
        unit_m=1.0,
        up=np.array([0.0, 0, 1]),
        front=np.array([0.0, -1, 0]),
        class_name=kit.class_name,
    )
    model = convert(found)
    np.testing.assert_allclose(model.size, kit.size, atol=0.07)
    theirs = [
        (c.mean(0)[2], a)
        for c, a in zip(
            np.asarray(kit.planes.corners)[kit.plane_supporting],
            np.asarray(kit.planes.area_m2)[kit.plane_supporting],
        )
        if a > 0.03 and min(np.ptp(c, axis=0)[:2]) > 2 * MIN_SUPPORT_SIDE_M
    ]
    ours = np.asarray(model.planes.corners)[model.plane_supporting].mean(1)[:, 2]
    for height, _ in theirs:
        assert np.abs(ours - height).min() < 0.03, (height, ours)


def test_hung_cabinets_hang():
    found = found_of(block((0.6, 0.35, 0.7)), "cabinet", up=np.array([0.0, 0, 1]))
    model = convert(dataclasses.replace(found, elevation_m=1.4))
    assert (model.class_name, model.mount) == ("wall_cabinet", "wall")
    assert convert(found).mount == "floor"


def test_the_same_model_comes_out_the_same():
    first, second = (convert(found_of(chair_mesh(), "chair")) for _ in range(2))
    assert first.content_hash == second.content_hash and first.content_hash
