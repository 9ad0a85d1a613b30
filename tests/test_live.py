"""Asked while it grows: `LiveMap` frame by frame, and the map's files that `isr map` writes."""

# ruff: noqa: F811 (fixtures of other modules)

from __future__ import annotations

import json
import re
import struct
import sys

import numpy as np
import pytest
import trimesh

from isr_jax import cli
from isr_jax.classes import class_named, classes, number_by_class
from isr_jax.config import preset, with_overrides
from isr_jax.datasets import open_sequence
from isr_jax.errors import FrameError, MapError, SequenceError
from isr_jax.map_runs import live
from isr_jax.map_runs.live import LiveMap
from isr_jax.map_runs.make_map import make_map
from isr_jax.map_runs.map_files import UNLABELLED, map_instances, write_map
from isr_jax.mapping import MapBatch, PanopticMapper
from isr_jax.pipeline import map_sequence
from isr_jax.runtime.stage_runner import StageRunner
from isr_jax.runtime.store import StageStore
from isr_jax.segmentation import open_segmenter
from isr_jax.types import Camera, Mesh, PanopticFrame, PanopticSurface

from .conftest import REPOSITORY
from .films import COARSE, Recorder, coarse, film  # noqa: F401
from .reference.mapping_reference import CAMERA, Solid, orbit, render

FLOOR, TABLE, BOWL = (class_named(n).id for n in ("floor", "table", "bowl"))
SOLIDS = [
    Solid("plane", (0, 0, 1), 0.0, class_id=FLOOR, color=(120, 120, 120)),
    Solid("box", (0, 0, 0.37), (0.4, 0.3, 0.37), yaw=0.35, class_id=TABLE),
    Solid("ball", (0.1, 0.05, 0.86), 0.12, class_id=BOWL, color=(20, 40, 220)),
]


PERFECT = "simulated:perfect"


def small():
    return with_overrides(
        preset("default"), ["mapping.voxel_size_m=0.03", "segmentation.min_segment_px=40"]
    )


@pytest.fixture(scope="module")
def rendered():
    return [render(SOLIDS, T, index=i) for i, T in enumerate(orbit((0, 0, 0.4), 1.6, 1.1, 8))]


@pytest.fixture(scope="module")
def segmenter(rendered):
    """A plain function: the true masks by the frame's index."""
    true = [segments for _, segments in rendered]

    def masks(frame):
        segments = true[frame.index]
        score = np.ones(len(segments.class_id), np.float32)
        return PanopticFrame(segments.segment, segments.class_id, score)

    return masks


@pytest.fixture(scope="module")
def grown(rendered, segmenter):
    map_ = LiveMap(CAMERA, segmenter, small())
    for frame, _ in rendered:
        map_.integrate(frame)
    return map_


def test_it_answers_between_any_two_frames(rendered, segmenter):
    """The mesh grows; the table is found, and the bowl upon it, before the last frame."""
    map_ = LiveMap(CAMERA, segmenter, small())
    assert len(map_.mesh().faces) == 0
    sizes = []
    for frame, _ in rendered:
        map_.integrate(frame)
        sizes.append(len(map_.mesh().vertices))
    assert sizes[0] > 500 and sizes[-1] > 1.5 * sizes[0]
    names = [e.class_name for e in map_.entities()]
    assert {"floor", "table", "bowl"} <= set(names)
    graph = map_.contact_graph()
    assert graph.parent[names.index("bowl")] == names.index("table")
    assert graph.parent[names.index("table")] == names.index("floor")


def test_answers_are_kept_until_the_next_frame(rendered, segmenter):
    map_ = LiveMap(CAMERA, segmenter, small())
    map_.integrate(rendered[0][0])
    entities, graph, mesh = map_.entities(), map_.contact_graph(), map_.mesh()
    assert map_.entities() is entities and map_.contact_graph() is graph and map_.mesh() is mesh
    map_.integrate(rendered[1][0])
    assert map_.entities() is not entities and map_.contact_graph() is not graph


def test_asking_changes_nothing(rendered, segmenter, grown):
    map_ = LiveMap(CAMERA, segmenter, small())
    for frame, _ in rendered:
        map_.integrate(frame)
        map_.contact_graph()
    for name in ("vertices", "faces", "colors", "normals"):
        assert np.array_equal(getattr(map_.mesh(), name), getattr(grown.mesh(), name))
    assert np.array_equal(map_.surface().instance, grown.surface().instance)


