"""What is seen of boxes, by hand; textures and shadows on known ones; the sheet."""

from __future__ import annotations

import dataclasses
import io
import json
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from isr_jax.borders.raycast import RayScene
from isr_jax.errors import LibraryError, OutputError, SceneError, SequenceError
from isr_jax.robot_model import Texture
from isr_jax.synthetic import NO_NOISE, Room, make_room, render_sequence
from isr_jax.synthetic.camera.free_space import CLEAR_M, FreeSpace, clearance_m, free_space, route
from isr_jax.synthetic.camera.viewpoints import look_along
from isr_jax.synthetic.film.contact_sheet import contact_sheet, depth_colors
from isr_jax.synthetic.film.views import Views
from isr_jax.synthetic.image.patterns import TILE_M, tiles
from isr_jax.synthetic.image.shading import develop, studio
from isr_jax.synthetic.image.shadows import between, lit_share
from isr_jax.synthetic.surface import Surface, room_surfaces
from isr_jax.types import Camera, Mesh

from .builders import box_mesh
from .furniture import block_model, furniture_library

CAMERA = Camera(100.0, 100.0, 63.5, 47.5, 128, 96)
FROM_PLUS_X = look_along(np.array([3.0, 0, 0]), np.array([-1.0, 0, 0]))
"""At x = 3 m, looking at the origin."""


def surface_of(mesh: Mesh) -> Surface:
    faces = len(mesh.faces)
    return Surface(mesh, np.full((faces, 3), 0.5, np.float32), np.zeros(faces, np.int64))


def places(*eyes: tuple[float, float, float]) -> FreeSpace:
    count = len(eyes)
    zeros = np.zeros((count, count))
    return FreeSpace(np.array(eyes, np.float64), zeros.astype(np.int32), zeros)


def views_of(meshes: dict[int, Mesh], space: FreeSpace) -> tuple[Views, RayScene]:
    surfaces = {i: surface_of(mesh) for i, mesh in meshes.items()}
    scene = RayScene(list(meshes.values()), list(meshes))
    return Views(surfaces, scene, space, CAMERA, NO_NOISE, 0), scene


def cube(center=(0.0, 0.0, 0.0), size=(1.0, 1.0, 1.0)) -> Mesh:
    return box_mesh(size, center, spacing_m=10.0)


def shown(views: Views, scene: RayScene, pose: np.ndarray):
    view = scene.view(CAMERA, pose)
    return views.frame(pose, view.instance, view.depth_m)


# ---------------------------------------------------------------------- coverage, by hand


def test_one_side_of_a_cube_is_all_that_one_eye_can_see():
    """One of six equal sides is observable from before it, and a frame of it shows all of that."""
    views, scene = views_of({1: cube()}, places((3, 0, 0)))
    record = views.record({"0": shown(views, scene, FROM_PLUS_X)}, {1: "cube"})
    (entity,) = record["entities"]
    assert entity["observable"] == pytest.approx(1 / 6, abs=0.01)
    assert entity["seen"] == 1.0 and entity["frames"] == 1 and entity["occlusion"] == 0.0
    assert record["room"]["well_seen"] == 1.0


def test_half_of_what_can_be_seen_is_seen_from_one_of_two_sides():
    views, scene = views_of({1: cube()}, places((3, 0, 0), (-3, 0, 0)))
    record = views.record({"0": shown(views, scene, FROM_PLUS_X)}, {1: "cube"})
    (entity,) = record["entities"]
    assert entity["observable"] == pytest.approx(1 / 3, abs=0.01)
    assert entity["seen"] == pytest.approx(0.5, abs=0.02)
    assert record["room"]["well_seen"] == 0.0


def test_pixels_of_a_cube_alone_and_behind_another():
    """Its side is 2.5 m away: 40 x 40 pixels. A screen at 1 m hides the half with y > 0."""
    views, scene = views_of({1: cube()}, places((3, 0, 0)))
    alone = shown(views, scene, FROM_PLUS_X).entities[1]
    assert alone.visible_px == pytest.approx(1600, abs=82) and not alone.cut
    assert alone.unoccluded_px == pytest.approx(alone.visible_px, rel=0.06)
    screen = cube((2.0, 1.0, 0.0), (0.02, 2.0, 3.0))
    views, scene = views_of({1: cube(), 2: screen}, places((3, 0, 0)))
    frame = shown(views, scene, FROM_PLUS_X)
    assert frame.entities[1].visible_px == pytest.approx(800, abs=42)
    assert frame.entities[1].unoccluded_px == alone.unoccluded_px
    record = views.record({"0": frame}, {1: "cube", 2: "screen"})
    assert record["entities"][0]["occlusion"] == pytest.approx(0.5, abs=0.04)
    assert frame.entities[2].cut  # 4 m of screen do not fit into the image


