"""What a folder or archive holds: every kind in its own format, and nothing twice."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from isr_jax.cad.importing.reading.files import FolderFiles, ZipFiles
from isr_jax.cad.importing.reading.limits import ReadLimits
from isr_jax.cad.importing.reading.sources import Item, find_models
from isr_jax.errors import LibraryError
from isr_jax.robot_model import merged_mesh

from .foreign_models import (
    BOMB,
    MJCF,
    cube_obj,
    cube_stl,
    glb,
    png,
    sh3f_catalogue,
    sh3f_entry,
    urdf,
    write,
    write_zip,
)


def found(items: list[Item]) -> list[tuple[str, str]]:
    return [(item.kind, item.source) for item in items]


def refusals(items: list[Item]) -> dict[str, str]:
    """Reason of each item that cannot be read; those that can are read."""
    reasons = {}
    for item in items:
        try:
            item.read()
        except LibraryError as error:
            reasons[item.source] = error.problem
    return reasons


def test_every_kind_is_recognised_once(tmp_path: Path) -> None:
    root = write(
        tmp_path / "all",
        {
            "chair.obj": cube_obj(head="mtllib chair.mtl"),
            "chair.mtl": "newmtl a",
            "lamp.glb": glb(),
            "robots/cupboard.urdf": urdf(),
            "robots/meshes/door.obj": cube_obj(),
            "robots/meshes/unused.obj": cube_obj(),
            "mj/drawer.xml": MJCF.replace("<asset>", '<include file="parts.xml"/><asset>'),
            "mj/parts.xml": "<mujocoinclude><option timestep='0.01'/></mujocoinclude>",
            "mj/meshes/front.stl": cube_stl(),
            "package.xml": "<package/>",
            "broken.xml": "<not closed",
            "notes.txt": "hello",
            "table.csv": "a,b\n1,2\n",
            ".hidden/x.obj": cube_obj(),
        },
    )
    items = find_models(root)
    assert found(items) == [
        ("mesh", "all/chair.obj"),
        ("mesh", "all/lamp.glb"),
        ("mjcf", "all/mj/drawer.xml"),
        ("urdf", "all/robots/cupboard.urdf"),
        ("mesh", "all/robots/meshes/unused.obj"),
    ]
    models = [model for item in items for model in item.read()]
    assert [m.name for m in models] == ["chair", "lamp", "drawer", "cupboard", "unused"]
    assert models[4].tags == ("unused", "meshes", "robots", "all")
    assert [m.source for m in models] == [item.source for item in items]


def test_one_file_or_one_archive_is_enough(tmp_path: Path) -> None:
    write(tmp_path, {"box/chair.obj": cube_obj(), "box/other.obj": cube_obj()})
    assert found(find_models(tmp_path / "box" / "chair.obj")) == [("mesh", "box/chair.obj")]
    path = write_zip(tmp_path / "box" / "more.zip", {"a/model.obj": cube_obj(), "a/t.png": png()})
    (item,) = find_models(path)
    assert found([item]) == [("mesh", "more.zip/a/model.obj")]
    assert item.read()[0].name == "a"
    assert len(find_models(tmp_path)) == 3


def test_nothing_to_find_is_said(tmp_path: Path) -> None:
    with pytest.raises(LibraryError, match="no such file or folder"):
        find_models(tmp_path / "none")
    with pytest.raises(LibraryError, match="holds no models") as caught:
        find_models(write(tmp_path, {"readme.txt": "x"}))
    assert "PartNet-Mobility" in caught.value.hint


def test_bad_robots_and_archives_are_items_that_say_why(tmp_path: Path) -> None:
    write(
        tmp_path,
        {
            "bomb.xml": f"{BOMB}<mujoco>&c;</mujoco>",
            "bomb.urdf": f"{BOMB}<robot/>",
            "cut.urdf": urdf()[:-20],
            "wrong.urdf": MJCF,
            "broken.zip": b"PK\x03\x04 no",
            "good.obj": cube_obj(),
        },
    )
    write_zip(tmp_path / "evil.zip", {"../../evil.obj": cube_obj(), "fine.obj": cube_obj()})
    reasons = refusals(find_models(tmp_path))
    label = tmp_path.name
    assert set(reasons) == {
        f"{label}/bomb.xml",
        f"{label}/bomb.urdf",
        f"{label}/cut.urdf",
        f"{label}/wrong.urdf",
        f"{label}/broken.zip",
        "evil.zip/../../evil.obj",
    }
    assert "document type" in reasons[f"{label}/bomb.xml"]
    assert "root is <mujoco>" in reasons[f"{label}/wrong.urdf"]
    assert "leads out of the archive" in reasons["evil.zip/../../evil.obj"]


def test_partnet_mobility(tmp_path: Path) -> None:
    door, handle = '<visual name="door_frame-3">', '<visual name="handle-7">'
    place = '<origin xyz="0.5 -0.03 0.5"/><geometry><box size="0.02 0.04 0.1"/></geometry></visual>'
    text = urdf("textured_objs/original-1.obj").replace('<visual name="panel">', door)
    text = text.replace(door, handle + place + door)
    root = write(
        tmp_path / "dataset",
        {
            "45132/mobility.urdf": text,
            "45132/semantics.txt": "carcass static furniture_body\ndoor hinge rotation_door\nx\n",
            "45132/meta.json": json.dumps({"model_cat": "StorageFurniture", "anno_id": "45132"}),
            "45132/textured_objs/original-1.obj": cube_obj(),
            "45132/point_sample/pts.ply": "ply",
            "99/mobility.urdf": urdf("door.obj"),
            "99/door.obj": cube_obj(),
            "99/semantics.txt": "carcass free lid\n",
        },
    )
    items = find_models(root)
    assert [item.kind for item in items] == ["partnet", "partnet"]
    (first,), (second,) = (item.read() for item in items)
    assert first.name == "storage_furniture_45132" and first.unit_m is None
    assert first.tags[0] == "StorageFurniture" and "rotation_door" in first.tags
    assert first.front is not None and first.front.tolist() == [-1, 0, 0]
    np.testing.assert_allclose(first.handles["door_hinge"], [0.5, -0.03, 0.5])
    assert first.licence is not None and "PartNet-Mobility" in first.licence
    assert "1 lines of semantics.txt name no link" in first.notes
    assert second.name == "partnet_99" and "meta.json is missing: no category" in second.notes


SEM_HEAD = "fullId,category,wnsynset,wnlemmas,up,front,unit,aligned.dims,isContainerLike,"
SEM_HEAD += "weight,name,tags\n"
SEM_ROWS = (
    'wss.aa1,"Chair,_Attributes,OfficeChair",n1,"chair,seat","0.0\\,0.0\\,1.0","0.0\\,-1.0\\,0.0",'
    '0.0254,"40\\,50\\,90",false,12.5,Swivel chair,"office\\,blue"\n'
    'wss.bb2,Lamp,n2,lamp,"0\\,1",,none,,,,,\n'
    "wss.cc3,Table,n3,table,,,0.01,,,,,\n"
)


def test_shapenet_sem(tmp_path: Path) -> None:
    root = write(
        tmp_path / "sem",
        {
            "metadata.csv": SEM_HEAD + SEM_ROWS,
            "models/aa1.obj": cube_obj(head="mtllib aa1.mtl\nusemtl a", uv=True),
            "models/aa1.mtl": "newmtl a\nmap_Kd t.jpg",
            "models/bb2.obj": cube_obj(),
            "models/other.obj": cube_obj(),
        },
    )
    items = find_models(root)
    assert found(items) == [
        ("shapenet_sem", "sem/models/aa1.obj"),
        ("shapenet_sem", "sem/models/bb2.obj"),
        ("mesh", "sem/models/other.obj"),
    ]
    chair, lamp = items[0].read()[0], items[1].read()[0]
    assert chair.unit_m == 0.0254 and chair.up is not None and chair.front is not None
    assert (chair.up.tolist(), chair.front.tolist()) == ([0, 0, 1], [0, -1, 0])
    tags = ("Chair", "OfficeChair", "chair", "seat", "Swivel chair", "office", "blue")
    assert chair.tags == tags
    assert any("t.jpg is missing" in note for note in chair.notes)
    assert lamp.unit_m is None and lamp.up is None and lamp.front is None
    assert lamp.notes == (
        "unit 'none' of the table is no length",
        "up '0,1' of the table is no direction",
    )


def test_sweet_home_3d(tmp_path: Path) -> None:
    inner = write_zip(tmp_path / "inner.zip", {"door.obj": cube_obj((90, 200, 9))}).read_bytes()
    entries = [
        sh3f_entry("chair", elevation="12.5", name="Ch\\u00e8se"),
        sh3f_entry("side", modelRotation="0 0 1 0 1 0 -1 0 0", license="CC BY"),
        sh3f_entry("door", model="/test/door.zip", doorOrWindow="true"),
        sh3f_entry("gone"),
        sh3f_entry("flat", height="0"),
        sh3f_entry("out", model="/../../etc/passwd.obj"),
        sh3f_entry("odd", model="/test/odd.3ds"),
        sh3f_entry("bad", modelRotation="1 2 3"),
    ]
    files = {
        "PluginFurnitureCatalog.properties": sh3f_catalogue(entries).encode("latin-1"),
        "PluginFurnitureCatalog_fr.properties": "name#1=Chaise",
        "test/chair/chair.obj": cube_obj((2, 9, 5), head="mtllib chair.mtl\nusemtl a"),
        "test/chair/chair.mtl": "newmtl a\nKd 1 0 0",
        "test/side/side.obj": cube_obj((2, 9, 5)),
        "test/bad/bad.obj": cube_obj((2, 9, 5)),
        "test/flat/flat.obj": cube_obj(),
        "test/door.zip": inner,
        "test/odd.3ds": "MM",
    }
    items = find_models(write_zip(tmp_path / "test.sh3f", files))
    assert len(items) == 8 and {item.kind for item in items} == {"sweethome3d"}
    reasons = refusals(items)
    assert "holds no test/gone/gone.obj" in reasons["test.sh3f/gone"]
    assert "states a size" in reasons["test.sh3f/flat"]
    assert "leads out" in reasons["test.sh3f/out"]
    assert "format that is not read" in reasons["test.sh3f/odd"]
    models = {item.source: item.read()[0] for item in items if item.source not in reasons}
    chair = models["test.sh3f/chair"]
    assert chair.size_m is not None and chair.size_m.tolist() == [0.5, 0.6, 0.9]
    assert chair.tags == ("Chèse", "chair", "Seat", "Wood", "Office")
    assert (chair.licence, chair.creator, chair.elevation_m) == ("CC0", "Someone", 0.125)
    assert chair.up is not None and chair.up.tolist() == [0, 1, 0]
    assert chair.front is not None and chair.front.tolist() == [0, 0, 1]
    assert chair.robot.links[0].visuals[0].rgba == (1, 0, 0, 1)
    side = models["test.sh3f/side"]
    assert side.licence == "CC BY"
    np.testing.assert_allclose(np.ptp(merged_mesh(side.robot).vertices, axis=0), [5, 9, 2])
    assert models["test.sh3f/door"].mount == "opening"
    assert "no matrix: not turned" in models["test.sh3f/bad"].notes[0]


def test_an_unpacked_catalogue_and_an_empty_one(tmp_path: Path) -> None:
    catalogue = "PluginFurnitureCatalog.properties"
    write(
        tmp_path / "a",
        {catalogue: sh3f_catalogue([sh3f_entry("chair")]), "test/chair/chair.obj": cube_obj()},
    )
    assert found(find_models(tmp_path / "a")) == [("sweethome3d", "a/chair")]
    items = find_models(write(tmp_path / "b", {catalogue: "id=x\n", "x.obj": cube_obj()}))
    assert "lists nothing" in refusals(items)[f"b/{catalogue}"]


@pytest.mark.data
def test_documents_and_loose_meshes_are_told_from_what_they_use(shared_data: Path) -> None:
    items = find_models(shared_data / "cad")
    kinds = [item.kind for item in items]
    assert (kinds.count("urdf"), kinds.count("mjcf"), kinds.count("mesh")) == (16, 16, 5)
    assert "refused" not in kinds
    assert refusals([item for item in items if item.kind == "mesh"]) == {}


@pytest.mark.data
def test_furniture_sim_under_another_name_says_what_is_wrong(
    shared_data: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "renamed"
    folder.symlink_to(shared_data / "cad" / "furniture_sim", target_is_directory=True)
    files = FolderFiles(folder, ReadLimits())
    assert files.label == "furniture_sim"
    text = (folder / "bin.xml").read_text()
    items = find_models(write(tmp_path / "moved", {"bin.xml": text}))
    (reason,) = refusals(items).values()
    assert "leads out" in reason


def test_names_of_other_archives_are_not_mixed_up(tmp_path: Path) -> None:
    for name in "ab":
        write_zip(tmp_path / f"{name}.zip", {"x.obj": cube_obj()})
    assert [s for _, s in found(find_models(tmp_path))] == ["a.zip/x.obj", "b.zip/x.obj"]
    assert ZipFiles(tmp_path / "a.zip", "a.zip", ReadLimits()).beside("") == ("x.obj",)
