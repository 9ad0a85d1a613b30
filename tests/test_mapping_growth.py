"""Maps that grow: nothing changes, nothing is lost, and a frame costs what it shows."""

from __future__ import annotations

import dataclasses

import jax
import numpy as np
import pytest

from isr_jax.errors import FrameError, MapError
from isr_jax.mapping import MapBatch, PanopticMapper, labels, pool, view
from isr_jax.types import Camera

from .mapping_films import SETTINGS, assert_same_map, film, map_of
from .reference.mapping_reference import CAMERA, Solid, look_at, render

SMALL = dataclasses.replace(SETTINGS, block_capacity=64)
BOUNDED = dataclasses.replace(SETTINGS, block_capacity=64, max_blocks=768)


def test_a_map_that_grew_is_the_map_that_had_room():
    frames = film(6)
    grown = map_of(frames, SMALL)
    assert grown.blocks.capacity > 64
    assert_same_map(grown, map_of(frames))


def map_until_full(frames, settings):
    mapper = PanopticMapper(CAMERA, settings)
    for count, pair in enumerate(frames):
        try:
            mapper.integrate(*pair)
        except MapError as error:
            return mapper, count, error
    raise AssertionError("the map had room for all")


def test_a_full_map_is_the_map_so_far_and_goes_on(tmp_path):
    """The frame that does not fit leaves no trace; one that does is integrated."""
    frames = film(10)
    mapper, count, error = map_until_full(frames, BOUNDED)
    assert count > 0
    assert "max_blocks = 768" in str(error) and "raise MappingSettings.max_blocks" in str(error)
    assert_same_map(mapper, map_of(frames[:count]))
    mapper.save(tmp_path / "map.npz")
    assert_same_map(PanopticMapper.load(tmp_path / "map.npz"), map_of(frames[:count]))
    mapper.integrate(*frames[0])
    assert_same_map(mapper, map_of([*frames[:count], frames[0]]))


@pytest.mark.parametrize("field", [0, 1, 4])
def test_without_memory_the_map_so_far_is_whole(field, monkeypatch, tmp_path):
    """Memory ends at the first, second or fifth array that is to grow."""
    frames = film(6)
    mapper = map_of(frames[:1], SMALL)
    room, resized, calls = mapper.blocks.capacity, pool._resized, []

    def resized_until(array, parts, capacity):
        calls.append(capacity)
        if capacity > room and len(calls) > field:
            raise jax.errors.JaxRuntimeError("RESOURCE_EXHAUSTED: out of memory")
        return resized(array, parts, capacity)

    monkeypatch.setattr(pool, "_resized", resized_until)
    with pytest.raises(MapError, match="no memory for"):
        for pair in frames[1:]:
            mapper.integrate(*pair)
    monkeypatch.undo()
    fitted = mapper.frames
    assert_same_map(mapper, map_of(frames[:fitted]))
    for pair in frames[fitted:]:  # with memory again it goes on as if nothing had happened
        mapper.integrate(*pair)
    assert_same_map(mapper, map_of(frames))


def test_too_many_labels_stop_the_map_and_leave_its_geometry(monkeypatch):
    """Labels are counted behind the caller's back; the error comes with the next question."""
    frames = film(4)
    mapper = map_of(frames[:2])
    monkeypatch.setattr(labels, "LABEL_MASK", mapper.labels.label_count)
    monkeypatch.setattr(labels, "assign_labels", lambda votes, *_: np.zeros_like(votes.total))
    mapper.integrate(*frames[2])
    with pytest.raises(MapError, match="the map has given"):
        mapper.finish()
    assert len(mapper.surface().mesh.faces) > 0, "what was integrated can be asked and saved"
    assert mapper.frames == 3


def test_a_batch_without_memory_keeps_its_maps(monkeypatch):
    frames = film(6)
    maps = [map_of(frames[:1], SMALL) for _ in range(2)]
    batch = MapBatch(maps)

    def no_memory(*_):
        raise MemoryError

    monkeypatch.setattr(pool, "_resized", no_memory)
    with pytest.raises(MapError, match="no memory for"):
        for frame, segments in frames[1:]:
            batch.integrate([frame] * 2, [segments] * 2)
    for one in batch.close():
        assert_same_map(one, map_of(frames[: one.frames]))


def corridor(index):
    """A frame down an endless corridor; each is 3 m farther than the one before."""
    solids = [
        Solid("plane", (0, 0, 1), 0.0),
        Solid("plane", (0, 1, 0), 1.2),
        Solid("plane", (0, 1, 0), -1.2),
        Solid("plane", (0, 0, 1), 2.4),
    ]
    eye = np.array([3.0 * index, 0.1, 1.2])
    return render(solids, look_at(eye, eye + np.array([1.0, 0.2, -0.1])), index=index)


def test_what_a_frame_works_on_does_not_grow_with_the_map(monkeypatch):
    """The window is the view's, and the grid grows by shares of itself, not frame by frame."""
    windows, visible_blocks = [], view.visible_blocks

    def watched(*args):
        windows.append(args[4].size)
        return visible_blocks(*args)

    monkeypatch.setattr(view, "visible_blocks", watched)
    mapper = PanopticMapper(CAMERA, dataclasses.replace(SETTINGS, voxel_size_m=0.08))
    used, shapes = [], set()
    for i in range(30):
        mapper.integrate(*corridor(i))
        used.append(mapper.blocks.used)
        shapes.add(mapper.blocks.grid.shape)
    assert used[-1] > 10 * used[0]
    assert max(windows) < 2 * min(windows)
    assert len(shapes) < 12


def test_a_view_too_deep_for_its_voxels_is_refused():
    camera = Camera(fx=100.0, fy=100.0, cx=80.0, cy=60.0, width=160, height=120)
    scale = PanopticMapper(camera, dataclasses.replace(SETTINGS, voxel_size_m=0.004)).scale
    with pytest.raises(FrameError, match=r"lower input\.depth_max_m"):
        view.window_of(np.eye(4), camera, scale, 30.0)