def test_what_is_hidden_altogether_is_listed_without_visible_pixels():
    views, scene = views_of(
        {1: cube(), 2: cube((2.0, 0.0, 0.0), (0.02, 3.0, 3.0))}, places((3, 0, 0))
    )
    frame = shown(views, scene, FROM_PLUS_X)
    assert frame.entities[1].visible_px == 0 and frame.entities[1].unoccluded_px > 1400
    assert views.record({"0": frame}, {1: "a", 2: "b"})["entities"][0]["seen"] is None


def test_the_border_cuts_what_it_crosses():
    views, scene = views_of({1: cube((0.0, 1.6, 0.0))}, places((3, 0, 0)))
    view = shown(views, scene, FROM_PLUS_X).entities[1]
    # Right (towards +y) are 64 pixels: y < 1.6 m at 2.5 m, half of the side; and some of another.
    assert view.cut and 0 < view.visible_px == view.unoccluded_px


def test_nothing_behind_the_camera_is_listed():
    views, scene = views_of({1: cube((5.0, 0, 0)), 2: cube()}, places((3, 0, 0)))
    assert set(shown(views, scene, FROM_PLUS_X).entities) == {2}


# ---------------------------------------------------------------------- a room


@pytest.fixture(scope="module")
def room() -> Room:
    return make_room(1, furniture_library())


@pytest.fixture(scope="module")
def sequence(room: Room, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("views")
    render_sequence(room, out, frames=48, width=160, height=120)
    return out


def test_the_walk_shows_nearly_everything_well(room, sequence):
    record = json.loads((sequence / "truth/views.json").read_text())
    assert record["room"]["well_seen"] >= 0.85
    assert 0.0 < record["room"]["occlusion"] < 0.6
    assert {e["id"] for e in record["entities"]} == {e.id for e in (*room.layout, *room.items)}


def test_visible_pixels_are_those_of_the_images(sequence):
    record = json.loads((sequence / "truth/views.json").read_text())["frames"]
    for name in ("000000", "000030", "000047"):
        image = cv2.imread(str(sequence / f"panoptic/{name}.png"))
        area = np.bincount((image[..., 2] + 256 * image[..., 1].astype(int)).ravel())
        listed = {int(i): v for i, v in record[name].items()}
        for i in np.flatnonzero(area[1:]) + 1:
            assert listed[i]["visible_px"] == area[i] <= listed[i]["unoccluded_px"]


def test_a_room_that_is_full_has_no_place_for_a_camera(room):
    block = block_model("sofa/a", (20.0, 20.0, 20.0))
    item = dataclasses.replace(room.items[0], model=block, scale=1.0)
    with pytest.raises(SceneError, match="no place"):
        free_space(dataclasses.replace(room, items=(item,)), 0)


def test_ways_between_places_stay_clear(room):
    space = free_space(room, 0)
    rng = np.random.default_rng(0)
    for a, b in rng.integers(0, len(space.eyes), (12, 2)):
        points = route(room, space, int(a), int(b))
        np.testing.assert_array_equal(points[[0, -1]], space.eyes[[a, b]])
        fine = [p + s * (q - p) for p, q in pairwise(points) for s in np.linspace(0, 1, 50)]
        if fine:
            assert clearance_m(room, np.array(fine)).min() > CLEAR_M


# ---------------------------------------------------------------------- textures and light

COLORS = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]], np.uint8)
"""Top left red, top right green, bottom left blue, bottom right white."""


def png(pixels: np.ndarray) -> Texture:
    written = io.BytesIO()
    Image.fromarray(pixels).save(written, "PNG")
    return Texture("known.png", written.getvalue())


def quad(z: float = 0.0) -> Mesh:
    """The unit square, faced upwards."""
    corners = np.array([[0, 0, z], [1, 0, z], [1, 1, z], [0, 1, z]], np.float32)
    return Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]], np.int32))


def look_down(room: Room, surface: Surface, x: np.ndarray, y: np.ndarray):
    """Colours of points of a surface as seen from above."""
    scene = RayScene([surface.mesh], [1])
    eye = np.array([0.5, 0.5, 1.0], np.float32)
    directions = np.stack([x, y, np.zeros_like(x)], 1).astype(np.float32) - eye
    hits, barycentric = scene.cast_into(np.tile(eye, (len(x), 1)), directions)
    assert np.all(hits.triangle >= 0)
    light = studio(room, ["box"], [surface], scene.normals)
    lit = np.ones(len(x), np.float32)
    return develop(light, eye, directions, hits.distance, hits.triangle, barycentric, lit)


