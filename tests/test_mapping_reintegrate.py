"""Kept frames: integrated again at other poses, they make the map of those poses, bit for bit."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from isr_jax.errors import FrameError, MapError
from isr_jax.mapping import PanopticMapper

from .mapping_films import SETTINGS, assert_same_map, film, map_of
from .reference.mapping_reference import CAMERA

KEEPING = dataclasses.replace(SETTINGS, keep_frames=True)


def drifted(frames, step_m=0.02):
    """The same images at poses that slide away."""
    out = []
    for i, (frame, segments) in enumerate(frames):
        T = frame.T_world_camera.copy()
        T[:3, 3] += np.float32(step_m * i)
        out.append((dataclasses.replace(frame, T_world_camera=T), segments))
    return out


def in_millimetres(frames):
    """Depth as a sensor of 16-bit millimetres gives it."""
    return [
        (dataclasses.replace(f, depth_m=(np.round(f.depth_m * 1000) / 1000).astype(np.float32)), s)
        for f, s in frames
    ]


def far_away(frames):
    """Depth beyond 6.5 m at a tenth of a millimetre, which 16 bits do not hold."""
    return [
        (dataclasses.replace(f, depth_m=np.where(f.depth_m > 2, f.depth_m + 7, f.depth_m)), s)
        for f, s in frames
    ]


@pytest.mark.parametrize("sensor", [in_millimetres, far_away, list])
def test_reintegrated_equals_mapped_with_these_poses(sensor):
    frames = sensor(film(6))
    wrong = map_of(drifted(frames), KEEPING)
    right = wrong.reintegrate(np.stack([frame.T_world_camera for frame, _ in frames]))
    assert_same_map(right, map_of(frames))
    assert not np.array_equal(np.asarray(wrong.pool.sdf_m), np.asarray(right.pool.sdf_m))


def test_a_reintegrated_map_goes_on_and_can_be_reintegrated_again(tmp_path):
    frames = film(6)
    wrong = map_of(drifted(frames[:4]), KEEPING)
    wrong.save(tmp_path / "map.npz")
    loaded = PanopticMapper.load(tmp_path / "map.npz")
    right = loaded.reintegrate(np.stack([frame.T_world_camera for frame, _ in frames[:4]]))
    for frame, segments in frames[4:]:
        right.integrate(frame, segments)
    assert_same_map(right, map_of(frames))
    shifted = drifted(frames)
    again = right.reintegrate(np.stack([frame.T_world_camera for frame, _ in shifted]))
    assert_same_map(again, map_of(shifted))


def test_kept_frames_take_less_than_the_images():
    frames = in_millimetres(film(4))
    kept = map_of(frames, KEEPING).kept
    assert kept is not None and len(kept) == 4
    raw = sum(f.depth_m.nbytes + f.color.nbytes + s.segment.nbytes for f, s in frames)
    assert 0 < kept.nbytes < raw / 4


def test_without_kept_frames_or_with_other_poses_it_says_so():
    frames = film(2)
    with pytest.raises(MapError, match="kept no frames"):
        map_of(frames).reintegrate(np.stack([frame.T_world_camera for frame, _ in frames]))
    with pytest.raises(MapError, match="2 kept frames"):
        map_of(frames, KEEPING).reintegrate(np.eye(4)[None])


def test_kept_frames_do_not_follow_the_callers_arrays():
    frames = film(4)
    mapper = PanopticMapper(CAMERA, KEEPING)
    poses = np.stack([frame.T_world_camera for frame, _ in frames])
    for frame, segments in film(4):
        mapper.integrate(frame, segments)
        segments.class_id[:], segments.instance[:], frame.T_world_camera[:] = 0, 0, 0.0
    assert_same_map(mapper.reintegrate(poses), map_of(frames))


@pytest.mark.parametrize("wrong", [np.nan, 0.0, 2.0, 1e7])
def test_poses_that_are_none_are_refused_by_number(wrong):
    mapper = map_of(film(3), KEEPING)
    poses = np.stack([frame.T_world_camera for frame, _ in film(3)])
    poses[1] = poses[1] * wrong if wrong != 1e7 else poses[1]
    poses[1, :3, 3] += 1e4 * (wrong == 1e7)
    with pytest.raises(FrameError, match="pose 1"):
        mapper.reintegrate(poses)
