"""Whatever a frame holds, the map integrates it or says why not, and stays a map that answers."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from isr_jax.classes import classes
from isr_jax.config import MappingSettings
from isr_jax.errors import IsrError
from isr_jax.mapping import PanopticMapper
from isr_jax.types import Camera, Frame, FrameSegments

WIDTH, HEIGHT = 32, 24
CAMERA = Camera(26.0, 26.0, 15.5, 11.5, WIDTH, HEIGHT)
SETTINGS = MappingSettings(voxel_size_m=0.1, block_capacity=64, max_blocks=4096, min_votes=1)
EXTREME = [
    SETTINGS,
    dataclasses.replace(SETTINGS, truncation_voxels=1.0, label_band_voxels=20.0, label_slots=1),
    dataclasses.replace(SETTINGS, max_weight=1.0, max_blocks=64),
]
STRANGE = (0.0, -0.0, 1e-45, 1e-3, 0.05, 65.535, 104.8, 104.9, 1e4, 3e38, -1.0, np.nan, np.inf)
DTYPES = ("float16", "float32", "float64", "uint8", "uint16", "int32", "int64", "uint64", "bool")


def mostly(usual, *others):
    """The usual most times, so that frames with one fault occur."""
    return st.sampled_from([usual] * 60 + list(others))


WIDE = (HEIGHT, WIDTH + 1), (WIDTH, HEIGHT), (0, WIDTH), (1, 1)
VIEWS = st.fixed_dictionaries(
    {
        "seed": st.integers(0, 2**31),
        "size": mostly((HEIGHT, WIDTH), *WIDE),
        "depth_m": mostly((0.4, 3.0), (0.0, 0.0), (500.0, 3e3), (25.0, 60.0), (1e-4, 5e-3)),
        "strange_share": mostly(0.0, 0.1, 0.9, 1.0),
        "strange": st.lists(st.sampled_from(STRANGE), min_size=1),
        "depth_type": mostly("float32", *DTYPES),
        "segments": mostly(5, 0, 1, 300, 5000),
        "segment": mostly((0, 5), (0, 1), (-3, 5), (0, 1 << 40)),
        "segment_type": mostly("int32", *DTYPES),
        "class_id": mostly((0, len(classes())), (-1, 5), (0, 2 * len(classes()))),
        "class_type": mostly("int32", "int64", "float32"),
        "instance": mostly((0, 50), (-1, 5), (0, 1 << 40)),
        "instances": mostly(0, 1),
        "channels": mostly(3, 1, 4),
        "color_type": mostly("uint8", "float32", "int64"),
        "rotation": mostly(1.0, -1.0, 0.0, 1.02, 1e30),
        "position_m": mostly(2.0, 0.0, 30.0, 600.0, 1e9, np.inf),
        "corner": mostly(1.0, np.nan, 0.0, 2.0),
        "rows": mostly(4, 3),
        "pose_type": mostly("float32", "float64", "float16", "int32"),
        "camera": mostly(CAMERA, Camera(13.0, 13.0, 7.5, 5.5, WIDTH // 2, HEIGHT // 2)),
    }
)


def made(view) -> tuple[Frame, FrameSegments]:
    """A frame and its segments as described, most of it usual."""
    rng = np.random.default_rng(view["seed"])
    size, count = view["size"], view["segments"]
    depth_m = rng.uniform(*view["depth_m"], size)
    strange = rng.random(size) < view["strange_share"]
    depth_m = np.where(strange, rng.choice(view["strange"], size), depth_m)
    with np.errstate(all="ignore"):
        depth_m, T = depth_m.astype(view["depth_type"]), pose(view, rng)
    frame = unchecked(
        Frame,
        index=0,
        name="x",
        color=rng.integers(0, 255, (*size, view["channels"])).astype(view["color_type"]),
        depth_m=depth_m,
        T_world_camera=T,
        camera=view["camera"],
    )
    segments = unchecked(
        FrameSegments,
        segment=rng.integers(*view["segment"], size).astype(view["segment_type"]),
        class_id=rng.integers(*view["class_id"], count).astype(view["class_type"]),
        instance=rng.integers(*view["instance"], count + view["instances"]),
    )
    return frame, segments


def pose(view, rng) -> np.ndarray:
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    T = np.eye(4)
    T[:3, :3] = Q * np.sign(np.linalg.det(Q)) * view["rotation"]
    T[:3, 3] = rng.uniform(-1, 1, 3) * view["position_m"]
    T[3, 3] = view["corner"]
    return T[: view["rows"]].astype(view["pose_type"])


def unchecked(kind, **fields):
    """A dataclass that no type checker has seen."""
    item = object.__new__(kind)
    for name, value in fields.items():
        object.__setattr__(item, name, value)
    return item


@pytest.mark.parametrize("chosen", EXTREME, ids=["usual", "thin", "full"])
@settings(max_examples=25, deadline=None)
@given(views=st.lists(VIEWS, min_size=1, max_size=4))
def test_a_frame_is_integrated_or_refused_and_the_map_still_answers(
    tmp_path_factory, chosen, views
):
    mapper, used = PanopticMapper(CAMERA, chosen), 0
    for view in views:
        try:
            mapper.integrate(*made(view))
            used += 1
        except IsrError as error:
            assert error.problem and error.hint
    assert mapper.frames == used
    mesh = answers(mapper)
    path = tmp_path_factory.mktemp("map") / "map.npz"
    mapper.save(path)
    assert np.array_equal(answers(PanopticMapper.load(path)).vertices, mesh.vertices)


def answers(mapper):
    """The surface of a map, which is sound."""
    surface = mapper.surface()
    mesh = surface.mesh
    assert np.all(np.isfinite(mesh.vertices)) and np.all(np.isfinite(mesh.normals))
    assert mesh.faces.min(initial=0) >= 0 and mesh.faces.max(initial=-1) < len(mesh.vertices)
    assert set(surface.instance.tolist()) <= {0, *surface.instance_ids.tolist()}
    assert len(surface.class_ids) == len(surface.instance_ids)
    assert np.all((surface.class_ids >= 0) & (surface.class_ids < len(classes())))
    return mesh
