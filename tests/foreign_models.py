"""Small files of foreign formats, written by the tests that read them."""

from __future__ import annotations

import io
import json
import struct
import zipfile
from pathlib import Path

import numpy as np
from PIL import Image

CUBE_CORNERS = np.array(
    [[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float
)
CUBE_QUADS = ((4, 3, 2, 1), (5, 6, 7, 8), (1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8))
"""Corners counted from 1, seen from outside counter-clockwise."""


def cube_obj(size=(1.0, 1.0, 1.0), *, head: str = "", uv: bool = False, low=(0, 0, 0)) -> str:
    """A box of six quads."""
    corners = CUBE_CORNERS * np.asarray(size) + np.asarray(low)
    lines = [head] if head else []
    lines += [f"v {x:g} {y:g} {z:g}" for x, y, z in corners]
    if uv:
        lines += ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1"]
        lines += ["f " + " ".join(f"{c}/{k + 1}" for k, c in enumerate(q)) for q in CUBE_QUADS]
    else:
        lines += ["f " + " ".join(map(str, quad)) for quad in CUBE_QUADS]
    return "\n".join(lines) + "\n"


def cube_stl(size: float = 1.0) -> bytes:
    """A binary STL of a cube."""
    triangles = [(q[0], q[i], q[i + 1]) for q in CUBE_QUADS for i in (1, 2)]
    corners = np.array([[CUBE_CORNERS[c - 1] * size for c in t] for t in triangles], "<f4")
    rows = b"".join(bytes(12) + row.tobytes() + bytes(2) for row in corners)
    return bytes(80) + struct.pack("<I", len(triangles)) + rows


def png(size=(4, 4), color=(200, 40, 10)) -> bytes:
    """An image of one colour."""
    buffer = io.BytesIO()
    Image.new("RGB", size, color).save(buffer, "PNG")
    return buffer.getvalue()


def write(folder: Path, files: dict[str, str | bytes]) -> Path:
    """Write files below a folder; returns it."""
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content.encode() if isinstance(content, str) else content)
    return folder


def write_zip(path: Path, files: dict[str, str | bytes], **how) -> Path:
    """Write an archive; names are used as they are."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content, **how)
    return path


URDF = """<robot name="cupboard">
 <material name="wood"><color rgba="0.6 0.4 0.2 1"/></material>
 <link name="carcass">
  <visual name="side"><origin xyz="0 0 0.5"/><geometry><box size="0.6 0.5 1"/></geometry>
   <material name="wood"/></visual>
  <collision><origin xyz="0 0 0.5"/><geometry><box size="0.6 0.5 1"/></geometry></collision>
  <inertial><origin xyz="0 0 0.5"/><mass value="20"/>
   <inertia ixx="2" iyy="2" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
 </link>
 <link name="door">
  <visual name="panel"><origin xyz="0.3 0 0.5" rpy="0 0 0"/>
   <geometry><mesh filename="{mesh}" scale="0.6 0.02 1"/></geometry></visual>
 </link>
 <joint name="door_hinge" type="revolute">
  <parent link="carcass"/><child link="door"/><origin xyz="-0.3 -0.27 0"/><axis xyz="0 0 2"/>
  {limit}<dynamics damping="0.3" friction="0.2"/>
 </joint>
</robot>
"""
LIMIT = '<limit lower="-1.5" upper="0" effort="1" velocity="1"/>'


def urdf(mesh: str = "meshes/door.obj", limit: str = LIMIT) -> str:
    """A carcass of one box, with a mesh for a door."""
    return URDF.format(mesh=mesh, limit=limit)


MJCF = """<mujoco model="drawer">
 <compiler angle="degree" meshdir="meshes"/>
 <asset><mesh name="front" file="front.stl" scale="0.4 0.02 0.2"/>
  <material name="wood" rgba="0.5 0.3 0.1 1"/></asset>
 <worldbody>
  <light pos="0 0 3"/><geom type="plane" size="5 5 0.1"/>
  <body name="box" pos="0 0 0.2">
   <geom name="shell" type="box" size="0.3 0.3 0.2" material="wood" mass="8"/>
   <body name="drawer" pos="0 -0.35 0">
    <joint name="pull" type="slide" axis="0 -1 0" range="0 0.3" damping="2" frictionloss="1"/>
    <geom name="face" type="mesh" mesh="front" mass="1"/>
    <body name="knob" pos="0 -0.05 0">
     <joint name="turn" type="hinge" axis="0 1 0" pos="0 0 0.01" range="-90 90"/>
     <geom type="sphere" size="0.02" mass="0.1"/>
    </body>
   </body>
  </body>
 </worldbody>
</mujoco>
"""


def sh3f_catalogue(entries: list[dict[str, str]], wide: str = "license=CC0\n") -> str:
    """Text of a Sweet Home 3D catalogue."""
    lines = [f"{k}#{i}={v}" for i, entry in enumerate(entries, 1) for k, v in entry.items()]
    return "id=Test#Catalogue\nname=Test\n" + wide + "\n".join(lines) + "\n"


def sh3f_entry(stem: str, **more: str) -> dict[str, str]:
    """A chair of 50 x 60 x 90 cm."""
    return {
        "id": f"Test#{stem}",
        "name": "Chair",
        "tags": "Seat, Wood",
        "category": "Office",
        "icon": f"/test/{stem}.png",
        "model": f"/test/{stem}/{stem}.obj",
        "width": "50",
        "depth": "60",
        "height": "90",
        "movable": "true",
        "doorOrWindow": "false",
        "creator": "Someone",
    } | more


def glb(triangles: int = 12) -> bytes:
    """A cube as GLB, its accessor claiming so many triangles."""
    faces = np.array([(q[0], q[i], q[i + 1]) for q in CUBE_QUADS for i in (1, 2)], "<u4") - 1
    data = CUBE_CORNERS.astype("<f4").tobytes() + faces.tobytes()
    tree = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "translation": [0, 2, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"name": "red", "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 1]}}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": 8,
                "type": "VEC3",
                "min": [0, 0, 0],
                "max": [1, 1, 1],
            },
            {"bufferView": 1, "componentType": 5125, "count": 3 * triangles, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 96},
            {"buffer": 0, "byteOffset": 96, "byteLength": 144},
        ],
        "buffers": [{"byteLength": len(data)}],
    }
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(data), 0x004E4942) + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


DAE = """<?xml version="1.0"?>{doctype}
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
 <asset><contributor><author>{author}</author></contributor>
  <unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
 <library_geometries><geometry id="g"><mesh>
  <source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array>
   <technique_common><accessor source="#pa" count="3" stride="3">
    <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
   </accessor></technique_common></source>
  <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
  <triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
 </mesh></geometry></library_geometries>
 <library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node>
 </visual_scene></library_visual_scenes>
 <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
"""


def dae(author: str = "Someone", doctype: str = "") -> str:
    """One triangle in centimetres, z up."""
    return DAE.format(author=author, doctype=doctype)


BOMB = '<!DOCTYPE x [<!ENTITY a "ha"><!ENTITY b "&a;&a;"><!ENTITY c "&b;&b;">]>'
"""A document type with entities that double; the bound is that there is one at all."""
OUTSIDE = '<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]>'
