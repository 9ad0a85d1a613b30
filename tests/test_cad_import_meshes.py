"""Foreign mesh files: true shapes, colours and textures; each bad one refused with its reason."""

from __future__ import annotations

import io
import struct
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from isr_jax.cad.importing.reading.files import FolderFiles
from isr_jax.cad.importing.reading.limits import ReadLimits
from isr_jax.cad.importing.reading.mesh_parts import Shape, moved
from isr_jax.cad.importing.reading.mesh_shapes import read_shape
from isr_jax.cad.importing.reading.polygons import triangulated
from isr_jax.cad.importing.reading.rigid import read_mesh_model
from isr_jax.cad.importing.reading.simplify import within_budget
from isr_jax.cad.importing.reading.textures import texture_of
from isr_jax.errors import LibraryError

from .foreign_models import BOMB, OUTSIDE, cube_obj, cube_stl, dae, glb, png, write

LIMITS = ReadLimits()


def read(folder: Path, name: str, limits: ReadLimits = LIMITS) -> Shape:
    return read_shape(FolderFiles(folder, limits), name, limits)


def volume(shape: Shape) -> float:
    """Enclosed volume: right only if every face looks outwards."""
    return sum(float(np.linalg.det(p.vertices[p.faces]).sum()) / 6 for p in shape.parts)


def area(polygon: np.ndarray) -> float:
    x, y = polygon.T
    return float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) / 2)


@settings(max_examples=40)
@given(
    st.lists(st.floats(0.2, 1.0), min_size=3, max_size=12),
    st.floats(0, 6),
    st.integers(0, 2**31),
)
def test_triangles_cover_any_star_polygon_once(radii, turn, seed) -> None:
    """Their signed areas add up to the polygon's, and none is turned over."""
    angles = turn + 2 * np.pi * np.arange(len(radii)) / len(radii)
    flat = np.array(radii)[:, None] * np.stack([np.cos(angles), np.sin(angles)], 1)
    R = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    points = np.concatenate([flat, np.zeros((len(flat), 1))], 1) @ R.T
    triangles, owner = triangulated(points, np.array([len(radii)]))
    assert len(triangles) == len(radii) - 2 and not owner.any()
    each = [area(flat[t]) for t in triangles]
    assert min(each) >= -1e-9
    np.testing.assert_allclose(sum(each), area(flat), atol=1e-9)


def test_polygons_of_different_sizes_stay_in_order() -> None:
    quad = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    points = np.concatenate([quad, quad[:3] + 2, quad + 4])
    _, owner = triangulated(points, np.array([4, 3, 4]))
    np.testing.assert_array_equal(owner, [0, 0, 1, 2, 2])


def test_obj_with_negative_indices_continued_lines_and_tabs(tmp_path: Path) -> None:
    text = "v 0 0 0\nv\t1 0 0\nv 1 1 \\\n0\nf -3 -2 -1\nv 0 1 0\nf 1/ 3/9 -1//\nl 1 2\n"
    (part,) = read(write(tmp_path, {"a.obj": text}), "a.obj").parts
    assert len(part.faces) == 2 and len(part.vertices) == 4 and part.uv is None
    np.testing.assert_allclose(volume_area(part), 1.0)


