"""Collision hulls of imported models: close to the surface, convex, parted, kept, repeatable."""

from __future__ import annotations

import dataclasses
import sys

import numpy as np
import pytest

from isr_jax.cad import collision
from isr_jax.cad.collision import with_hulls
from isr_jax.cad.hulls.decompose import coacd_pieces
from isr_jax.cad.hulls.link_hulls import MAX_HULLS, METHODS, LinkHulls, bound_m, link_hulls
from isr_jax.cad.hulls.merging import merged
from isr_jax.cad.hulls.model_hulls import link_shapes, model_hulls
from isr_jax.cad.hulls.packing import (
    packed_hulls,
    packed_shapes,
    unpacked_hulls,
    unpacked_shapes,
)
from isr_jax.cad.hulls.parting import GAP_M, parted
from isr_jax.cad.hulls.slicing import clipped, slices
from isr_jax.cad.hulls.solid import MAX_VERTICES, Hull, cut, hull_of
from isr_jax.cad.hulls.swelling import Reference
from isr_jax.cad.hulls.worker import Worker
from isr_jax.cad.importing.converting.convert import convert
from isr_jax.cad.importing.found import FoundModel
from isr_jax.cad.kit import KIT, make
from isr_jax.errors import SettingError
from isr_jax.geometry import convex_part, moved_part, penetration
from isr_jax.robot_model import link_transforms
from isr_jax.types import Mesh

from .test_cad_convert import block, cabinet_robot, chair_mesh, found_of, joined, rigid

UP = np.array([0.0, 0, 1])


def chair():
    return convert(found_of(chair_mesh(), "chair", up=UP))


def cabinet():
    return convert(FoundModel("cabinet", "c.urdf", cabinet_robot(), up=UP))


def hull_arrays(model) -> list[np.ndarray]:
    return [hull.vertices for link in model.robot.links for hull in link.hulls]


