"""Surfaces: exact distances against trimesh, scores by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from trimesh import Trimesh
from trimesh.proximity import closest_point_naive

from isr_jax.evaluation import SurfaceScores, evaluate
from isr_jax.evaluation.maps.surface_scores import score_surface, surface_rate
from isr_jax.evaluation.maps.true_surface import SITE_M, distance_to_surface, surface_sites
from isr_jax.evaluation.result_files import Result, Truth
from isr_jax.scene_file import SceneFile
from isr_jax.types import Mesh

from .builders import box_mesh
from .evaluation_folders import make_folders, measure_surfaces_fast

FLOAT32 = 1e-6
FAR = 10.0
seeds = st.integers(0, 2**31)


def rectangle(x: float, y: float, z: float = 0.0, start: float = 0.0, cells: int = 1) -> Mesh:
    """A level rectangle from x = start to start + x, two triangles a cell along x."""
    edges = np.linspace(start, start + x, cells + 1)
    vertices = np.array([(e, s, z) for e in edges for s in (0.0, y)], np.float32)
    first = 2 * np.arange(cells)
    faces = np.concatenate(
        [np.stack([first, first + 2, first + 3], 1), np.stack([first, first + 3, first + 1], 1)]
    )
    return Mesh(vertices, faces.astype(np.int32))


def joined(*meshes: Mesh) -> Mesh:
    starts = np.cumsum([0, *(len(m.vertices) for m in meshes[:-1])])
    faces = [m.faces + s for m, s in zip(meshes, starts, strict=True)]
    vertices = np.concatenate([m.vertices for m in meshes])
    return Mesh(vertices, np.concatenate(faces).astype(np.int32))


def by_trimesh(points: np.ndarray, mesh: Mesh) -> np.ndarray:
    """Brute force over all triangles, float64."""
    whole = Trimesh(mesh.vertices, mesh.faces, process=False)
    return closest_point_naive(whole, points)[1]


def random_mesh(rng) -> Mesh:
    """Small and large triangles, needles, and a piece of a fine grid."""
    count = 12
    size = rng.choice([0.01, 0.1, 1.0], (count, 1, 1))
    corners = rng.uniform(-1, 1, (count, 1, 3)) + size * rng.uniform(-1, 1, (count, 3, 3))
    corners[:3, 2] = corners[:3, 1] + 0.001 * rng.uniform(-1, 1, (3, 3))
    loose = Mesh(
        corners.reshape(-1, 3).astype(np.float32),
        np.arange(3 * count, dtype=np.int32).reshape(-1, 3),
    )
    return joined(loose, box_mesh((0.3, 0.2, 0.1), rng.uniform(-1, 1, 3), 0.3, spacing_m=0.01))


@settings(max_examples=8, deadline=None)
@given(seeds)
def test_distance_is_trimeshs_within_the_stated_bound(seed):
    rng = np.random.default_rng(seed)
    mesh = random_mesh(rng)
    near = mesh.vertices[rng.integers(0, len(mesh.vertices), 40)] + rng.normal(0, 0.02, (40, 3))
    points = np.concatenate([near, rng.uniform(-1, 1, (40, 3))])
    found, expected = distance_to_surface(points, mesh, FAR), by_trimesh(points, mesh)
    assert np.all(found >= expected - FLOAT32)
    assert np.all(found <= expected + 2 / 3 * SITE_M + FLOAT32)
    assert np.mean(np.abs(found - expected) < FLOAT32) > 0.9


def test_distance_near_a_fine_surface_is_exact():
    """As a map's surface lies to the truth's: all within a centimetre or two."""
    rng = np.random.default_rng(3)
    mesh = box_mesh((0.5, 0.3, 0.2), (0, 0, 0), 0.4, spacing_m=0.025)
    points = mesh.vertices + rng.normal(0, 0.01, mesh.vertices.shape)
    found = distance_to_surface(points, mesh, 0.5)
    np.testing.assert_allclose(found, by_trimesh(points, mesh), atol=FLOAT32)


def test_distances_are_cut():
    mesh = rectangle(1.0, 1.0)
    points = np.array([[0.5, 0.5, 0.3], [0.5, 0.5, 0.7], [0.5, 0.5, 40.0]])
    np.testing.assert_allclose(distance_to_surface(points, mesh, 0.5), [0.3, 0.5, 0.5], atol=1e-6)
    none = Mesh(np.zeros((0, 3), np.float32), np.zeros((0, 3), np.int32))
    np.testing.assert_array_equal(distance_to_surface(points, none, 0.5), 0.5)


@pytest.mark.parametrize("side", [0.005, 0.03, 0.5])
def test_sites_cover_a_triangle(side):
    """Every point of it has a site within 2/3 of the spacing; n^2 parts of the longest edge."""
    corners = side * np.array([[[0.0, 0, 0], [0.6, 0.8, 0], [1.0, 0, 0]]])
    sites, owner = surface_sites(corners)
    assert len(sites) == np.ceil(side / SITE_M) ** 2 and not owner.any()
    rng = np.random.default_rng(0)
    weights = rng.dirichlet(np.ones(3), 500)
    points = weights @ corners[0]
    gap = np.linalg.norm(points[:, None] - sites[None], axis=-1).min(1)
    assert gap.max() <= 2 / 3 * SITE_M


def scores(truth_mesh: Mesh | None, seen: np.ndarray, result: Mesh) -> SurfaceScores:
    scene = SceneFile((), np.eye(4))
    none = np.zeros(len(seen), np.int64)
    labels = np.zeros(len(result.vertices), np.int64)
    return score_surface(
        Truth(scene, seen, none, None, truth_mesh),
        Result(scene, result.vertices.astype(float), result.faces, labels, labels, np.eye(4)),
    )


def grid(cells: int = 100) -> np.ndarray:
    """Points of the unit square at (k + 1/2) / cells."""
    line = (np.arange(cells) + 0.5) / cells
    x, y = (v.ravel() for v in np.meshgrid(line, line, indexing="ij"))
    return np.stack([x, y, np.zeros_like(x)], 1)


def triples(s: SurfaceScores) -> list[tuple]:
    return [(r.precision, r.recall, r.f_score) for r in s.rates]


def test_a_lifted_floor_by_hand():
    # 15 mm above everywhere: nothing within 1 cm, everything within 2 cm.
    s = scores(rectangle(1, 1), grid(), rectangle(1, 1, z=0.015))
    for figure in ("accuracy_mean_m", "accuracy_median_m", "completeness_mean_m"):
        assert getattr(s, figure) == pytest.approx(0.015, abs=1e-6)
    assert triples(s) == [(0, 0, 0), (1, 1, 1), (1, 1, 1)]


def test_half_a_floor_by_hand():
    # The map ends at x = 0.5. Of the lines x = 0.005, 0.015, ... of the truth, 51 lie within 1 cm
    # of it, 52 within 2 cm, 55 within 5 cm; all of the map is right.
    s = scores(rectangle(1, 1), grid(), rectangle(0.5, 1))
    assert s.accuracy_mean_m == pytest.approx(0, abs=1e-6)
    for rate, recall in zip(s.rates, (0.51, 0.52, 0.55), strict=True):
        assert (rate.precision, rate.recall) == (1.0, pytest.approx(recall))
        assert rate.f_score == pytest.approx(2 * recall / (1 + recall))
    # Lines 50 to 99 lie 0.005, 0.015, ..., 0.495 beyond its end: their mean is 0.25.
    assert s.completeness_mean_m == pytest.approx(0.5 * 0.25, abs=1e-5)
    assert s.completeness_median_m == pytest.approx(0.0025, abs=1e-5)  # between 0 and 5 mm


def test_false_surface_by_hand():
    # As much again 2 m above: half of the map is wrong, by the 0.5 m at which distances are cut.
    s = scores(rectangle(1, 1), grid(), joined(rectangle(1, 1), rectangle(1, 1, z=2.0)))
    assert s.accuracy_mean_m == pytest.approx(0.25, abs=1e-6)
    assert triples(s) == [(0.5, 1, pytest.approx(2 / 3))] * 3


def test_a_side_that_was_not_seen_is_neither_false_nor_missing():
    whole = joined(rectangle(1, 1), rectangle(1, 1, start=3.0))
    assert triples(scores(whole, grid(), whole)) == [(1, 1, 1)] * 3
    assert triples(scores(whole, grid(), rectangle(1, 1))) == [(1, 1, 1)] * 3


def test_density_of_the_map_changes_nothing():
    """A fine false piece weighs by its area: 1 of 5 square metres."""
    good = rectangle(1, 1)
    for cells in (1, 400):
        false = rectangle(0.25, 1, z=1.0, cells=cells)
        s = scores(good, grid(), joined(good, false))
        assert s.rate(0.05).precision == pytest.approx(0.8, abs=1e-3)


def test_without_true_meshes_only_completeness_is_known():
    s = scores(None, grid(), rectangle(0.5, 1))
    assert s.accuracy_mean_m is None and s.accuracy_median_m is None
    assert triples(s)[0] == (None, pytest.approx(0.51), None)
    assert dict(s.headline())["surface F-score at 1 / 2 / 5 cm"] == "- / - / -"


def test_a_distance_equal_to_the_limit_is_within():
    rate = surface_rate(0.02, np.array([0.02, 0.021]), np.array([0.02]))
    assert (rate.precision, rate.recall, rate.f_score) == (0.5, 1.0, pytest.approx(2 / 3))


def test_scores_from_folders(tmp_path: Path, monkeypatch):
    """The truth's meshes are read and joined; without them accuracy is not known."""
    measure_surfaces_fast(monkeypatch, 2000)
    folders = make_folders(tmp_path)
    folders.points[:, 2] += np.where(folders.instance == 1, 0.03, 0).astype(np.float32)
    result = folders.write()
    s = evaluate(result, folders.truth).surface
    # The floor is a slab of 2 cm: its top (9 m^2) and edges (0.24) are 3 cm too high, its underside
    # is 1 cm above the true top. All surface: floor 18.24, walls 24.4, table 4.8, chair 2.3,
    # cabinet 2.17, cups 0.14 m^2. The standard error of 2000 samples is 0.9 %.
    assert 1 - s.rate(0.02).precision == pytest.approx(9.24 / 52.05, abs=0.03)
    assert s.rate(0.05).precision == s.rate(0.05).recall == 1.0
    (folders.truth / "meshes/table_1.ply").unlink()
    assert evaluate(result, folders.truth).surface.rate(0.05).precision < 0.98
    for path in (folders.truth / "meshes").iterdir():
        path.unlink()
    assert evaluate(result, folders.truth).surface.accuracy_mean_m is None
