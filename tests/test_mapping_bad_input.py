"""Hard input to the map: each case has a stated result, or an error that leaves the map whole."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from isr_jax.classes import class_named, classes
from isr_jax.config import MappingSettings
from isr_jax.errors import FrameError, MapError
from isr_jax.mapping import PanopticMapper
from isr_jax.types import Camera

from .reference.mapping_reference import CAMERA, Solid, look_at, orbit, render

FLOOR, TABLE, PERSON = (class_named(n).id for n in ("floor", "table", "person"))
SOLIDS = [
    Solid("plane", (0, 0, 1), 0.013, class_id=FLOOR, color=(120, 120, 120)),
    Solid("box", (0, 0, 0.37), (0.4, 0.3, 0.37), yaw=0.35, class_id=TABLE),
]
SETTINGS = MappingSettings(voxel_size_m=0.05, block_capacity=256)
VIEWS = [render(SOLIDS, T, index=i) for i, T in enumerate(orbit((0, 0, 0.3), 1.6, 1.1, 4))]


def forged(item, **fields):
    """A copy of a dataclass whose fields nobody checks: a caller without type checks."""
    copy = object.__new__(type(item))
    for field in dataclasses.fields(item):
        value = fields.get(field.name, getattr(item, field.name))
        object.__setattr__(copy, field.name, value)
    return copy


def map_of(views, settings=SETTINGS, camera=CAMERA):
    mapper = PanopticMapper(camera, settings)
    for frame, segments in views:
        mapper.integrate(frame, segments)
    return mapper


def same_surface(a, b):
    one, other = a.surface(), b.surface()
    return all(
        np.array_equal(getattr(one.mesh, name), getattr(other.mesh, name))
        for name in ("vertices", "faces", "colors", "normals")
    ) and np.array_equal(one.instance, other.instance)


def with_depth(change):
    """The first view with its depth changed."""
    frame, segments = VIEWS[0]
    depth_m = frame.depth_m.copy()
    return forged(frame, depth_m=change(depth_m)), segments


def with_frame(**fields):
    frame, segments = VIEWS[0]
    return forged(frame, **fields), segments


def with_segments(**fields):
    frame, segments = VIEWS[0]
    return frame, forged(segments, **fields)


def with_pose(change):
    T = VIEWS[0][0].T_world_camera.astype(np.float64)
    return with_frame(T_world_camera=change(T).astype(np.float32))


def put(values, value, rows):
    values[rows] = value
    return values


def moved(offset):
    def change(T):
        T[:3, 3] += offset
        return T

    return change


MOST, FEW = np.s_[:100], np.s_[:20]
"""Rows of 120."""
FRAME, SEGMENTS = VIEWS[0]
REFUSED = {
    "mostly NaN": (with_depth(lambda d: put(d, np.nan, MOST)), "is NaN, infinite or negative"),
    "mostly infinite": (with_depth(lambda d: put(d, np.inf, MOST)), "is NaN, infinite or negative"),
    "mostly negative": (with_depth(lambda d: put(d, -1.0, MOST)), "is NaN, infinite or negative"),
    "depth in millimetres": (with_depth(lambda d: 1000 * d), "to 4.99e.03 m, a room's"),
    "depth in centimetres": (with_depth(lambda d: 100 * d), "m, a room's lies within 0.01 to 20 m"),
    "metres read as millimetres": (with_depth(lambda d: d / 1000), "to 0.0"),
    "beyond float32": (with_depth(lambda d: d.astype(np.float64) * 1e300), "is NaN, infinite"),
    "raw 16-bit depth": (with_depth(lambda d: (1000 * d).astype(np.uint16)), "depth is uint16"),
    "depth of another size": (with_depth(lambda d: d[::2, ::2]), r"depth of \(60, 80\) pixels"),
    "depth with a channel axis": (with_depth(lambda d: d[..., None]), r"depth of \(120, 160, 1\)"),
    "colour of another size": (with_frame(color=FRAME.color[:60]), r"colour of \(60, 160, 3\)"),
    "grey colour": (with_frame(color=FRAME.color[..., 0]), r"colour of \(120, 160\)"),
    "colour from 0 to 1": (with_frame(color=FRAME.color / 255.0), "colour is float64"),
    "another camera": (
        with_frame(camera=Camera(65.0, 65.0, 39.5, 29.5, 160, 120)),
        "fx, fy, cx, cy = 65, 65, 39.5, 29.5, the map's camera has 130, 130",
    ),
    "pose of NaN": (with_pose(lambda T: T * np.nan), "no finite 4x4 matrix"),
    "pose of 3x4": (with_pose(lambda T: T[:3]), "no finite 4x4 matrix"),
    "pose of zeros": (with_pose(lambda T: 0 * T), "no rotation and translation"),
    "pose with scale": (with_pose(lambda T: np.diag([2, 2, 2, 1]) @ T), "no rotation"),
    "mirrored pose": (with_pose(lambda T: T @ np.diag([1, 1, -1, 1.0])), "det R = -1"),
    "transposed pose": (with_pose(lambda T: T.T), "last row"),
    "10 km away": (with_pose(moved([1e4, 0, 0])), r"the camera is at 10001\.\d+, .* within 500 m"),
    "segments of another size": (
        with_segments(segment=SEGMENTS.segment[1:]),
        r"segments of \(119, 160\) pixels",
    ),
    "segments as floats": (with_segments(segment=SEGMENTS.segment / 2.0), "segments is float64"),
    "a segment beyond the table": (
        with_segments(segment=SEGMENTS.segment + 1),
        "segment runs from [01] to 3, the table has rows 0 to 2",
    ),
    "a negative segment": (with_segments(segment=SEGMENTS.segment - 1), "segment runs from -1"),
    "an unknown class": (
        with_segments(class_id=np.array([0, 1, len(classes())])),
        f"class_id runs from 0 to {len(classes())}",
    ),
    "a negative class": (with_segments(class_id=np.array([0, 1, -1])), "class_id runs from -1"),
    "a negative instance": (with_segments(instance=np.array([0, 1, -1])), "instance runs from -1"),
    "tables of two lengths": (with_segments(instance=np.array([0, 1])), r"instance is int64 of"),
    "tables without rows": (
        with_segments(class_id=np.zeros(0, int), instance=np.zeros(0, int)),
        r"class_id is int64 of \(0,\)",
    ),
    "too many segments": (
        with_segments(class_id=np.ones(5000, int), instance=np.ones(5000, int)),
        "5000 segments, at most 4095",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_frame_that_cannot_be_used_is_refused_and_the_map_goes_on(case):
    (frame, segments), says = REFUSED[case]
    mapper = map_of(VIEWS[:2])
    before = mapper.blocks.used, mapper.frames
    with pytest.raises(FrameError, match=says) as refused:
        mapper.integrate(frame, segments)
    assert "frame 000000" in refused.value.problem and refused.value.hint
    assert (mapper.blocks.used, mapper.frames) == before
    mapper.integrate(*VIEWS[2])
    assert same_surface(mapper, map_of(VIEWS[:3]))


NO_RETURN = {
    "NaN": lambda d: put(d, np.nan, FEW),
    "infinite": lambda d: put(d, np.inf, FEW),
    "minus infinite": lambda d: put(d, -np.inf, FEW),
    "negative": lambda d: put(d, -1.0, FEW),
    "saturated": lambda d: put(d, 65.535, FEW),
    "beyond the packed range": lambda d: put(d, 104.9, FEW),
    "beyond 16 bits": lambda d: put(d, 1e9, FEW),
    "in double precision": lambda d: put(d, 0.0, FEW).astype(np.float64),
}


@pytest.mark.parametrize("case", NO_RETURN)
def test_depth_that_is_no_return_is_as_zero(case):
    zero = with_depth(lambda d: put(d, 0.0, FEW))
    assert same_surface(map_of([with_depth(NO_RETURN[case])]), map_of([zero]))


def test_a_frame_that_is_mostly_saturated_is_one_with_few_returns():
    few = map_of([with_depth(lambda d: put(d, 65.535, MOST))])
    assert same_surface(few, map_of([with_depth(lambda d: put(d, 0.0, MOST))]))
    assert len(few.surface().mesh.faces) > 100


def test_a_frame_without_returns_is_counted_and_changes_nothing():
    mapper = map_of([*VIEWS[:2], with_depth(lambda d: 0 * d)])
    assert mapper.frames == 3
    assert same_surface(mapper, map_of(VIEWS[:2]))


def test_a_map_of_frames_without_returns_only_is_empty(tmp_path):
    mapper = map_of([with_depth(lambda d: 0 * d)] * 2)
    assert mapper.blocks.used == 0 and len(mapper.surface().mesh.faces) == 0
    mapper.save(tmp_path / "map.npz")
    loaded = PanopticMapper.load(tmp_path / "map.npz")
    loaded.integrate(*VIEWS[0])
    assert same_surface(loaded, map_of([with_depth(lambda d: 0 * d)] * 2 + VIEWS[:1]))


def test_dynamic_classes_are_no_return_whatever_row_zero_says():
    frame, segments = VIEWS[0]
    with_person = forged(segments, class_id=np.array([PERSON, FLOOR, PERSON], np.int32))
    hidden = np.where(segments.segment == 2, np.float32(0), frame.depth_m)
    bare = forged(segments, segment=np.where(segments.segment == 2, 0, segments.segment))
    assert same_surface(
        map_of([(frame, with_person)]), map_of([(forged(frame, depth_m=hidden), bare)])
    )


def test_the_frame_stays_the_callers():
    """Read-only images are integrated, and are not written to."""
    frame, segments = VIEWS[0]
    depth_m = put(frame.depth_m.copy(), np.nan, FEW)
    for image in (depth_m, frame.color, segments.segment):
        image.setflags(write=False)
    mapper = map_of([(forged(frame, depth_m=depth_m), segments)])
    assert mapper.frames == 1 and np.isnan(depth_m[FEW]).all()


@pytest.mark.parametrize("depth_m", [0.02, 0.051, 0.06])
def test_a_camera_inside_a_wall_adds_nothing_but_what_it_sees(depth_m):
    """Depth below 5 cm is nearer than any voxel is updated; from there on it is a surface."""
    mapper = map_of(VIEWS[:2])
    faces = len(mapper.surface().mesh.faces)
    mapper.integrate(*with_depth(lambda d: np.full_like(d, depth_m)))
    surface = mapper.surface()
    assert np.all(np.isfinite(surface.mesh.vertices))
    assert abs(len(surface.mesh.faces) - faces) < 100
    mapper.integrate(*VIEWS[2])
    assert mapper.frames == 4


def test_one_frame_makes_a_surface():
    surface = map_of(VIEWS[:1]).surface()
    error = np.min([s.distance(surface.mesh.vertices.astype(float)) for s in SOLIDS], 0)
    assert len(surface.mesh.faces) > 500 and np.median(error) < 0.005


def teleported(metres):
    """The first view, of a room that stands this far away along x and y."""
    frame, segments = VIEWS[0]
    T = frame.T_world_camera.copy()
    T[:2, 3] += metres
    return forged(frame, T_world_camera=T), segments


def test_a_camera_that_teleports_is_fused_where_it_says_it_is():
    mapper = map_of([*VIEWS[:2], teleported(30.0), VIEWS[2]])
    vertices = mapper.surface().mesh.vertices
    far = vertices[:, 0] > 20
    assert np.all(vertices[far, :2] > 20) and 500 < far.sum() < len(vertices) / 2
    here = map_of(VIEWS[:3]).surface().mesh.vertices
    assert np.array_equal(np.sort(vertices[~far], 0), np.sort(here, 0))


def test_a_map_that_would_span_a_city_is_refused_and_kept(tmp_path):
    mapper = map_of(VIEWS[:2])
    frame, segments = teleported(400.0)
    T = frame.T_world_camera.copy()
    T[2, 3] = 300.0
    with pytest.raises(MapError, match="the map spans") as refused:
        mapper.integrate(forged(frame, T_world_camera=T), segments)
    assert "voxel_size_m" in refused.value.hint
    assert_goes_on(mapper, map_of(VIEWS[:2]), tmp_path)


def test_a_map_that_is_full_is_kept_saved_and_asked_for_its_surface(tmp_path):
    whole = map_of(VIEWS)
    settings = dataclasses.replace(SETTINGS, block_capacity=64, max_blocks=whole.blocks.used - 50)
    mapper = PanopticMapper(CAMERA, settings)
    with pytest.raises(MapError, match=r"max_blocks = \d+") as refused:
        for view in VIEWS:
            mapper.integrate(*view)
    fits = mapper.frames
    assert 0 < fits < len(VIEWS)
    assert "raise MappingSettings.max_blocks" in refused.value.hint
    assert_goes_on(mapper, map_of(VIEWS[:fits]), tmp_path)


def assert_goes_on(mapper, expected, tmp_path):
    """A map whose last frame was refused is as without it: surface, checkpoint, the next frame."""
    assert same_surface(mapper, expected)
    mapper.save(tmp_path / "map.npz")
    loaded = PanopticMapper.load(tmp_path / "map.npz")
    assert same_surface(loaded, expected)
    for each in (mapper, loaded, expected):
        each.integrate(*VIEWS[0])
    assert same_surface(mapper, expected) and same_surface(loaded, expected)


@pytest.mark.parametrize(
    ("camera", "says"),
    [
        (Camera(260.0, 260.0, 159.5, 119.5, 160, 120), "cx = 159.5: the principal point"),
        (Camera(65.0, 65.0, 39.5, 29.5, 160, 120), "cx = 39.5: the principal point"),
        (Camera(130.0, 130.0, 79.5, np.nan, 160, 120), "cy = nan"),
        (Camera(0.0, 130.0, 79.5, 59.5, 160, 120), "fx = 0: a focal length"),
        (Camera(130.0, -130.0, 79.5, 59.5, 160, 120), "fy = -130: a focal length"),
        (Camera(np.inf, 130.0, 79.5, 59.5, 160, 120), "fx = inf"),
        (Camera(0.9, 0.9, 79.5, 59.5, 160, 120), "fx = 0.9"),
        (Camera(130.0, 130.0, 79.5, 59.5, 0, 120), "camera of 0x120 pixels"),
    ],
)
def test_intrinsics_of_another_resolution_are_refused_at_once(camera, says):
    with pytest.raises(MapError, match=says) as refused:
        PanopticMapper(camera, SETTINGS)
    assert refused.value.hint


def test_the_farthest_room_that_is_taken_is_as_good_as_one_at_the_origin():
    """A floor 500 m away is as flat as one at the origin, to a tenth of a millimetre."""
    medians = []
    for away in (0.0, 498.0):
        pose = look_at((away + 1, -away, 1.2), (away, 1 - away, 0.3))
        vertices = map_of([render(SOLIDS[:1], pose)]).surface().mesh.vertices
        medians.append(np.median(SOLIDS[0].distance(vertices.astype(float))))
    assert abs(medians[1] - medians[0]) < 1e-4
