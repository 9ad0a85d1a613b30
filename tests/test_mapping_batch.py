"""Frames that wait for each other, and maps that grow in one call: the same maps, bit for bit."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from isr_jax.errors import FrameError, MapError
from isr_jax.mapping import MapBatch, PanopticMapper

from .mapping_films import SETTINGS, assert_same_map, film, map_of
from .reference.mapping_reference import CAMERA


@pytest.mark.parametrize("frames_per_step", [2, 4])
def test_frames_of_a_step_make_the_map_of_one_by_one(frames_per_step):
    """Over a renumbering of labels, and with a last step that is not full."""
    frames = film(19)
    several = map_of(frames, dataclasses.replace(SETTINGS, frames_per_step=frames_per_step))
    assert several.frames == 19
    assert_same_map(several, map_of(frames))


def test_asking_for_the_map_integrates_the_frames_that_wait():
    mapper = map_of(film(3), dataclasses.replace(SETTINGS, frames_per_step=8))
    assert mapper.frames == 3
    assert_same_map(mapper, map_of(film(3)))
    assert len(mapper.surface().mesh.faces) > 1000


def films():
    return [film(6, seed=seed, radius=radius) for seed, radius in enumerate((1.3, 1.6, 1.9))]


def test_a_batch_of_maps_equals_maps_by_themselves():
    """With different numbers of blocks per map, and growth on the way."""
    small = dataclasses.replace(SETTINGS, block_capacity=192)
    maps = [PanopticMapper(CAMERA, small) for _ in range(3)]
    with MapBatch(maps) as batch:
        for step in zip(*films(), strict=True):
            batch.integrate([frame for frame, _ in step], [segments for _, segments in step])
    used = {one.blocks.used for one in maps}
    assert len(used) == 3 and min(used) > 192
    for one, frames in zip(maps, films(), strict=True):
        assert_same_map(one, map_of(frames))


def test_too_many_voxels_for_a_step_are_refused_and_the_maps_stay(monkeypatch):
    frames, keeping = films(), dataclasses.replace(SETTINGS, keep_frames=True)
    maps = [map_of(some[:2], keeping) for some in frames]
    step = [some[2] for some in frames]
    refused = pytest.raises(MapError, match="fewer maps")
    with MapBatch(maps) as batch, monkeypatch.context() as bound, refused:
        bound.setattr("isr_jax.mapping.integrator._MAX_VOXELS", 10_000)
        batch.integrate([frame for frame, _ in step], [segments for _, segments in step])
    for one, some in zip(maps, frames, strict=True):
        assert one.frames == 2 and len(one.kept) == 2
        for frame, segments in some[2:]:
            one.integrate(frame, segments)
        assert one.surface().mesh.vertices.shape == map_of(some).surface().mesh.vertices.shape


def test_maps_join_a_batch_and_go_on_alone_after_it():
    frames = films()
    maps = [map_of(some[:2]) for some in frames]
    with MapBatch(maps) as batch:
        for k in (2, 3):
            step = [some[k] for some in frames]
            batch.integrate([frame for frame, _ in step], [segments for _, segments in step])
    for one, some in zip(maps, frames, strict=True):
        for frame, segments in some[4:]:
            one.integrate(frame, segments)
        assert_same_map(one, map_of(some))


def test_a_refused_frame_leaves_all_maps_as_they_were():
    frames = films()
    maps = [map_of(some[:2]) for some in frames]
    with MapBatch(maps) as batch, pytest.raises(FrameError):
        step = [some[2] for some in frames]
        bad = dataclasses.replace(step[1][0], T_world_camera=np.full((4, 4), np.nan, np.float32))
        batch.integrate([step[0][0], bad, step[2][0]], [segments for _, segments in step])
    for one, some in zip(maps, frames, strict=True):
        assert_same_map(one, map_of(some[:2]))


def test_maps_that_differ_are_no_batch():
    other = dataclasses.replace(SETTINGS, voxel_size_m=0.05)
    maps = [PanopticMapper(CAMERA, SETTINGS), PanopticMapper(CAMERA, other)]
    with pytest.raises(MapError, match="different settings"):
        MapBatch(maps)
    with pytest.raises(MapError, match="no maps"):
        MapBatch([])