def test_saved_and_loaded_goes_on(rendered, segmenter, grown, tmp_path):
    map_ = LiveMap(CAMERA, segmenter, small())
    for frame, _ in rendered[:5]:
        map_.integrate(frame)
    map_.save(tmp_path / "map.npz")
    again = LiveMap.load(tmp_path / "map.npz", segmenter, small())
    assert again.frames == 5
    for frame, _ in rendered[5:]:
        again.integrate(frame)
    assert np.array_equal(again.mesh().vertices, grown.mesh().vertices)
    assert np.array_equal(again.surface().instance, grown.surface().instance)


def test_a_frame_without_masks_leaves_the_map_as_it_was(rendered, segmenter):
    def fails_on_two(frame):
        if frame.index == 2:
            raise FrameError("frame 2 has no masks", "skip it")
        return segmenter(frame)

    map_ = LiveMap(CAMERA, fails_on_two, small())
    map_.integrate(rendered[1][0])
    before = map_.mesh()
    with pytest.raises(FrameError, match="no masks"):
        map_.integrate(rendered[2][0])
    assert map_.frames == 1 and map_.mesh() is before
    map_.integrate(rendered[3][0])


def test_the_example_in_the_docstring_runs(rendered, segmenter, tmp_path, monkeypatch, capsys):
    example = re.search(r"\n\n((?:    .*\n|\n)+)", live.__doc__).group(1)
    code = re.sub(r"^    ", "", example, flags=re.MULTILINE)
    stream = [(f.color, f.depth_m, f.T_world_camera) for f, _ in rendered]
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(live, "preset", lambda _: small())
    numbers = "fx=525.0, fy=525.0, cx=319.5, cy=239.5, width=640, height=480"
    assert numbers in code
    here = "fx=130.0, fy=130.0, cx=79.5, cy=59.5, width=160, height=120"
    exec(code.replace(numbers, here), {"segmenter": segmenter, "stream": stream})
    assert "carries" in capsys.readouterr().out and (tmp_path / "map.npz").is_file()


# The files of a map.


def ply_properties(path):
    header = path.read_bytes().split(b"end_header")[0].decode()
    return re.findall(r"property (\w+) (\w+)$", header, flags=re.MULTILINE)


def glb_tree(path):
    content = path.read_bytes()
    (length,) = struct.unpack_from("<I", content, 12)
    return json.loads(content[20 : 20 + length])


@pytest.fixture(scope="module")
def written(grown, tmp_path_factory):
    folder = tmp_path_factory.mktemp("map")
    surface = grown.surface()
    return folder, surface, write_map(surface, folder, T_world_dataset=np.eye(4))


def test_the_scene_as_ply_has_colours_normals_instances_and_classes(written):
    folder, surface, _ = written
    kinds = {name: kind for kind, name in ply_properties(folder / "panoptic.ply")}
    assert kinds | {"x": "float", "nx": "float", "red": "uchar", "instance": "int"} == kinds
    mesh = trimesh.load(folder / "panoptic.ply", process=False)
    assert np.array_equal(mesh.vertices, surface.mesh.vertices)
    assert np.array_equal(mesh.faces, surface.mesh.faces)
    assert np.array_equal(mesh.visual.vertex_colors[:, :3], surface.mesh.colors)
    raw = mesh.metadata["_ply_raw"]["vertex"]["data"]
    assert np.array_equal(raw["instance"].ravel(), surface.instance)
    bowl = np.isin(surface.instance, surface.instance_ids[surface.class_ids == BOWL])
    assert bowl.any() and np.all(raw["class"].ravel()[bowl] == BOWL)


def test_instances_and_the_rest_add_up_to_the_scene(written):
    folder, surface, instances = written
    scene = trimesh.load(folder / "panoptic.glb", process=False)
    assert set(scene.geometry) <= {i.name for i in instances} | {UNLABELLED}
    faces = {name: len(g.faces) for name, g in scene.geometry.items()}
    assert sum(faces.values()) == len(surface.mesh.faces)
    for one in instances:
        assert faces[one.name] == len(one.mesh.faces)
    low, high = scene.bounds
    assert high[1] - low[1] == pytest.approx(np.ptp(surface.mesh.vertices[:, 2]), abs=1e-5)


