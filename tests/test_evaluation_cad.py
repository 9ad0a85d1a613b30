"""Retrieval, alignment accuracy and surface distance of placed models, by hand and by twins."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from isr_jax.errors import SceneError
from isr_jax.evaluation.models.cad_alignment import AlignmentLimits
from isr_jax.evaluation.models.cad_cases import CadCase, PosedModel, model_named
from isr_jax.evaluation.models.chamfer import (
    ChamferRow,
    ChamferScores,
    Surface,
    mean_distance_m,
    model_surface,
    surface_distance,
    surface_distances,
)
from isr_jax.evaluation.models.retrieval import (
    HIT_M,
    best_candidates,
    fitted_distance_m,
    fitted_scale,
    score_retrieval,
)
from isr_jax.evaluation.models.scan2cad import (
    AlignmentAccuracy,
    ClassCount,
    PosedCad,
    official_hits,
    score_scan2cad,
    strict_hits,
)
from isr_jax.geometry import CUBE_ROTATIONS, canonical_box
from isr_jax.geometry.surface_samples import surface_samples
from isr_jax.library import CadModel
from isr_jax.scene_file import CadRecord, EntityRecord
from isr_jax.types import Candidate

from .builders import box_mesh, library_of, rotation_z, table_model
from .furniture import block_model, chair_model
from .reference import cad_measures_reference as slow

ONES = np.ones(3)
LIMITS = AlignmentLimits()
EXACT_M = 1e-5
"""Float32 coordinates of a metre, and the root of their squares."""
SAMPLED = 0.05
"""Relative error of a mean over 512 stratified points."""


def square(z: float, side: float = 1.0) -> Surface:
    """A square across the z axis."""
    corners = side * np.array([[-0.5, -0.5, 0], [0.5, -0.5, 0], [0.5, 0.5, 0], [-0.5, 0.5, 0]])
    corners[:, 2] = z
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    points = surface_samples(corners, faces).points
    return Surface(points, corners[faces].astype(np.float32))


def pose(yaw: float = 0.0, center=(0.0, 0.0, 0.0)) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation_z(yaw), center
    return T


# -- surfaces -----------------------------------------------------------------------------------


@pytest.mark.parametrize("d", [0.0, 0.02, 0.5])
def test_parallel_squares_lie_their_distance_apart(d):
    found = surface_distance(square(0.0), square(d))
    assert found is not None
    assert found.forward_m == pytest.approx(d, abs=EXACT_M)
    assert found.two_way_m == pytest.approx(d, abs=EXACT_M)


def test_the_ways_differ_where_one_surface_has_more():
    # Every point of the small square lies on the large one. Of the large one (side 2, 4 m^2) the
    # small one lacks 4 strips of 1 x 0.5 m, on average 0.25 m away, and 4 corners of 0.5 x 0.5 m,
    # whose mean distance to their inner corner is 0.5 * 0.76520 (mean distance in a unit square
    # from a corner: (sqrt 2 + ln(1 + sqrt 2)) / 3): (2 * 0.25 + 1 * 0.38260) / 4 = 0.22065.
    found = surface_distance(square(0.0, 1.0), square(0.0, 2.0))
    assert found is not None and found.forward_m == pytest.approx(0.0, abs=EXACT_M)
    assert found.backward_m == pytest.approx(0.22065, rel=SAMPLED)
    assert found.two_way_m == pytest.approx(0.22065 / 2, rel=SAMPLED)


@pytest.mark.parametrize("d", [0.02, 0.1])
def test_a_cube_shifted_along_a_side(d):
    # Unit cube moved by d along x. The side left behind lies d away. The side within lies at
    # min(d, e), e to the nearest of its own edges: d (1 - 2d)^2 + (2 d^2 - 8/3 d^3). The four
    # others coincide but for a strip of width d, on average d / 2 away. Each of the six counts 1.
    within = d * (1 - 2 * d) ** 2 + 2 * d**2 - 8 / 3 * d**3
    expected = (d + within + 4 * d * d / 2) / 6
    cube = block_model("box/cube", (1.0, 1.0, 1.0))
    still, moved = (model_surface(cube, pose(0, (x, 0, 0)), ONES) for x in (0.0, d))
    found = surface_distance(still, moved)
    assert found is not None
    assert found.forward_m == pytest.approx(expected, rel=SAMPLED)
    assert found.two_way_m == pytest.approx(expected, rel=SAMPLED)


def test_distances_as_their_twin():
    rng = np.random.default_rng(3)
    triangles = rng.normal(0, 0.4, (300, 3, 3)).astype(np.float32) + 5.0
    triangles[7] = triangles[7, :1]  # a point
    triangles[9, 2] = triangles[9, 1]  # a needle
    points = (rng.normal(0, 0.6, (8, 3)) + 5.0).astype(np.float32)
    found = surface_distances(points, triangles)
    np.testing.assert_allclose(found, slow.surface_distances(points, triangles), atol=EXACT_M)


def test_more_points_than_a_tile_and_none_at_all():
    points = np.linspace([0, 0, 1], [0, 0, 3], 700).astype(np.float32)
    one = square(0.0).triangles
    far = one + np.array([0.0, 0.0, 9.0], np.float32)
    for others in (0, 200, 2000):  # one tile, some small ones, large ones
        triangles = np.concatenate([np.repeat(far, others, 0), one])
        found = surface_distances(points, triangles)
        np.testing.assert_allclose(found, points[:, 2], atol=2 * EXACT_M)
    empty = Surface(np.zeros((0, 3), np.float32), np.zeros((0, 3, 3), np.float32))
    assert surface_distances(empty.points, square(0.0).triangles).shape == (0,)
    assert mean_distance_m(points, empty) is None
    assert surface_distance(square(0.0), empty) is None


def test_a_rigid_motion_of_both_changes_nothing():
    chair, table = chair_model(), table_model()
    T = pose(0.7, (3.0, -2.0, 0.4))
    rows = []
    for world in (np.eye(4), T):
        a = model_surface(chair, world, 1.2 * ONES)
        b = model_surface(table, world @ pose(0.3, (0.2, 0.0, 0.0)), ONES)
        found = surface_distance(a, b)
        assert found is not None
        rows.append((found.forward_m, found.backward_m))
    np.testing.assert_allclose(rows[0], rows[1], atol=1e-4)


def test_medians_over_models_and_classes():
    def row(name, class_name, two_way):
        return ChamferRow(name, class_name, "x", 0.01, None, two_way, two_way, two_way)

    rows = (
        row("a", "cup", 0.01),
        row("b", "cup", 0.03),
        row("c", "cup", 0.02),
        row("d", "bed", 1.0),
    )
    found = ChamferScores.over(rows)
    assert found.two_way_median_m == pytest.approx(0.025)
    assert {n: (c.models, c.two_way_m) for n, c in found.by_class.items()} == {
        "bed": (1, 1.0),
        "cup": (3, 0.02),
    }
    assert found.by_class["cup"].alignment_error_m == 0.01
    assert found.class_two_way_m == pytest.approx(0.51)
    assert found.seen_to_placed_median_m is None
    assert ChamferScores.over(()).two_way_median_m is None


# -- retrieval ----------------------------------------------------------------------------------


def test_the_fitted_scale_is_least_squares():
    # d/ds sum (t - s b)^2 = 0  =>  s = t.b / b.b = (2*1 + 2*2) / (1 + 4) = 1.2
    assert fitted_scale(np.array([2.0, 2.0, 0.0]), np.array([1.0, 2.0, 0.0])) == pytest.approx(1.2)


@pytest.mark.parametrize("row", [0, 1, 2, 7, 13])
def test_a_turned_and_scaled_copy_fits_exactly(row):
    chair, R = chair_model(), CUBE_ROTATIONS[row]
    copy = with_mesh(chair, chair.mesh.vertices @ R.T * 0.5, np.abs(R) @ chair.size * 0.5)
    found = fitted_distance_m(chair, 1.3 * ONES, copy)
    assert found is not None and found < 1e-4


def with_mesh(model: CadModel, vertices: np.ndarray, size: np.ndarray) -> CadModel:
    """The model with other visible vertices, as another model."""
    (link,) = model.robot.links
    starts = np.cumsum([0, *(len(v.mesh.vertices) for v in link.visuals)])
    visuals = tuple(
        dataclasses.replace(
            v, mesh=dataclasses.replace(v.mesh, vertices=vertices[a:b].astype(np.float32))
        )
        for v, a, b in zip(link.visuals, starts[:-1], starts[1:], strict=True)
    )
    robot = dataclasses.replace(model.robot, links=(dataclasses.replace(link, visuals=visuals),))
    return dataclasses.replace(
        model,
        id=f"{model.id}_copy",
        content_hash=f"{model.id}_copy",
        load_robot=lambda: robot,
        size=np.asarray(size, np.float32),
    )


def test_longer_blocks_are_farther():
    cube = block_model("box/a", (0.4, 0.4, 0.4))
    found = [
        fitted_distance_m(cube, ONES, block_model("box/b", (0.4 * k, 0.4, 0.4)))
        for k in (1.0, 1.1, 1.5, 3.0)
    ]
    assert found == sorted(found) and found[0] < EXACT_M and found[1] < HIT_M < found[3]


def candidate(id: str, error: float, rotation: int = 0) -> Candidate:
    return Candidate(id, rotation, error, 0.01, "converged", None)


def test_candidates_rank_by_matching_error_each_once():
    rows = [candidate("b", 0.2), candidate("a", 0.1), candidate("b", 0.15, 1)]
    rows += [candidate(f"x{i:02}", 1.0 + i) for i in range(12)]
    assert best_candidates(rows) == ["a", "b", *(f"x{i:02}" for i in range(8))]


def case_of(true: CadModel, placed: CadModel | None, T=None, found=True, candidates=()) -> CadCase:
    """A thing at the origin, and what stands for it at ``T``."""
    box = canonical_box(np.zeros(3), 0.0, true.size)

    def record(model: CadModel | None) -> EntityRecord:
        cad = None if model is None else CadRecord(model.id, np.eye(4), ONES)
        return EntityRecord(
            2,
            "thing_2",
            true.class_name,
            "rigid",
            box,
            (),
            None,
            "none",
            None,
            None,
            cad,
            tuple(candidates),
        )

    stands = None if placed is None else PosedModel(placed, np.eye(4) if T is None else T, ONES)
    return CadCase(
        record(true),
        record(placed) if found else None,
        PosedModel(true, np.eye(4), ONES),
        stands,
        np.zeros((0, 3)),
    )


def test_retrieval_by_hand():
    cube, near = block_model("box/a", (0.4, 0.4, 0.4)), block_model("box/b", (0.41, 0.4, 0.4))
    long = block_model("box/c", (1.2, 0.4, 0.4))
    library = library_of(cube, near, long)
    away = pose(0, (0.5, 0, 0))
    cases = [
        case_of(cube, cube, away),  # the same model, wherever it stands
        case_of(cube, near),  # another one within 2 cm
        case_of(cube, near, away, candidates=[candidate("box/b", 0.1)]),  # its shape alone is right
        case_of(
            cube,
            long,
            candidates=[candidate("box/c", 0.1), candidate("box/b", 0.3), candidate("box/a", 0.4)],
        ),
        case_of(cube, None, candidates=[candidate("box/c", 0.1)]),  # a scan
        case_of(cube, None, found=False),
    ]
    found = score_retrieval(cases, library)
    assert [r.top1 for r in found.rows] == [True, True, False, False, False, False]
    assert [r.top1_shape for r in found.rows] == [True, True, True, False, False, False]
    assert [r.top10 for r in found.rows] == [True, True, True, True, False, False]
    assert [r.rank for r in found.rows] == [None, None, 1, 2, None, None]
    assert [r.rank_same for r in found.rows] == [None, None, None, 3, None, None]
    assert found.top1 == pytest.approx(2 / 6) and found.top1_of_found == pytest.approx(2 / 5)
    assert found.top10 == pytest.approx(4 / 6) and found.top10_of_found == pytest.approx(4 / 5)
    assert found.top1_same == pytest.approx(1 / 6)
    assert found.top10_same == pytest.approx(2 / 6)
    assert found.top1_matching == pytest.approx(1 / 6)
    assert found.class_top1 == found.top1  # one class


def test_two_centimetres_are_much_for_a_cup():
    # 8 cm and 7 cm cubes, one in the middle of the other: 5 mm apart at the sides, 8.7 mm at the
    # corners; the diagonal is 13.9 cm, 2 % of it 2.8 mm. After the best fit they are the same.
    cup, less = block_model("cup/a", (0.08, 0.08, 0.08)), block_model("cup/b", (0.07, 0.07, 0.07))
    library = library_of(cup, less)
    found = score_retrieval([case_of(cup, less)], library)
    assert 0.005 <= found.rows[0].placed_m < 0.0087
    assert (found.top1, found.top1_relative) == (1.0, 0.0)
    tried = case_of(cup, less, candidates=[candidate("cup/b", 0.1)])
    assert score_retrieval([tried], library).top10_relative == 1.0
    same = score_retrieval([case_of(cup, cup, pose(0, (1, 0, 0)))], library)
    assert same.top1_relative == same.top10_relative == 1.0


def test_a_class_counts_as_much_as_a_larger_one():
    cube, other = block_model("box/a", (0.4, 0.4, 0.4)), block_model("cup/a", (0.1, 0.1, 0.1))
    cases = [case_of(cube, cube)] * 3 + [case_of(other, None)]
    found = score_retrieval(cases, library_of(cube, other))
    assert (found.top1, found.class_top1) == (0.75, 0.5)
    nothing = score_retrieval([], library_of(cube))
    assert nothing.top1 is None and nothing.class_top10 is None


def test_a_model_of_no_library_is_refused():
    with pytest.raises(SceneError, match="box/lost is not in test library, which has 1 models"):
        model_named("box/lost", library_of(block_model("box/a", (1, 1, 1))))


# -- Scan2CAD -----------------------------------------------------------------------------------


def posed(
    id="chair/a",
    class_name="chair",
    yaw=0.0,
    center=(0, 0, 0),
    scale=(1, 1, 1),
    size=None,
    symmetry=1,
) -> PosedCad:
    scale = np.asarray(scale, float)
    return PosedCad(
        id,
        class_name,
        rotation_z(np.deg2rad(yaw)).astype(float),
        np.asarray(center, float),
        scale,
        scale if size is None else np.asarray(size, float),
        symmetry,
    )


def counts(truth, predicted) -> tuple[int, int]:
    """(official, strict) hits."""
    return (
        len(official_hits(truth, predicted, LIMITS)),
        len(strict_hits(truth, predicted, LIMITS)),
    )


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, (1, 1)),
        ({"center": (0.19, 0, 0)}, (1, 1)),
        ({"center": (0.21, 0, 0)}, (0, 0)),
        ({"yaw": 19}, (1, 1)),
        ({"yaw": 21}, (0, 0)),
        ({"scale": (1.19, 1.19, 1.19)}, (1, 1)),
        ({"scale": (1.21, 1.21, 1.21)}, (0, 0)),
        # one axis too long, one too short: |mean(1.5, 0.5, 1) - 1| = 0
        ({"scale": (1.5, 0.5, 1.0)}, (1, 0)),
        # another model never counts officially, however well it fits
        ({"id": "chair/b"}, (0, 1)),
        ({"id": "chair/b", "scale": (0.5, 0.5, 0.5), "size": (1, 1, 1)}, (0, 1)),
        ({"class_name": "table"}, (0, 0)),
        # the same scale of the same model, but stated of another size: only sizes differ
        ({"size": (1, 1, 1.3)}, (1, 0)),
    ],
)
def test_countings_by_hand(changes, expected):
    assert counts([posed()], [posed(**changes)]) == expected


@pytest.mark.parametrize(
    ("symmetry", "yaw", "expected"),
    [(1, 180, 0), (2, 180, 1), (2, 90, 0), (4, 90, 1), (4, 45, 0), (0, 33, 1)],
)
def test_symmetric_models_may_be_turned(symmetry, yaw, expected):
    truth, predicted = [posed(symmetry=symmetry)], [posed(yaw=yaw, symmetry=symmetry)]
    assert counts(truth, predicted) == (expected, expected)


def test_round_models_have_36_steps_officially():
    # 5 degrees lie midway between two steps: with a tilt of 19.5 degrees besides, the official
    # angle is arccos(cos 5 ... ) > 20, while the strict one asks for the tilt alone.
    tilt = np.deg2rad(19.5)
    R = np.array(
        [[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]]
    ) @ rotation_z(np.deg2rad(5.0))
    truth = [posed(symmetry=0)]
    predicted = [dataclasses.replace(posed(symmetry=0), rotation=R)]
    assert counts(truth, predicted) == (0, 1)


def test_the_first_fit_takes_it_officially():
    # Two true chairs 0.3 m apart; the first prediction lies between them and takes the first,
    # though it fits the second as well, and the second prediction fits the first alone.
    truth = [posed(), posed(center=(0.3, 0, 0))]
    predicted = [posed(center=(0.15, 0, 0)), posed(center=(-0.1, 0, 0))]
    assert counts(truth, predicted) == (1, 2)


def test_an_id_counts_as_often_as_it_occurs():
    # The id is used up by a prediction that fits nothing; the right one after it does not count.
    truth = [posed(), posed("chair/b", center=(3, 0, 0))]
    predicted = [posed(center=(9, 0, 0)), posed()]
    assert counts(truth, predicted) == (0, 1)
    # ... while an id that occurs twice may take another model's place in its class.
    truth = [posed("chair/b"), posed("chair/a", center=(3, 0, 0))]
    assert counts(truth, [posed("chair/a")]) == (1, 1)


@pytest.mark.parametrize("seed", range(12))
def test_countings_as_their_twins(seed):
    rng = np.random.default_rng(seed)
    truth, predicted = ([_random_cad(rng) for _ in range(rng.integers(1, 6))] for _ in range(2))
    found = score_scan2cad(truth, predicted)

    def plain(cad: PosedCad) -> dict:
        return {
            "id": cad.id,
            "class": cad.class_name,
            "R": cad.rotation,
            "t": cad.center,
            "s": cad.scale,
            "symmetry": cad.symmetry,
        }

    expected = slow.official_scan2cad([plain(c) for c in truth], [plain(c) for c in predicted])
    assert {k: (c.good, c.total) for k, c in found.official.by_class.items()} == expected
    fits = np.array([[len(strict_hits([t], [p], LIMITS)) for p in predicted] for t in truth])
    good = sum(c.good for c in found.strict.by_class.values())
    assert good == slow.most_pairs(fits)


def _random_cad(rng: np.random.Generator) -> PosedCad:
    """Of two classes and few ids, crowded, so that limits and counts matter."""
    kind = int(rng.integers(4))
    return posed(
        f"{'chair' if kind < 3 else 'table'}/{kind}",
        "chair" if kind < 3 else "table",
        float(rng.choice([0, 15, 90, 180]) + rng.uniform(-12, 12)),
        rng.uniform(-0.15, 0.15, 3),
        rng.uniform(0.75, 1.25, 3),
        symmetry=[1, 2, 0, 4][kind],
    )


def test_both_averages_say_which_they_are():
    found = AlignmentAccuracy.over({"chair": ClassCount(3, 4), "table": ClassCount(0, 1)})
    assert found.instances == pytest.approx(3 / 5) and found.classes == pytest.approx(3 / 8)
    assert AlignmentAccuracy.over({}).instances is None
    assert score_scan2cad([], [posed()]).strict.classes is None
    assert score_scan2cad([posed()], []).strict.instances == 0.0


def test_box_mesh_samples_lie_on_their_mesh():
    mesh = box_mesh((0.3, 0.5, 0.2), spacing_m=10.0)
    points = surface_samples(mesh.vertices, mesh.faces).points
    assert surface_distances(points, mesh.vertices[mesh.faces]).max() < EXACT_M
