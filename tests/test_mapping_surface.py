"""The map's surface: parity with a slow twin, open borders, and meshing again what changed."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.spatial import KDTree

from isr_jax.classes import class_named
from isr_jax.config import MappingSettings
from isr_jax.mapping import PanopticMapper, cells, pool
from isr_jax.mapping import surface as surfaces
from isr_jax.mapping.pool import BLOCK_SIDE, VOXEL_OFFSETS
from isr_jax.mapping.surface import SurfaceExtractor, extract_surface
from isr_jax.types import PanopticSurface

from .reference.mapping_reference import CAMERA, Solid, orbit, render
from .reference.surface_reference import cell_label, surface_nets

FLOOR, TABLE, BOWL = (class_named(n).id for n in ("floor", "table", "bowl"))
TILT = np.array([0.10, -0.06, 0.993])
SOLIDS = [
    Solid(
        "plane", tuple(TILT / np.linalg.norm(TILT)), 0.013, class_id=FLOOR, color=(120, 120, 120)
    ),
    Solid("box", (0, 0, 0.37), (0.4, 0.3, 0.37), yaw=0.35, class_id=TABLE),
    Solid("ball", (0.1, 0.05, 0.86), 0.12, class_id=BOWL, color=(20, 40, 220)),
]
SETTINGS = MappingSettings(voxel_size_m=0.03, block_capacity=1024)
VOXEL_M = SETTINGS.voxel_size_m
POSITION_M = 1e-5
"""Float32 against float64, metres."""


@pytest.fixture(scope="module")
def frames():
    return [render(SOLIDS, T, index=i) for i, T in enumerate(orbit((0, 0, 0.4), 1.6, 1.1, 8))]


@pytest.fixture(scope="module")
def mapped(frames):
    return map_of(frames)


def map_of(frames, settings=SETTINGS):
    mapper = PanopticMapper(CAMERA, settings)
    for frame, segments in frames:
        mapper.integrate(frame, segments)
    return mapper


def whole(mapper) -> PanopticSurface:
    return extract_surface(mapper.pool, mapper.blocks, mapper.settings, *mapper.map_labels())


def updated(extractor, mapper) -> PanopticSurface:
    return extractor.update(mapper.pool, mapper.blocks, *mapper.map_labels(), mapper.step)


def assert_equal(a: PanopticSurface, b: PanopticSurface):
    for name in ("vertices", "faces", "colors", "normals"):
        assert np.array_equal(getattr(a.mesh, name), getattr(b.mesh, name)), name
    for name in ("instance", "instance_ids", "class_ids"):
        assert np.array_equal(getattr(a, name), getattr(b, name)), name


def distance_m(points):
    return np.min([s.distance(points.astype(float)) for s in SOLIDS], 0)


def places(mapper) -> list[tuple[int, int, int]]:
    """All voxels of the map, in the order of its rows."""
    rows = np.arange(mapper.blocks.used)
    place = mapper.blocks.coords[rows, None] * BLOCK_SIDE + VOXEL_OFFSETS
    return list(map(tuple, place.reshape(-1, 3).tolist()))


def observed_voxels(mapper) -> dict:
    rows = np.arange(mapper.blocks.used)
    weight = np.asarray(pool.weight(mapper.pool, rows)).ravel()
    sdf = np.asarray(pool.sdf_m(mapper.pool, rows)).ravel()
    seen = weight >= mapper.settings.mesh_min_weight
    where = [place for place, there in zip(places(mapper), seen, strict=True) if there]
    return dict(zip(where, sdf[seen].tolist(), strict=True))


def test_mesh_equals_the_slow_twin(frames):
    near = [
        (dataclasses.replace(f, depth_m=np.where(f.depth_m < 2, f.depth_m, 0)), s)
        for f, s in frames[:2]
    ]
    mapper = map_of(near, dataclasses.replace(SETTINGS, voxel_size_m=0.06))
    mesh = whole(mapper).mesh
    jump_m = SETTINGS.mesh_max_jump_voxels * 0.06
    vertex_of, quads = surface_nets(observed_voxels(mapper), jump_m, 0.06)
    number = {cell: i for i, cell in enumerate(vertex_of)}
    expected = np.array(list(vertex_of.values()))
    gap, place = KDTree(expected).query(mesh.vertices)
    assert gap.max() < POSITION_M and len(np.unique(place)) == len(place) > 500
    cycles = np.array([[number[c] for c in quad] for quad in quads])
    assert len(place) == len(np.unique(cycles))
    first, second = place[mesh.faces].reshape(-1, 2, 3).transpose(1, 0, 2)
    assert np.array_equal(first[:, [0, 2]], second[:, :2])  # two triangles a quadrilateral
    ours = np.column_stack([first, second[:, 2]])
    assert np.array_equal(turned_to_least(ours), turned_to_least(cycles))
    p = mesh.vertices[mesh.faces].reshape(-1, 2, 3, 3)
    cut = np.linalg.norm(p[:, 0, 0] - p[:, 0, 2], axis=1)
    assert np.all(cut <= np.linalg.norm(p[:, 0, 1] - p[:, 1, 2], axis=1) + POSITION_M)


def test_labels_equal_the_slow_twin(frames):
    """Where table and bowl are one segment in some frames, the corners of a cell disagree."""
    mapper = map_of([(f, _shifted(s) if i % 3 == 0 else s) for i, (f, s) in enumerate(frames)])
    vertex_of, _ = surface_nets(observed_voxels(mapper), 6 * VOXEL_M, VOXEL_M)
    labels, counts = pool.leading_label(mapper.pool, np.arange(mapper.blocks.used))
    found = zip(np.asarray(labels).ravel().tolist(), np.asarray(counts).ravel().tolist())
    leading = dict(zip(places(mapper), found, strict=True))
    expected = np.array([cell_label(cell, leading) for cell in vertex_of])
    as_it_is = np.arange(mapper.labels.label_count)
    surface = extract_surface(mapper.pool, mapper.blocks, SETTINGS, as_it_is, as_it_is)
    gap, place = KDTree(np.array(list(vertex_of.values()))).query(surface.mesh.vertices)
    assert gap.max() < POSITION_M
    assert np.array_equal(surface.instance, expected[place])
    corner = np.rint(surface.mesh.vertices / VOXEL_M - 0.5).astype(int).tolist()
    nearest = [leading.get(tuple(c), (0, 0))[0] for c in corner]
    assert 10 < np.sum(surface.instance != nearest) < 0.2 * len(nearest)


def turned_to_least(cycles):
    """Cycles from their least corner on, in order."""
    turned = np.take_along_axis(cycles, (cycles.argmin(1)[:, None] + np.arange(4)) % 4, 1)
    return np.unique(turned, axis=0)


def test_faces_agree_with_their_neighbours(mapped):
    """A directed edge belongs to one face, save where a cell holds two sheets in one vertex."""
    mesh = whole(mapped).mesh
    edges = np.concatenate([mesh.faces[:, [i, (i + 1) % 3]] for i in range(3)])
    near = np.linalg.norm(mesh.vertices[edges[:, 0], :2], axis=1) < 1.0  # beyond, rays graze
    _, count = np.unique(edges[near], axis=0, return_counts=True)
    assert np.mean(count == 1) > 0.999


def test_every_vertex_is_in_a_face(mapped):
    mesh = whole(mapped).mesh
    assert np.array_equal(np.unique(mesh.faces), np.arange(len(mesh.vertices)))


def test_unobserved_borders_stay_open(frames):
    """From one side a ball is a cap and a table two sides: nothing closes what was not seen."""
    mesh = whole(map_of(frames[:1])).mesh
    center = mesh.vertices[mesh.faces].mean(1)
    error = distance_m(center) / VOXEL_M
    assert np.percentile(error, 99) < 0.5
    assert error.max() < 2.0
    eye = frames[0][0].T_world_camera[:3, 3]
    p = mesh.vertices[mesh.faces]
    wound = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    near = np.linalg.norm(center[:, :2], axis=1) < 1.0  # beyond, rays graze the floor
    assert np.mean(np.sum(wound * (eye - center), 1)[near] > 0) > 0.98


def test_holes_are_only_where_nothing_was_seen(mapped):
    """The floor's mesh is open at its rim and round the table, nowhere between."""
    mesh = whole(mapped).mesh
    on_floor = SOLIDS[0].distance(mesh.vertices.astype(float)) < 0.3 * VOXEL_M
    radius = np.linalg.norm(mesh.vertices[:, :2], axis=1)
    middle = on_floor & (radius > 0.75) & (radius < 1.0)
    edges = np.concatenate([mesh.faces[:, [i, (i + 1) % 3]] for i in range(3)])
    pairs, count = np.unique(np.sort(edges, 1), axis=0, return_counts=True)
    open_edges = pairs[count == 1]
    assert not np.any(middle[open_edges].all(1))