def test_one_mesh_per_instance_named_by_class(written):
    folder, _, instances = written
    assert {"floor_1", "table_1", "bowl_1"} <= {i.name for i in instances}
    for one in instances:
        for suffix in (".ply", ".glb"):
            mesh = trimesh.load(folder / "instances" / (one.name + suffix), force="mesh")
            assert len(mesh.faces) == len(one.mesh.faces)
        attributes = glb_tree(folder / "instances" / f"{one.name}.glb")["meshes"][0]["primitives"]
        assert {"POSITION", "NORMAL", "COLOR_0"} <= set(attributes[0]["attributes"])


def test_instances_json_names_classes_and_files(written):
    folder, surface, instances = written
    said = json.loads((folder / "instances.json").read_text())
    assert [i["name"] for i in said["instances"]] == [i.name for i in instances]
    bowl = next(i for i in said["instances"] if i["class"] == "bowl")
    assert classes()[bowl["class_id"]].name == "bowl" and bowl["kind"] == "thing"
    assert (folder / bowl["ply"]).is_file() and (folder / bowl["glb"]).is_file()
    assert bowl["low"][2] > 0.6 and bowl["high"][2] < 1.1
    assert said["voxel_size_m"] == surface.voxel_size_m


def test_files_of_instances_that_are_gone_go(written, tmp_path):
    _, surface, _ = written
    write_map(surface, tmp_path, T_world_dataset=np.eye(4))
    (tmp_path / "instances" / "chair_9.ply").write_text("old")
    (tmp_path / "instances" / "notes.txt").write_text("mine")
    write_map(surface, tmp_path, T_world_dataset=np.eye(4))
    assert not (tmp_path / "instances" / "chair_9.ply").exists()
    assert (tmp_path / "instances" / "notes.txt").exists()


def surface_of(vertices, faces, instance, class_name):
    """All instances of one class, normals up."""
    vertices = np.array(vertices, np.float32)
    normals = np.tile(np.float32([0, 0, 1]), (len(vertices), 1))
    mesh = Mesh(vertices, np.array(faces, np.int32), None, normals)
    ids = np.unique(instance).astype(np.int32)
    class_ids = np.full(len(ids), class_named(class_name).id, np.int32)
    return PanopticSurface(mesh, np.array(instance, np.int32), ids, class_ids, 0.02)


def test_each_face_has_one_owner():
    """Two chairs, 1 and 2 faces, that share an edge; a face belongs to most of its corners."""
    vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]]
    faces = [[0, 1, 2], [1, 3, 2], [1, 4, 3]]
    surface = surface_of(vertices, faces, [7, 5, 7, 5, 5], "chair")
    first, second = map_instances(surface)
    assert (first.name, first.id, len(first.mesh.faces)) == ("chair_1", 5, 2)
    assert (second.name, second.id, len(second.mesh.faces)) == ("chair_2", 7, 1)
    assert first.area_m2 == pytest.approx(1.0) and second.area_m2 == pytest.approx(0.5)


def test_the_first_of_a_class_has_the_largest_box_as_among_entities():
    """A wide flat chair has more area than a steep one, whose box is larger."""
    flat = [[0, 0, 0], [2, 0, 0], [0, 2, 0]]
    steep = [[5, 0, 0], [6, 0, 1], [5, 1, 1]]
    surface = surface_of(flat + steep, [[0, 1, 2], [3, 4, 5]], [3] * 3 + [4] * 3, "chair")
    first, second = map_instances(surface)
    assert [(one.name, one.id) for one in (first, second)] == [("chair_1", 4), ("chair_2", 3)]
    assert first.area_m2 < second.area_m2
    assert number_by_class(
        [("table", 0.2, 1), ("chair", 0.1, 9), ("table", 0.3, 2), ("chair", 0.1, 4)]
    ) == [(3, "chair_1"), (1, "chair_2"), (2, "table_1"), (0, "table_2")]


def test_an_empty_map_is_written_too(segmenter, tmp_path):
    surface = LiveMap(CAMERA, segmenter, small()).surface()
    assert write_map(surface, tmp_path, T_world_dataset=np.eye(4)) == []
    assert (tmp_path / "panoptic.ply").is_file() and (tmp_path / "panoptic.glb").is_file()


# The command.


