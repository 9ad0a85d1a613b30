"""Pictures of models: colours, glass, textures, joints, layout."""

from __future__ import annotations

import dataclasses
import io

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from isr_jax.cad.pictures.groups import GROUPS, REST, grouped
from isr_jax.cad.pictures.paint import Paint, barycentric, decoded
from isr_jax.cad.pictures.picture import PAPER, ModelScene, picture, placed_meshes
from isr_jax.cad.pictures.sheet import (
    TILE_HEIGHT,
    TILE_WIDTH,
    caption,
    draw_model,
    draw_models,
    grid,
    labelled,
)
from isr_jax.cad.poses import opened, travel_range
from isr_jax.classes import classes
from isr_jax.errors import OutputError, SettingError
from isr_jax.library import CadModel, held
from isr_jax.robot_model import Texture, Visual

from .builders import table_model
from .opening_models import door_model, drawer_model, model_of, solid_link, wheel_model

RED = (0.9, 0.1, 0.1, 1.0)


def painted(*parts: tuple[tuple, tuple]) -> CadModel:
    """One link of boxes: (bounds, rgba) each."""
    model = model_of(door_model().robot)
    links = [solid_link(f"part_{i}", bounds, rgba=rgba) for i, (bounds, rgba) in enumerate(parts)]
    base = dataclasses.replace(
        links[0],
        visuals=tuple(v for link in links for v in link.visuals),
        hulls=tuple(h for link in links for h in link.hulls),
    )
    robot = dataclasses.replace(model.robot, links=(base,), joints=())
    return dataclasses.replace(model, load_robot=held(robot), moving_joints=())


def cube(half: float, y: float = 0.0, thick: float | None = None) -> tuple:
    depth = half if thick is None else thick
    return (-half, half), (y - depth, y + depth), (-half, half)


def test_a_box_fills_its_picture_in_its_own_colour_on_paper():
    image = picture(painted((cube(0.3), RED)), 120, 90).astype(float)
    middle = image[45, 60]
    assert middle[0] > 80 and middle[0] > 4 * middle[1] and middle[0] > 4 * middle[2]
    shown = np.argwhere(image[..., 0] > 2.5 * image[..., 1])
    assert np.ptp(shown[:, 0]) == pytest.approx(0.92 * 90, abs=4)  # it fits by its height
    assert shown.mean(0) == pytest.approx([44.5, 59.5], abs=3)


def test_a_picture_is_the_same_every_time():
    model = door_model()
    np.testing.assert_array_equal(picture(model, 60, 50), picture(model, 60, 50))


def test_what_hangs_casts_no_shadow_on_a_ground():
    standing = picture(painted((cube(0.3), RED)), 80, 60)
    hanging = picture(dataclasses.replace(painted((cube(0.3), RED)), mount="wall"), 80, 60)
    paper = np.rint(PAPER).astype(np.uint8)
    assert np.all(hanging[:2] == paper) and np.all(hanging[-1] == paper)
    assert not np.all(standing[-1] == paper)


@pytest.mark.parametrize("alpha", [0.1, 0.3, 0.5])
def test_glass_lets_through_what_is_behind_by_its_opacity(alpha):
    """A blue pane before a red box: two surfaces, each leaves 1 - alpha of what is behind."""

    def light(*panes) -> np.ndarray:
        scene = ModelScene(painted((cube(0.2), RED), *panes), {})
        return scene.shoot(np.array([0.0, -3, 0]), np.array([[0.0, 1, 0]]), np.zeros(1, int))[0]

    bare, through = light(), light((cube(0.2, y=-0.5, thick=0.01), (0.0, 0.0, 1.0, alpha)))
    left = (1 - alpha) ** 2
    np.testing.assert_allclose(through[:2], left * bare[:2], rtol=1e-6)
    assert through[2] > left * bare[2] + 255 * 0.2 * (1 - left)  # the pane's own blue, shaded
    solid = light((cube(0.2, y=-0.5, thick=0.01), (0.0, 0.0, 1.0, 1.0)))
    assert solid[0] == 0 and solid[2] > 50


def png(pixels: np.ndarray) -> Texture:
    file = io.BytesIO()
    Image.fromarray(pixels.astype(np.uint8)).save(file, "PNG")
    return Texture("checks.png", file.getvalue())


QUARTERS = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 0]]])
"""Top row red, green; bottom row blue, yellow."""


def textured_square() -> Visual:
    mesh = solid_link("tile", cube(0.5)).visuals[0].mesh
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    uv = corners[faces][..., :2].copy()
    mesh = dataclasses.replace(mesh, vertices=corners, faces=faces, uv=uv)
    return Visual("tile", mesh, (0.5, 0.5, 0.5, 1.0), png(QUARTERS))


@pytest.mark.parametrize(
    ("u", "v", "color"),
    [
        (0.2, 0.8, (255, 0, 0)),
        (0.8, 0.8, (0, 255, 0)),
        (0.2, 0.2, (0, 0, 255)),
        (0.8, 0.2, (255, 255, 0)),
    ],
)
def test_a_texture_lies_the_right_way_round(u, v, color):
    visual = textured_square()
    face = 0 if u > v else 1
    corners = visual.mesh.vertices[visual.mesh.faces[[face]]]
    rgb, alpha = Paint([visual]).at(
        np.array([0]), np.array([face]), corners, np.array([[u, v, 0.0]])
    )
    np.testing.assert_allclose(rgb, [color])
    assert alpha == [1.0]


