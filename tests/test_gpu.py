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
from isr_jax.mapping import PanopticMapper
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


def test_fusion(gpu):
    solids = [
        Solid("plane", (0, 0, 1), 0.013, class_id=class_named("floor").id),
        Solid("box", (0, 0, 0.37), (0.4, 0.3, 0.37), yaw=0.35, class_id=class_named("table").id),
    ]
    frames = [render(solids, T, index=i) for i, T in enumerate(orbit((0, 0, 0.4), 1.6, 1.1, 4))]

    def fused():
        mapper = PanopticMapper(CAMERA, MappingSettings(voxel_size_m=0.03, block_capacity=1024))
        for frame, segments in frames:
            mapper.integrate(frame, segments)
        return mapper.blocks.used, np.asarray(mapper.pool.sdf_m), np.asarray(mapper.pool.weight)

    (used, sdf_m, weight), (used_there, sdf_there_m, _) = on_both(gpu, fused)
    assert used_there == used
    differs = np.abs(sdf_there_m - sdf_m)[weight > 0] > SDF_M
    assert differs.mean() < OTHER_PIXEL


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
