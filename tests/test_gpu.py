"""The kernels on an accelerator give what they give on the processor."""

from __future__ import annotations

import jax
import numpy as np
import pytest

from isr_jax.alignment import align_shortlists
from isr_jax.classes import class_named
from isr_jax.config import (
    AlignmentSettings,
    ContactGraphSettings,
    MappingSettings,
    MatchingSettings,
)
from isr_jax.contact_graph import build_contact_graphs
from isr_jax.evaluation import contingency
from isr_jax.geometry import points_to_mesh_distance
from isr_jax.mapping import MapBatch, PanopticMapper, pool
from isr_jax.matching import match

from .builders import box_entity, box_mesh, floor_entity, library_of, scene_of, table_model
from .furniture import block_model
from .reference.mapping_reference import CAMERA, Solid, orbit, render

pytestmark = pytest.mark.gpu

ROUNDING = 1e-5
"""Sums of a few float32 products of metres, in another order."""
SOLVED = 1e-3
"""Unknowns of a least-squares solve that ends at 1e-5: its valleys are flat."""
OTHER_PIXEL = 1e-3
"""Share of voxels whose projection rounds onto the other pixel."""
SDF_M = 1e-4


@pytest.fixture(autouse=True)
def full_precision():
    """Products of matrices in float32; TensorFloat-32 keeps three digits of a coordinate."""
    with jax.default_matmul_precision("highest"):
        yield


def on_both(gpu: jax.Device, compute):
    """What ``compute`` returns on the processor and on the accelerator."""
    results = []
    for device in (jax.devices("cpu")[0], gpu):
        with jax.default_device(device):
            results.append(compute())
    return results


def furnished():
    """A table with a box on it, a box beside it, all on the floor."""
    return scene_of(
        floor_entity(),
        box_entity(2, "table", (0.5, 0.2, 0.37), (1.2, 0.8, 0.74), yaw=0.3),
        box_entity(3, "microwave", (0.5, 0.2, 0.89), (0.5, 0.4, 0.3), yaw=0.2),
        box_entity(4, "cabinet", (-1.2, 0.3, 0.5), (0.6, 0.5, 1.0), yaw=-0.2),
    )


def library():
    return library_of(
        table_model("table/one"),
        table_model("table/two", (1.6, 0.7, 0.7)),
        block_model("microwave/one", (0.52, 0.38, 0.3)),
        block_model("cabinet/one", (0.6, 0.55, 1.1)),
    )


def assert_close(there, here, tolerance):
    np.testing.assert_allclose(np.asarray(there), np.asarray(here), rtol=tolerance, atol=tolerance)


def small_film(radius):
    """Four frames of a table on a floor."""
    solids = [
        Solid("plane", (0, 0, 1), 0.013, class_id=class_named("floor").id),
        Solid("box", (0, 0, 0.37), (0.4, 0.3, 0.37), yaw=0.35, class_id=class_named("table").id),
    ]
    poses = orbit((0, 0, 0.4), radius, 1.1, 4)
    return [render(solids, T, index=i) for i, T in enumerate(poses)]


def mapped(frames, **changes):
    settings = MappingSettings(voxel_size_m=0.03, block_capacity=1024, **changes)
    mapper = PanopticMapper(CAMERA, settings)
    for frame, segments in frames:
        mapper.integrate(frame, segments)
    return mapper


def voxels(mapper):
    """Distance, weight, leading label and its count of all voxels in use."""
    rows = np.arange(mapper.blocks.used)
    fields = pool.sdf_m(mapper.pool, rows), pool.weight(mapper.pool, rows)
    return [np.asarray(f) for f in (*fields, *pool.leading_label(mapper.pool, rows))]


def assert_same_voxels(there, here):
    """But for those whose projection rounds onto the other pixel."""
    seen = here[1] > 0
    assert np.mean(np.abs(there[0] - here[0])[seen] > SDF_M) < OTHER_PIXEL
    np.testing.assert_allclose(there[1][seen].sum(), here[1][seen].sum(), rtol=OTHER_PIXEL)
    labelled = here[2] > 0
    assert np.mean((there[2] != here[2])[labelled]) < 5 * OTHER_PIXEL
    assert np.mean((there[3] != here[3])[labelled]) < 5 * OTHER_PIXEL