def test_a_texture_that_is_no_image_leaves_the_mean_colour():
    broken = Texture("broken.png", b"no image")
    assert decoded(broken) is None
    visual = dataclasses.replace(textured_square(), texture=broken)
    corners = visual.mesh.vertices[visual.mesh.faces[[0]]]
    rgb, _ = Paint([visual]).at(np.array([0]), np.array([0]), corners, np.array([[0.8, 0.2, 0]]))
    np.testing.assert_allclose(rgb, [[127.5] * 3])


@given(
    st.lists(st.floats(-1, 1), min_size=9, max_size=9),
    st.floats(0.01, 0.98),
    st.floats(0.01, 0.98),
)
@settings(max_examples=50, deadline=None)
def test_barycentric_weights_give_the_point_back(numbers, s, t):
    corners = np.array(numbers).reshape(1, 3, 3)
    u, v = corners[0, 1] - corners[0, 0], corners[0, 2] - corners[0, 0]
    if np.linalg.norm(np.cross(u, v)) < 1e-3:
        return  # no triangle
    t = t * (1 - s)
    point = corners[:, 0] + s * u + t * v
    weight = barycentric(corners, point)
    assert weight.sum() == pytest.approx(1)
    np.testing.assert_allclose(weight @ corners[0], point, atol=1e-7)


def test_open_joints_move_what_is_drawn():
    model = drawer_model(0.3)
    closed, wide = (placed_meshes(model, q) for q in ({}, opened(model.robot, 0.5)))
    moved = wide[-1].vertices - closed[-1].vertices
    np.testing.assert_allclose(moved, np.tile([0, -0.15, 0], (8, 1)), atol=1e-6)
    assert opened(wheel_model().robot, 0.5) == {}
    assert travel_range(wheel_model().robot.joints[0]) == (0.0, pytest.approx(2 * np.pi))


def test_a_sheet_has_a_tile_a_model(tmp_path):
    told = []
    models = [table_model(), door_model(), drawer_model()]
    draw_models(
        models, tmp_path / "new" / "sheet.png", columns=2, progress=lambda d, t: told.append((d, t))
    )
    with Image.open(tmp_path / "new" / "sheet.png") as sheet:
        width, height = sheet.size
        pixels = np.asarray(sheet.convert("RGB"))
    assert (width, height) == (2 * (TILE_WIDTH + 8), 2 * (TILE_HEIGHT + 34 + 8))
    assert told == [(1, 3), (2, 3), (3, 3)]
    paper = np.abs(pixels.astype(int) - PAPER.astype(int)).max(-1) < 6
    tiles = paper.reshape(2, height // 2, 2, width // 2).mean((1, 3))
    assert tiles[1, 1] == 1.0 and np.all(tiles.ravel()[:3] < 0.95)  # the last place is empty
    text_rows = paper[TILE_HEIGHT + 8 : TILE_HEIGHT + 36, : width // 2]
    assert not text_rows.all()


def test_a_model_with_joints_is_drawn_closed_and_open(tmp_path):
    draw_model(door_model(), tmp_path / "door.png", width=160, height=120)
    draw_model(table_model(), tmp_path / "table.png", width=160, height=120)
    with Image.open(tmp_path / "door.png") as door, Image.open(tmp_path / "table.png") as table:
        assert door.size[0] == 2 * table.size[0] and door.size[1] == table.size[1]
        left, right = np.split(np.asarray(door.convert("RGB")), 2, axis=1)
    assert np.abs(left[:128].astype(int) - right[:128]).mean() > 2


def test_sizes_and_joints_stand_below_a_picture():
    assert caption(door_model()) == "50 x 40 x 60 cm, 1 joint"
    assert caption(table_model()) == "120 x 80 x 74 cm"
    tile = np.zeros((40, 100, 3), np.uint8)
    long = labelled(tile, "cabinet/" + "x" * 300, "")
    assert long.shape == (74, 100, 3)
    assert np.all(long[40:, :1] == np.rint(PAPER))  # cut, not run out of the tile


def test_tiles_stand_row_by_row():
    tiles = [np.full((10, 12, 3), 20 * i, np.uint8) for i in range(5)]
    whole = grid(tiles, 3)
    assert whole.shape == (36, 60, 3)
    assert whole[9, 10 + 20, 0] == 20 and whole[9 + 18, 10, 0] == 60


def test_what_makes_no_sheet_is_refused(tmp_path):
    with pytest.raises(SettingError, match="0 models"):
        draw_models([], tmp_path / "sheet.png")
    with pytest.raises(SettingError, match="0 columns"):
        draw_models([table_model()], tmp_path / "sheet.png", columns=0)
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match=r"sheet\.png"):
        draw_models([table_model()], tmp_path / "file" / "sheet.png")


def test_every_class_that_models_stand_for_has_a_sheet():
    listed = [name for names in GROUPS.values() for name in names]
    assert len(listed) == len(set(listed))
    assert {info.name for info in classes() if info.functional} <= set(listed)
    odd = dataclasses.replace(table_model(), class_name="stairs")
    groups = grouped([door_model(), odd])
    assert {k: len(v) for k, v in groups.items()} == {"cabinets": 1, REST: 1}