def textured(texture: Texture, gain: float = 1.0) -> Surface:
    uv = quad().vertices[quad().faces][..., :2].astype(np.float32)
    mean = COLORS.reshape(-1, 3).mean(0) / 255
    rgb = np.tile(gain * mean, (2, 1)).astype(np.float32)
    rows = np.zeros(2, np.int64)
    return Surface(quad(), rgb, rows, uv, rows, (texture,))


def test_texels_are_where_their_coordinates_say(room):
    """u goes right, v goes up from the image's lower edge; one texel is a quarter of the quad."""
    x, y = (a.ravel() for a in np.meshgrid([0.1, 0.4, 0.6, 0.9], [0.1, 0.4, 0.6, 0.9]))
    seen = np.asarray(look_down(room, textured(png(COLORS)), x, y).rgb)
    expected = COLORS[(y < 0.5).astype(int), (x > 0.5).astype(int)] > 0
    np.testing.assert_array_equal(seen > 0, expected)


def test_the_tint_dims_a_texture(room):
    x, y = np.array([0.25]), np.array([0.25])
    bright = look_down(room, textured(png(COLORS), 1.0), x, y)
    dim = look_down(room, textured(png(COLORS), 0.5), x, y)
    assert float(dim.albedo[0]) == pytest.approx(0.5 * float(bright.albedo[0]), rel=1e-4)


def test_a_texture_that_is_no_image_is_refused_by_name(room):
    with pytest.raises(LibraryError, match=r"broken\.png"):
        look_down(room, textured(Texture("broken.png", b"nonsense")), np.zeros(1), np.zeros(1))


def test_tiles_repeat_and_keep_the_colour():
    made = tiles()
    assert len(made) == len(TILE_M)
    np.testing.assert_allclose(made.mean((1, 2)), 1.0, atol=0.02)
    assert np.all(made[0] == 1.0) and np.all(made[1:].std((1, 2)) > 0.01)


def test_a_board_throws_its_shadow_on_the_floor():
    """A lamp 2 m above a floor, a board of 0.2 m half way: the shadow is 0.4 m wide."""
    floor, board = cube((0, 0, -0.05), (4, 4, 0.1)), cube((0, 0, 1.0), (0.2, 0.2, 0.01))
    scene = RayScene([floor, board], [1, 2])
    at = np.linspace(-1, 1, 81).astype(np.float32)
    x, y = np.meshgrid(at, at, indexing="ij")
    points = np.stack([x, y, np.zeros_like(x)], -1)
    normal = np.broadcast_to(np.float32([0, 0, 1]), points.shape)
    lit = lit_share(scene, np.float32([0, 0, 2]), points, normal, (162, 162))[::2, ::2]
    dark = (np.abs(x) < 0.195) & (np.abs(y) < 0.195)
    light = (np.abs(x) > 0.21) | (np.abs(y) > 0.21)
    assert np.all(lit[dark] == 0) and np.all(lit[light] == 1)


@pytest.mark.parametrize("length", [5, 6])
def test_between_samples_lies_their_mean(length):
    samples = np.float32([[0.0, 1.0, 0.0]])
    np.testing.assert_allclose(between(samples, 1, length)[0], [0, 0.5, 1, 0.5, 0, 0][:length])


# ---------------------------------------------------------------------- the sheet


def test_the_sheet_shows_frames_and_rows(sequence, tmp_path: Path):
    contact_sheet(sequence, tmp_path / "sheet.png", frames=3)
    sheet = cv2.imread(str(tmp_path / "sheet.png"))
    assert sheet.shape == (4 * 180 + 3 * 4, 22 + 3 * 240 + 2 * 4, 3)
    first = sheet[:180, 22 : 22 + 240].astype(int)
    frame = cv2.resize(cv2.imread(str(sequence / "rgb/000000.jpg")), (240, 180))
    assert np.abs(first - frame).mean() < 3
    contact_sheet(sequence, tmp_path / "again.png", frames=3)
    assert (tmp_path / "again.png").read_bytes() == (tmp_path / "sheet.png").read_bytes()


def test_depth_is_red_near_blue_far_and_black_where_none():
    near, far, none = depth_colors(np.float32([[0.3, 4.4, 0.0]]))[0].astype(int)
    assert near[0] > near[2] and far[2] > far[0] and np.all(none == 0)


def test_a_sheet_of_nothing_is_refused(sequence, tmp_path: Path):
    with pytest.raises(SequenceError, match="no frames"):
        contact_sheet(tmp_path, tmp_path / "sheet.png")
    with pytest.raises(OutputError, match="sheet"):
        contact_sheet(sequence, tmp_path / "sheet.nonsense", frames=1)


def test_surfaces_of_a_room_are_its_entities(room):
    assert set(room_surfaces(room)) == {e.id for e in (*room.layout, *room.items)}