def test_asked_after_every_frame_equals_asked_once(frames):
    mapper, extractor = PanopticMapper(CAMERA, SETTINGS), SurfaceExtractor(SETTINGS)
    for frame, segments in frames:
        mapper.integrate(frame, segments)
        assert_equal(updated(extractor, mapper), whole(mapper))


def test_only_what_changed_is_meshed_again(frames, monkeypatch):
    mapper, extractor = map_of(frames[:-1]), SurfaceExtractor(SETTINGS)
    updated(extractor, mapper)
    seen = []
    read = surfaces.read_cells

    def recorded(pool, blocks, rows, *limits):
        seen.append(rows)
        return read(pool, blocks, rows, *limits)

    monkeypatch.setattr(surfaces, "read_cells", recorded)
    updated(extractor, mapper)
    assert not seen
    before = mapper.step
    frame, segments = frames[-1]
    nothing_left = np.zeros_like(frame.depth_m)
    corner = np.s_[:40, :40]
    nothing_left[corner] = frame.depth_m[corner]
    mapper.integrate(dataclasses.replace(frame, depth_m=nothing_left), segments)
    got = updated(extractor, mapper)
    changed = np.flatnonzero(mapper.blocks.stamp[: mapper.blocks.used] > before)
    assert len(seen) == 1 and set(changed) <= set(seen[0].tolist())
    assert len(seen[0]) < 0.6 * mapper.blocks.used
    assert_equal(got, whole(mapper))