def is_convex(mesh: Mesh) -> bool:
    points = mesh.vertices.astype(np.float64)
    corners = points[mesh.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    above = (points[None] - corners[:, :1]) @ normal[..., None]
    return bool(above.max() < 1e-5)


def tube(radius: float, height: float, sides: int = 16) -> Mesh:
    """An open sheet: the wall of a cylinder alone."""
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([radius * np.cos(angle), radius * np.sin(angle)], 1)
    points = np.concatenate([np.c_[ring, np.zeros(sides)], np.c_[ring, np.full(sides, height)]])
    k, n = np.arange(sides), (np.arange(sides) + 1) % sides
    faces = np.concatenate([np.stack([k, n, n + sides], 1), np.stack([k, n + sides, k + sides], 1)])
    return Mesh(points.astype(np.float32), faces.astype(np.int32))


def test_parts_of_furniture_that_are_convex_have_their_exact_hulls():
    model = with_hulls([chair()], "coacd", workers=0, cache_dir=None)[0]
    hulls = model.robot.links[0].hulls
    assert len(hulls) == 6 and model.swelling_m < 1e-5 and model.collision == "coacd"
    volume = sum(hull_of(hull.vertices).volume for hull in hulls)
    exact = 4 * 0.04 * 0.04 * 0.43 + 0.42 * 0.44 * 0.03 + 0.42 * 0.03 * 0.44
    assert volume == pytest.approx(exact, rel=1e-4)


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.mark.parametrize("method", [pytest.param("coacd", marks=pytest.mark.slow), "vhacd"])
def test_open_sheets_keep_their_hollow(method):
    mesh = tube(0.2, 0.4)
    made = made_of(mesh, method)
    assert 4 <= len(made.hulls) <= MAX_HULLS
    middle = np.array([[0.0, 0, 0.2], [0.1, 0, 0.2], [0, -0.1, 0.1]])
    assert all(hull.height(middle).min() > 0.03 for hull in made.hulls), "the hollow is free"
    on_wall = np.array(
        [[0.195 * np.cos(a), 0.195 * np.sin(a), 0.2] for a in np.arange(0, 6.2, 0.3)]
    )
    distance = np.min([hull.height(on_wall) for hull in made.hulls], axis=0)
    assert distance.max() < 0.02, "the wall is covered"
    assert made.swelling_m <= 3 * bound_m(np.array([0.4, 0.4, 0.4]))
    assert all(is_convex(h.mesh()) and len(h.points) <= MAX_VERTICES for h in made.hulls)


def test_one_welded_body_of_boards_is_cut_into_its_boards():
    """A table cut out of one piece: the room under it stays free, whichever method."""
    top, legs = (1.2, 0.7, 0.04), [(x, y) for x in (-0.57, 0.57) for y in (-0.32, 0.32)]
    mesh = joined(block(top, (0, 0, 0.73)), *(block((0.06, 0.06, 0.71), (*c, 0.355)) for c in legs))
    soup = mesh.vertices[mesh.faces].astype(np.float64)
    bound = bound_m(np.array([1.2, 0.7, 0.75]))
    pieces = [hull_of(points) for points in slices(soup, bound, 32)]
    reference = Reference(soup)
    assert max(float(reference.heights(h, pieces).max()) for h in pieces) <= bound
    below = np.array([[0.0, 0, 0.3], [0.4, 0.1, 0.6]])
    assert all(h.height(below).min() > 0.05 for h in pieces)


def test_clipping_keeps_the_area_and_the_side():
    rng = np.random.default_rng(0)
    corners = rng.normal(size=(50, 3, 3))

    def area(triangles):
        edges = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
        return np.linalg.norm(edges, axis=1).sum() / 2

    for axis in range(3):
        below, above = clipped(corners, axis, 0.1)
        assert below[..., axis].max() <= 0.1 + 1e-12 and above[..., axis].min() >= 0.1 - 1e-12
        assert area(below) + area(above) == pytest.approx(area(corners))


def test_swelling_is_how_far_a_hull_stands_off_the_surface():
    cube = block((1.0, 1.0, 1.0))
    reference = Reference(cube.vertices[cube.faces].astype(np.float64))
    for margin in (0.0, 0.05):
        grown = hull_of(cube.vertices.astype(float) * (1 + 2 * margin))
        # Corners stand farther off than faces do, by the square root of three, and samples differ.
        assert margin - 1e-3 <= reference.heights(grown).max() <= 2.2 * margin + 1e-3
    inside = hull_of(cube.vertices.astype(float) * 0.5)
    assert reference.heights(inside).max() == 0, "nothing gets into a closed body"


def test_hulls_have_few_corners_a_volume_and_what_was_cut_is_gone():
    rng = np.random.default_rng(1)
    ball = rng.normal(size=(3000, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    hull = hull_of(ball)
    assert len(hull.points) <= MAX_VERTICES and is_convex(hull.mesh())
    assert 0.85 < hull.volume / (4 / 3 * np.pi) < 1.0
    flat = hull_of(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]))
    assert flat.volume == pytest.approx(0.002, rel=1e-3)
    line = hull_of(np.array([[0.0, 0, 0], [1, 1, 1]]))
    assert line.volume > 0
    box = hull_of(block((1, 1, 1)).vertices)
    half = cut(box, np.array([1.0, 0, 0]), 0.25)
    assert half is not None and half.volume == pytest.approx(0.75, rel=1e-5)
    assert cut(box, np.array([1.0, 0, 0]), -0.5) is None
    assert cut(box, np.array([1.0, 0, 0]), 0.5) is box


def test_merging_joins_what_is_one_convex_body_and_nothing_else():
    halves = [hull_of(block((0.5, 1, 0.1), (x, 0, 0)).vertices) for x in (-0.25, 0.25)]
    apart = hull_of(block((1, 1, 0.1), (0, 0, 1)).vertices)
    small = hull_of(block((0.1, 0.1, 0.05)).vertices)
    hulls, used = merged([*halves, apart, small], 0.005, 64)
    assert sorted(round(h.volume, 5) for h in hulls) == [0.1, 0.1] and used == 0.005
    many = [hull_of(block((0.1, 0.1, 0.1), (0.15 * k, 0, 0)).vertices) for k in range(12)]
    hulls, used = merged(many, 0.001, 4)
    assert len(hulls) <= 4 and used > 0.001


def overlaps(model) -> float:
    """Deepest overlap between hulls of different links, joints at rest, metres."""
    poses = link_transforms(model.robot)
    parts = [
        [moved_part(convex_part(h.vertices.astype(float)), poses[link.name]) for h in link.hulls]
        for link in model.robot.links
    ]
    return max(
        penetration(a, b)[0]
        for i in range(len(parts))
        for j in range(i)
        for a in parts[i]
        for b in parts[j]
    )


def test_no_part_of_a_model_presses_on_another():
    robot = cabinet_robot()
    # The door reaches 15 mm into a side of the carcass in this file.
    T = robot.joints[0].T_parent_child.copy()
    T[:2, 3] -= (0.03, 0.015)
    hinge = dataclasses.replace(robot.joints[0], T_parent_child=T)
    robot = dataclasses.replace(robot, joints=(hinge, robot.joints[1]))
    model = convert(FoundModel("cabinet", "c.urdf", robot, up=UP))
    made = with_hulls([model], "vhacd", workers=0)[0]
    assert overlaps(made) < 1e-6
    assert all(link.hulls for link in made.robot.links)
    assert any("cut apart" in note for note in made.notes)


def test_parting_leaves_the_stated_gap_and_separate_hulls_alone():
    a, b = hull_of(block((1, 1, 1)).vertices), hull_of(block((1, 1, 1), (0, 0, 0.9)).vertices)
    (left, right), depth = parted([[a], [b]], np.stack([np.eye(4)] * 2)[None])
    assert depth == pytest.approx(0.1, abs=1e-6)
    gap = right[0].low[2] - left[0].high[2]
    assert gap == pytest.approx(GAP_M, abs=1e-6)
    moved = np.eye(4)
    moved[2, 3] = 2.0
    (same, other), depth = parted([[a], [b]], np.stack([np.eye(4), moved])[None])
    assert depth == 0 and same[0] is a and other[0] is b


def test_what_a_joint_would_scrape_is_cut_and_what_is_in_its_way_stays():
    a, b = hull_of(block((1, 1, 1)).vertices), hull_of(block((1, 1, 1), (0, 0, 2.0)).vertices)
    for sink, touched in ((1.01, True), (1.1, False)):
        opened = np.eye(4)
        opened[2, 3] = -sink
        poses = np.array([[np.eye(4), np.eye(4)], [np.eye(4), opened]])
        (left, right), depth = parted([[a], [b]], poses)
        assert depth == 0 and (left[0] is not a) == touched
        gap = right[0].low[2] - sink - left[0].high[2]
        assert gap == pytest.approx(GAP_M if touched else -0.1, abs=1e-6)


def test_kit_models_and_stated_hulls_stay_as_they_are():
    kit = make(next(iter(KIT)))
    stated = dataclasses.replace(chair(), collision="stated")
    assert with_hulls([kit, stated], "coacd", workers=0) == [kit, stated]


def test_fast_hulls_are_replaced_by_better_ones_and_never_the_other_way():
    fast = with_hulls([chair()], "vhacd", workers=0)[0]
    assert fast.collision == "vhacd" and with_hulls([fast], "vhacd", workers=0)[0] is fast
    better = with_hulls([fast], "coacd", workers=0)[0]
    assert better.collision == "coacd" and with_hulls([better], "vhacd", workers=0)[0] is better


def test_an_unknown_method_names_the_known_ones():
    with pytest.raises(SettingError, match="coacd or vhacd"):
        with_hulls([], "hacd", workers=0)


def test_hulls_come_from_the_cache_the_second_time(tmp_path, monkeypatch):
    first = with_hulls([chair()], "vhacd", workers=0, cache_dir=tmp_path)[0]
    assert len(list(tmp_path.rglob("*.npz"))) == 1

    def never(*_):
        raise AssertionError("made again")

    monkeypatch.setattr(collision, "_made", never)
    second = with_hulls([chair()], "vhacd", workers=0, cache_dir=tmp_path)[0]
    assert all(np.array_equal(a, b) for a, b in zip(hull_arrays(first), hull_arrays(second)))
    assert (first.swelling_m, first.notes) == (second.swelling_m, second.notes)


def test_a_damaged_cache_file_is_made_again(tmp_path):
    with_hulls([chair()], "vhacd", workers=0, cache_dir=tmp_path)
    (file,) = tmp_path.rglob("*.npz")
    file.write_bytes(file.read_bytes()[:100])
    model = with_hulls([chair()], "vhacd", workers=0, cache_dir=tmp_path)[0]
    assert len(model.robot.links[0].hulls) == 6


def test_worker_processes_give_the_same_hulls_and_report_progress(tmp_path):
    steps: list[tuple[int, int]] = []
    models = [chair(), cabinet()]
    here = with_hulls(models, "vhacd", workers=0, cache_dir=tmp_path / "a")
    there = with_hulls(
        models,
        "vhacd",
        workers=1,
        cache_dir=tmp_path / "b",
        progress=lambda done, total: steps.append((done, total)),
    )
    for a, b in zip(here, there):
        assert len(hull_arrays(a)) == len(hull_arrays(b)) > 0
        assert all(np.array_equal(x, y) for x, y in zip(hull_arrays(a), hull_arrays(b)))
    assert steps == [(1, 2), (2, 2)]


@pytest.mark.parametrize("code", ["raise SystemExit(1)", "import time; time.sleep(60)"])
def test_a_worker_that_dies_or_hangs_gives_nothing_and_starts_again(code):
    worker = Worker(0.5, (sys.executable, "-c", code))
    try:
        assert worker.ask(b"task") is None
        worker.command = (sys.executable, "-c", _ECHO)
        worker.timeout_s = 60.0
        assert worker.ask(b"task") == b"task"
    finally:
        worker.close()


_ECHO = """
import sys
head = sys.stdin.buffer.read(8)
sys.stdout.buffer.write(head + sys.stdin.buffer.read(int.from_bytes(head, "little")))
sys.stdout.flush()
sys.stdin.buffer.read()
"""


def test_where_every_worker_dies_each_link_has_its_convex_hull(monkeypatch):
    monkeypatch.setattr(Worker, "ask", lambda self, task: None)
    model = with_hulls([chair()], "coacd", workers=1)[0]
    assert len(model.robot.links[0].hulls) == 1
    assert any("one convex hull" in note for note in model.notes)
    assert model.swelling_m > 0.3


def test_a_decomposition_that_fails_falls_back_and_says_so(monkeypatch):
    def fails(*_):
        raise RuntimeError("no")

    monkeypatch.setattr("isr_jax.cad.hulls.link_hulls.coacd_pieces", fails)
    mesh = tube(0.2, 0.4)
    made = made_of(mesh, "coacd")
    assert len(made.hulls) > 3 and any("coacd failed" in note for note in made.notes)
    monkeypatch.setattr("isr_jax.cad.hulls.link_hulls.slices", fails)
    made = made_of(mesh, "coacd")
    assert len(made.hulls) == 1 and any("convex hull" in note for note in made.notes)


def test_tasks_and_results_survive_their_bytes():
    shapes = link_shapes(cabinet().robot)
    again, method = unpacked_shapes(packed_shapes(shapes, "coacd"))
    assert method == "coacd" and [s.name for s in again] == [s.name for s in shapes]
    assert all(np.array_equal(a.vertices, b.vertices) for a, b in zip(shapes, again))
    hulls = model_hulls(shapes, "vhacd")
    assert packed_hulls(unpacked_hulls(packed_hulls(hulls))) == packed_hulls(hulls)
    with pytest.raises(ValueError):
        unpacked_hulls(b"nothing")


def test_links_without_a_surface_have_no_hulls():
    robot = cabinet_robot()
    empty = dataclasses.replace(robot.links[2], visuals=())
    shapes = link_shapes(dataclasses.replace(robot, links=(*robot.links[:2], empty)))
    made = model_hulls(shapes, "vhacd")
    assert made.links[2] == () and made.links[0]


def made_of(mesh: Mesh, method: str = "vhacd") -> LinkHulls:
    shape = link_shapes(rigid(mesh))[0]
    return link_hulls(shape.vertices, shape.faces, METHODS[method])


def test_coacd_parts_an_l_and_does_the_same_each_time():
    ell = joined(block((0.6, 0.2, 0.2)), block((0.2, 0.2, 0.5), (-0.2, 0, 0.35)))
    closed = Mesh(ell.vertices, ell.faces)
    corner = np.array([[0.2, 0.0, 0.4]])
    shape = link_shapes(rigid(closed))[0]
    pieces = [coacd_pieces(shape.vertices, shape.faces, 0.02, 8) for _ in range(2)]
    assert all(hull_of(points).height(corner).min() > 0.05 for points in pieces[0])
    assert len(pieces[0]) >= 2
    assert all(np.array_equal(a, b) for a, b in zip(*pieces))


def volume_of(hulls: list[Hull]) -> float:
    return sum(hull.volume for hull in hulls)


def test_small_screws_do_not_collide():
    screws = [block((0.002, 0.002, 0.002), (x, 0.0, 0.5)) for x in np.linspace(-0.2, 0.2, 9)]
    mesh = joined(block((0.5, 0.5, 0.9), (0, 0, 0.45)), *screws)
    made = made_of(mesh)
    assert len(made.hulls) == 1 and volume_of(made.hulls) == pytest.approx(0.225, rel=1e-4)