def test_integration(gpu):
    """Distances, weights, labels and free space; with several frames a step too."""
    frames, points = small_film(1.6), np.random.default_rng(7).uniform(-1.5, 1.5, (5000, 3))

    def both_ways():
        mapper = mapped(frames)
        several = mapped(frames, frames_per_step=3)
        for one, other in zip(voxels(mapper), voxels(several), strict=True):
            np.testing.assert_array_equal(one, other)
        return mapper.blocks.used, voxels(mapper), mapper.observed(points)

    (used, here, known), (used_there, there, known_there) = on_both(gpu, both_ways)
    assert used_there == used
    assert_same_voxels(there, here)
    assert np.mean(known != known_there) < OTHER_PIXEL


def test_a_batch_of_maps(gpu):
    """Maps that grow in one call are the maps by themselves, there as here."""
    films = [small_film(radius) for radius in (1.4, 1.6, 1.8)]
    with jax.default_device(gpu):
        alone = [mapped(film) for film in films]
        maps = [mapped([]) for _ in films]
        with MapBatch(maps) as batch:
            for step in zip(*films, strict=True):
                batch.integrate([frame for frame, _ in step], [segments for _, segments in step])
        for one, other in zip(maps, alone, strict=True):
            for a, b in zip(voxels(one), voxels(other), strict=True):
                np.testing.assert_array_equal(a, b)


def test_a_saved_map_goes_on_and_is_integrated_again(gpu, tmp_path):
    frames = small_film(1.6)
    with jax.default_device(gpu):
        whole = mapped(frames, keep_frames=True)
        mapped(frames[:2], keep_frames=True).save(tmp_path / "map.npz")
        resumed = PanopticMapper.load(tmp_path / "map.npz")
        for frame, segments in frames[2:]:
            resumed.integrate(frame, segments)
        again = resumed.reintegrate(np.stack([frame.T_world_camera for frame, _ in frames]))
        for other in (resumed, again):
            for a, b in zip(voxels(whole), voxels(other), strict=True):
                np.testing.assert_array_equal(a, b)


def test_from_contact_graph_to_alignment(gpu):
    """Support, shortlist and pose of every entity, one stage after the other."""
    scene, models = furnished(), library()

    def placed():
        graph = build_contact_graphs([scene], ContactGraphSettings())[0]
        shortlist = match([scene], [graph], models, MatchingSettings())[0]
        found = align_shortlists([scene], [graph], [shortlist], models, AlignmentSettings())[0]
        return graph, shortlist, found

    (graph, shortlist, found), (graph_there, shortlist_there, found_there) = on_both(gpu, placed)
    assert graph.parent.tolist() == graph_there.parent.tolist()
    assert_close(graph_there.score, graph.score, ROUNDING)
    assert len(shortlist.error) > 3
    assert_close(shortlist_there.error, shortlist.error, ROUNDING)
    for field in ("entity", "model", "rotation"):
        np.testing.assert_array_equal(getattr(shortlist_there, field), getattr(shortlist, field))
    np.testing.assert_array_equal(found_there.status, found.status)
    assert_close(found_there.scale, found.scale, SOLVED)
    assert_close(found_there.translation, found.translation, SOLVED)
    assert_close(found_there.alignment_error_m, found.alignment_error_m, SOLVED)


def test_distance_to_a_mesh(gpu):
    mesh = box_mesh((0.8, 0.5, 0.3), spacing_m=0.2)
    points = np.random.default_rng(5).uniform(-1, 1, (300, 3)).astype(np.float32)
    valid = np.ones(len(mesh.faces), bool)
    here, there = on_both(
        gpu, lambda: points_to_mesh_distance(points, mesh.vertices, mesh.faces, valid)
    )
    assert_close(there, here, ROUNDING)


def test_contingency_is_exact(gpu):
    rows = np.random.default_rng(6).integers(-1, 8, (2, 5000)).astype(np.int32)
    here, there = on_both(gpu, lambda: contingency(*rows, truth_count=8, predicted_count=8))
    np.testing.assert_array_equal(there, here)