def test_new_decisions_change_instances_and_nothing_else(mapped):
    extractor = SurfaceExtractor(SETTINGS)
    first = updated(extractor, mapped)
    class_of, instance_of = mapped.map_labels()
    moved = np.where(instance_of > 0, instance_of + 10, 0)
    second = extractor.update(mapped.pool, mapped.blocks, class_of, moved, mapped.step)
    assert second.mesh is first.mesh
    assert np.array_equal(second.instance_ids, first.instance_ids + 10)
    assert np.array_equal(second.class_ids, first.class_ids)


def test_other_numbers_of_labels_read_labels_only(frames, monkeypatch):
    """As when merged labels are written into the voxels: the surface is where it was."""
    mapper, extractor = map_of(frames[:4]), SurfaceExtractor(SETTINGS)
    first = updated(extractor, mapper)
    other = map_of([(f, _shifted(s)) for f, s in frames[:4]])
    assert np.array_equal(other.blocks.coords, mapper.blocks.coords)
    monkeypatch.setattr(cells, "find_cells", _forbidden)
    mapper.blocks.generation += 1
    second = extractor.update(other.pool, mapper.blocks, *other.map_labels(), mapper.step + 1)
    assert second.mesh is first.mesh
    monkeypatch.undo()
    assert_equal(second, whole(other))
    assert not np.array_equal(second.instance, first.instance)


def _shifted(segments):
    """Table and bowl in one segment: other labels, the same depth."""
    one = np.where(segments.segment == 3, 2, segments.segment)
    return dataclasses.replace(segments, segment=one)


def _forbidden(*_):
    raise AssertionError("the geometry was read again")


def test_another_map_is_meshed_from_the_start(frames, mapped):
    extractor = SurfaceExtractor(SETTINGS)
    updated(extractor, mapped)
    fresh = map_of(frames[4:6])
    assert_equal(updated(extractor, fresh), whole(fresh))


def test_an_empty_map_has_an_empty_surface():
    mapper = PanopticMapper(CAMERA, SETTINGS)
    surface = updated(SurfaceExtractor(SETTINGS), mapper)
    assert surface.mesh.faces.shape == (0, 3) and len(surface.instance_ids) == 0
    assert surface.mesh.colors is not None and surface.mesh.normals is not None


def test_voxels_below_the_least_weight_are_unobserved(mapped):
    strict = dataclasses.replace(SETTINGS, mesh_min_weight=1e9)
    labels = mapped.map_labels()
    assert not len(extract_surface(mapped.pool, mapped.blocks, strict, *labels).mesh.faces)
    lenient = dataclasses.replace(SETTINGS, mesh_min_weight=0.0)
    surface = extract_surface(mapped.pool, mapped.blocks, lenient, *labels)
    assert np.percentile(distance_m(surface.mesh.vertices), 99) < VOXEL_M