def volume_area(part) -> float:
    a, b, c = (part.vertices[part.faces[:, k]] for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def test_obj_materials_textures_and_their_coordinates(tmp_path: Path) -> None:
    mtl = "newmtl wood\nKd 0 0 0\nmap_Kd -s 2 2 1 -blendu on my wood.png\n"
    mtl += "newmtl glass\nKd 1 0 0\nd 0.25"
    glass = "usemtl glass\nf 1 2 3\n"
    body = cube_obj((1, 2, 3), head="mtllib a.mtl\nusemtl wood", uv=True) + glass
    folder = write(tmp_path, {"a.obj": body, "a.mtl": mtl, "my wood.png": png()})
    wood, pane = read(folder, "a.obj").parts
    assert wood.texture is not None and wood.texture.name == "my_wood.png"
    assert wood.texture.content == png()
    np.testing.assert_allclose(wood.rgba, (200 / 255, 40 / 255, 10 / 255, 1), atol=1e-3)
    assert wood.uv is not None and wood.uv.shape == (12, 3, 2)
    assert {tuple(row) for row in wood.uv.reshape(-1, 2)} == {(0, 0), (1, 0), (1, 1), (0, 1)}
    assert pane.rgba == (1.0, 0.0, 0.0, 0.25) and pane.texture is None


@pytest.mark.parametrize(
    ("files", "note"),
    [
        ({}, "materials a.mtl are missing"),
        ({"a.mtl": "newmtl wood\nmap_Kd gone.png"}, "texture gone.png is missing"),
        ({"a.mtl": "newmtl wood\nmap_Kd C:/Users/me/gone.png"}, "texture gone.png is missing"),
        ({"a.mtl": "newmtl other\nKd 1 1 1"}, "material wood is not in its file"),
        ({"a.mtl": "newmtl wood\nmap_Kd t.png", "t.png": b"\x89PNG broken"}, "cannot be decoded"),
        ({"a.mtl": "newmtl wood\nmap_Kd t.png", "t.png": png((9, 9))[:-30]}, "cannot be decoded"),
    ],
)
def test_missing_textures_are_noted_and_the_colour_stays(tmp_path, files, note) -> None:
    obj = cube_obj(head="mtllib a.mtl\nusemtl wood", uv=True)
    shape = read(write(tmp_path, {"a.obj": obj} | files), "a.obj")
    assert any(note in n for n in shape.notes), shape.notes
    assert shape.parts[0].texture is None and volume(shape) == pytest.approx(1)


def test_large_textures_become_smaller_and_odd_ones_png() -> None:
    found = texture_of(png((3000, 30)), "a/Big one.png", LIMITS)
    assert found.note is not None and found.texture.name == "Big_one.png"
    assert Image.open(io.BytesIO(found.texture.content)).size == (1024, 10)
    buffer = io.BytesIO()
    Image.new("P", (4, 4), 0).save(buffer, "GIF")
    found = texture_of(buffer.getvalue(), "a.gif", LIMITS)
    assert found.texture.name == "a.png" and found.texture.content.startswith(b"\x89PNG")
    with pytest.raises(LibraryError, match="3000 x 30 pixels"):
        texture_of(png((3000, 30)), "a.png", ReadLimits(max_image_px=80_000.0))


def test_equal_vertices_are_one_and_faces_without_area_go(tmp_path: Path) -> None:
    loose = "".join(f"v {x} {y} 0\n" for x, y in ((0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)))
    text = loose + "v 9 9 9\nf 1 2 3\nf 4 5 6\nf 1 4 2\nf 1 2 2\n"
    (part,) = read(write(tmp_path, {"a.obj": text}), "a.obj").parts
    assert len(part.vertices) == 4 and len(part.faces) == 2


def test_a_mirroring_move_keeps_faces_outwards(tmp_path: Path) -> None:
    shape = read(write(tmp_path, {"a.obj": cube_obj((1, 2, 3))}), "a.obj")
    assert volume(moved(shape, np.diag([-1.0, 2.0, 1.0, 1.0]))) == pytest.approx(12)


@pytest.mark.parametrize("kind", ["stl", "ply", "glb", "obj"])
def test_formats_agree_with_trimesh(tmp_path: Path, kind: str) -> None:
    mesh = trimesh.creation.annulus(r_min=0.3, r_max=0.5, height=0.7)
    mesh.apply_translation([0.1, 0.2, 0.3])
    mesh.export(tmp_path / f"a.{kind}")
    shape = read(tmp_path, f"a.{kind}")
    assert shape.face_count == len(mesh.faces)
    assert volume(shape) == pytest.approx(mesh.volume, rel=1e-4)
    low = np.min([p.vertices.min(0) for p in shape.parts], 0)
    np.testing.assert_allclose(low, mesh.bounds[0], atol=1e-6)
    (part,) = shape.parts
    assert len(part.vertices) == len(mesh.vertices)


def test_what_formats_state(tmp_path: Path) -> None:
    write(tmp_path, {"a.glb": glb(), "a.dae": dae("Ada"), "a.stl": cube_stl(), "a.obj": cube_obj()})
    shape = read(tmp_path, "a.glb")
    assert shape.unit_m == 1 and shape.up is not None and shape.front is not None
    np.testing.assert_array_equal([shape.up, shape.front], [[0, 1, 0], [0, 0, 1]])
    assert shape.parts[0].rgba == (1, 0, 0, 1)
    np.testing.assert_allclose(shape.parts[0].vertices.min(0), [0, 2, 0])
    shape = read(tmp_path, "a.dae")
    assert shape.unit_m == 0.01 and shape.creator == "Ada" and shape.up is not None
    np.testing.assert_array_equal(shape.up, [0, 0, 1])
    for name in ("a.stl", "a.obj"):
        shape = read(tmp_path, name)
        assert shape.unit_m is None and shape.up is None and shape.front is None


def test_colours_of_vertices_stay(tmp_path: Path) -> None:
    mesh = trimesh.creation.box()
    mesh.visual.vertex_colors = [250, 0, 0, 255]
    mesh.export(tmp_path / "a.ply")
    (part,) = read(tmp_path, "a.ply").parts
    assert part.colors is not None and np.all(part.colors == [250, 0, 0])
    np.testing.assert_allclose(part.rgba, (250 / 255, 0, 0, 1), atol=1e-3)


def many_triangles_stl(count: int) -> bytes:
    return bytes(80) + struct.pack("<I", count)


PLY = "ply\nformat ascii 1.0\nelement vertex 3\n"
PLY += "property float x\nproperty float y\nproperty float z\n"
PLY += "element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
BAD = {
    "empty.obj": (b"  \n", "is empty"),
    "points.obj": (b"v 0 0 0\nv 1 0 0\n", "holds no faces"),
    "lines.obj": (b"v 0 0 0\nv 1 0 0\nl 1 2\n", "holds no faces"),
    "flat.obj": (b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "holds no faces"),
    "nan.obj": (cube_obj().replace("v 1 1 1", "v 1 nan 1").encode(), "1 vertices are not finite"),
    "inf.obj": (cube_obj().replace("v 1 1 1", "v 1 inf 1").encode(), "not finite"),
    "range.obj": (cube_obj().encode() + b"f 1 2 99\n", "not among its 8"),
    "zero.obj": (cube_obj().encode() + b"f 0 1 2\n", "not among its 8"),
    "words.obj": (b"v a b c\nf 1 1 1\n", "a line is no OBJ"),
    "short.obj": (b"v 0 0\nv 1 1\nv 2 2\nf 1 2 3\n", "a line is no OBJ"),
    "image.obj": (png(), "is PNG, not OBJ"),
    "scene.stl": (glb(), "is GLB, not STL"),
    "mesh.glb": (cube_stl(), "no GLB header"),
    "xml.obj": (dae().encode(), "is XML, not OBJ"),
    "cut.stl": (cube_stl()[:-20], "is cut off: 664 of 684 bytes"),
    "tiny.stl": (b"solid", "is cut off: 5 of 84 bytes"),
    "many.stl": (many_triangles_stl(50_000_000), "has 50000000 triangles, above 2000000"),
    "ascii.stl": (b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "no endsolid"),
    "cut.glb": (glb()[:-50], "is cut off"),
    "many.glb": (glb(50_000_000), "has 50000000 triangles"),
    "wrong.glb": (glb(40), "cannot be read as GLB"),
    "cut.ply": ((PLY.format(faces=2) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").encode(), "PLY|cut off"),
    "many.ply": (PLY.format(faces=50_000_000).encode(), "has 50000000 triangles"),
    "head.ply": (b"ply\nformat ascii 1.0\n", "no PLY header"),
    "range.ply": ((PLY.format(faces=1) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n").encode(), "PLY|among"),
    "bomb.dae": (dae(doctype=BOMB).encode(), "document type or entities"),
    "outside.dae": (dae("&a;", OUTSIDE).encode(), "document type or entities"),
    "cut.dae": (dae().encode()[:-200], "no valid XML"),
    "text.dae": (b"hello", "is no XML, not DAE"),
    "no.gltf": (b"{}", "holds no faces"),
    "list.gltf": (b"[]", "no object"),
    "buffer.gltf": (
        b'{"asset":{"version":"2.0"},"buffers":[{"byteLength":4,"uri":"../../x.bin"}],"bufferViews":'
        b'[{"buffer":0,"byteLength":4}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,'
        b'"type":"VEC3"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],'
        b'"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}',
        "leads out",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_meshes_are_refused_with_their_reason(tmp_path: Path, name: str) -> None:
    content, reason = BAD[name]
    with pytest.raises(LibraryError, match=reason) as caught:
        read(write(tmp_path, {name: content}), name)
    assert name in caught.value.problem or "leads out" in reason
    assert caught.value.hint


def test_textures_outside_the_folder_are_refused(tmp_path: Path) -> None:
    obj = cube_obj(head="mtllib a.mtl\nusemtl a", uv=True)
    mtl = "newmtl a\nmap_Kd ../../etc/passwd"
    with pytest.raises(LibraryError, match="leads out of the given folder"):
        read(write(tmp_path, {"a.obj": obj, "a.mtl": mtl}), "a.obj")
    with pytest.raises(LibraryError, match="leads out of the given folder"):
        read(write(tmp_path, {"b.obj": cube_obj(head="mtllib ../b.mtl")}), "b.obj")


def test_materials_in_latin_1_are_read(tmp_path: Path) -> None:
    obj = cube_obj(head="mtllib mañana.mtl\nusemtl tapicería").encode("latin-1")
    mtl = "newmtl tapicería\nKd 0 0.5 1".encode("latin-1")
    (part,) = read(write(tmp_path, {"a.obj": obj, "mañana.mtl": mtl}), "a.obj").parts
    assert part.rgba == (0, 0.5, 1, 1)


def test_invisible_parts_are_left_out_unless_all_are(tmp_path: Path) -> None:
    mtl = "newmtl none\nd 0\nnewmtl some\nd 1"
    both = cube_obj(head="mtllib a.mtl\nusemtl none") + "usemtl some\nf 1 2 3\n"
    write(
        tmp_path, {"a.mtl": mtl, "a.obj": both, "b.obj": cube_obj(head="mtllib a.mtl\nusemtl none")}
    )
    shape = read(tmp_path, "a.obj")
    assert [p.name for p in shape.parts] == ["some"] and "1 invisible" in shape.notes[0]
    shape = read(tmp_path, "b.obj")
    assert shape.parts[0].rgba[3] == 1 and "shown opaque" in shape.notes[0]


def test_heavy_models_are_simplified_and_it_is_said(tmp_path: Path) -> None:
    trimesh.creation.icosphere(subdivisions=5).export(tmp_path / "ball.stl")
    limits = ReadLimits(simplify_faces=5000)
    found = read_mesh_model(FolderFiles(tmp_path, limits), "ball.stl", limits)
    robot, notes = within_budget(found.robot, limits)
    mesh = robot.links[0].visuals[0].mesh
    assert 4000 < len(mesh.faces) <= 5000 and "simplified from 20480 to" in notes[0]
    radius = np.linalg.norm(mesh.vertices, axis=1)
    assert abs(radius - 1).max() < 0.01
    with pytest.raises(LibraryError, match="20480 triangles, above 20000"):
        within_budget(found.robot, ReadLimits(max_faces=20_000))
    assert within_budget(found.robot, LIMITS) == (found.robot, ())
