"""Saved maps: continued, they are the uninterrupted map bit for bit; anything else is refused."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest

from isr_jax.errors import MapError, OutputError
from isr_jax.mapping import PanopticMapper

from .mapping_films import SETTINGS, assert_same_map, film, map_of
from .reference.mapping_reference import CAMERA


@pytest.mark.parametrize(("stop", "frames_per_step"), [(1, 1), (15, 1), (17, 1), (17, 3)])
def test_saved_and_continued_equals_uninterrupted(stop, frames_per_step, tmp_path):
    """Before, at and after a renumbering of merged labels."""
    settings = dataclasses.replace(SETTINGS, frames_per_step=frames_per_step)
    frames = film(20, noise_m=0.004)
    map_of(frames[:stop], settings).save(tmp_path / "map.npz")
    resumed = PanopticMapper.load(tmp_path / "map.npz")
    for pair in frames[stop:]:
        resumed.integrate(*pair)
    assert_same_map(resumed, map_of(frames, settings))


def test_saving_changes_nothing(tmp_path):
    frames = film(6)
    mapper = map_of(frames[:3])
    mapper.save(tmp_path / "map.npz")
    for pair in frames[3:]:
        mapper.integrate(*pair)
    assert_same_map(mapper, map_of(frames))


def test_a_saved_map_says_in_which_world_it_lies(tmp_path):
    T = np.eye(4)
    T[:3, 3] = 0.1, -0.2, 1 / 3
    PanopticMapper(CAMERA, SETTINGS, T).save(tmp_path / "map.npz")
    assert np.array_equal(PanopticMapper.load(tmp_path / "map.npz").T_world_dataset, T)


def test_a_map_that_cannot_be_written_says_so(tmp_path):
    (tmp_path / "file").write_text("no folder")
    with pytest.raises(OutputError, match=r"map\.npz cannot be written"):
        map_of(film(1)).save(tmp_path / "file" / "map.npz")


def rewritten(path, **changes):
    """The file with other arrays; None leaves one out."""
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    arrays |= changes
    np.savez(path, **{name: array for name, array in arrays.items() if array is not None})


@pytest.mark.parametrize("missing", ["about", "sdf_m", "passes", "counts"])
def test_a_file_with_a_part_missing_is_refused(missing, tmp_path):
    path = tmp_path / "map.npz"
    map_of(film(1)).save(path)
    rewritten(path, **{missing: None})
    with pytest.raises(MapError, match=r"map\.npz cannot be read as a map"):
        PanopticMapper.load(path)


def test_a_file_cut_short_or_of_something_else_is_refused(tmp_path):
    path = tmp_path / "map.npz"
    map_of(film(1)).save(path)
    whole = path.read_bytes()
    for broken in (whole[: len(whole) // 2], b"", b"PK\x03\x04 cut off", b"a picture"):
        path.write_bytes(broken)
        with pytest.raises(MapError, match=r"map\.npz cannot be read as a map"):
            PanopticMapper.load(path)
    with pytest.raises(MapError, match="cannot be read"):
        PanopticMapper.load(tmp_path / "none.npz")


def test_arrays_that_do_not_fit_each_other_are_refused(tmp_path):
    path = tmp_path / "map.npz"
    map_of(film(1)).save(path)
    rewritten(path, weight=np.zeros((3, 512), np.float32))
    with pytest.raises(MapError, match=r"map\.npz cannot be read as a map"):
        PanopticMapper.load(path)


def test_an_older_format_is_named(tmp_path):
    path = tmp_path / "map.npz"
    map_of(film(1)).save(path)
    with np.load(path) as file:
        about = json.loads(str(file["about"])) | {"format": 1}
    rewritten(path, about=np.array(json.dumps(about)))
    with pytest.raises(MapError, match=r"another release.* format 1, not"):
        PanopticMapper.load(path)