def test_isr_map_writes_a_map_that_goes_on(film, tmp_path, monkeypatch, capsys):
    """Half the film, then the other half, is the whole film."""

    def isr_map(*arguments):
        command = ["isr", "map", str(film), "--segmenter", "simulated:perfect", *arguments]
        monkeypatch.setattr(sys, "argv", [*command, "--set", *COARSE])
        cli.main()
        return capsys.readouterr().out

    said = isr_map("--out", str(tmp_path / "whole"))
    assert "wall_1" in said and "24 frames, 0 skipped" in said
    first = make_map(
        film,
        tmp_path / "half",
        segmenter="simulated:perfect",
        settings=coarse("input.max_frames=12"),
    )
    assert first.live.frames == 12
    saved = str(tmp_path / "half" / "map" / "map.npz")
    isr_map("--out", str(tmp_path / "both"), "--start", "12", "--continue-from", saved)
    whole, both = (
        (tmp_path / name / "map" / "panoptic.ply").read_bytes() for name in ("whole", "both")
    )
    assert whole == both


def test_what_was_integrated_before_an_error_is_kept(film, tmp_path):
    recorder = Recorder(die_after=6)
    with pytest.raises(KeyboardInterrupt):
        make_map(film, tmp_path, segmenter=PERFECT, settings=coarse(), reporter=recorder)
    kept = LiveMap.load(tmp_path / "map" / "map.npz", lambda _: None)
    assert kept.frames == 6
    assert len(trimesh.load(tmp_path / "map" / "panoptic.ply").faces)


def test_a_checkpoint_of_a_run_goes_on_as_a_map(film, tmp_path):
    """`isr run` and `isr map` save a map in one format, with the world in which it lies."""
    sequence, settings = open_sequence(film), coarse()
    masks = open_segmenter(PERFECT, film)
    store, recorder = StageStore(tmp_path / "stages"), Recorder(die_after=11)
    with pytest.raises(KeyboardInterrupt):
        map_sequence(sequence, masks, settings, StageRunner(store, recorder))
    (saved,) = (tmp_path / "stages").glob("mapping.checkpoint-*.npz")
    made = make_map(
        film, tmp_path, segmenter=PERFECT, settings=settings, start=10, continue_from=saved
    )
    whole = map_sequence(sequence, masks, settings, StageRunner())
    assert made.live.frames == whole.frames_used
    assert np.array_equal(made.live.mesh().vertices, whole.surface.mesh.vertices)
    assert np.array_equal(made.live.surface().instance, whole.surface.instance)


def test_a_map_that_cannot_go_on_is_refused(film, grown, tmp_path):
    def go_on(path):
        options = {"segmenter": "simulated:perfect", "settings": coarse()}
        return make_map(film, tmp_path / "out", continue_from=path, **options)

    with pytest.raises(MapError, match=r"map\.npz cannot be read as a map"):
        go_on(tmp_path / "map.npz")
    grown.save(tmp_path / "map.npz")
    with pytest.raises(MapError, match="another camera"):
        go_on(tmp_path / "map.npz")
    with pytest.raises(SequenceError, match="none from 99 on"):
        make_map(film, tmp_path / "o", segmenter="simulated:perfect", settings=coarse(), start=99)
    assert not (tmp_path / "o" / "map").exists()  # nor is a map that lies there written over


PAGE = REPOSITORY / "docs" / "panoptic_map.md"


def test_the_example_of_a_batch_in_the_documentation_runs(rendered, tmp_path, monkeypatch):
    """Two films in one batch; each map is as by itself."""
    (code,) = re.findall(
        r"```python\n(from isr_jax\.mapping import .*?)```", PAGE.read_text(), re.S
    )
    monkeypatch.chdir(tmp_path)
    films = [rendered[:3], rendered[3:6]]
    given = {"camera": CAMERA, "settings": small(), "films": films}
    exec(code, given)
    for film_, saved in zip(films, ("room_1.npz", "room_2.npz"), strict=True):
        alone = PanopticMapper(CAMERA, small().mapping)
        for frame, segments in film_:
            alone.integrate(frame, segments)
        both = PanopticMapper.load(tmp_path / saved).surface(), alone.surface()
        assert np.array_equal(both[0].mesh.vertices, both[1].mesh.vertices)
        assert np.array_equal(both[0].instance, both[1].instance)
    assert given["MapBatch"] is MapBatch


def test_the_command_is_in_the_documentation():
    text = PAGE.read_text("utf-8")
    assert "isr map" in text and "LiveMap" in text
    assert Camera.__name__ in text
