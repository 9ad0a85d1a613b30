"""Writes small scans in the exact formats of SceneNN and ScanNet."""

from __future__ import annotations

import dataclasses
import json
import struct
import zlib
from pathlib import Path

import cv2
import numpy as np

SCENENN_WORLD = np.array([[1.0, 0, 0, 0.4], [0, 0, 1, 0.2], [0, -1, 0, -0.3], [0, 0, 0, 1]])
"""T_dataset_world of a scene whose frame is y up: world z is its y."""
SCANNET_WORLD = np.array([[0.6, -0.8, 0, 2.0], [0.8, 0.6, 0, 1.0], [0, 0, 1, 0.1], [0, 0, 0, 1]])
"""T_dataset_world of a scan whose frame is z up."""
COLOR_CODES = {"raw": 0, "png": 1, "jpeg": 2}
DEPTH_CODES = {"raw_ushort": 0, "zlib_ushort": 1, "occi_ushort": 2}


@dataclasses.dataclass(frozen=True)
class ScanFrame:
    """One frame as a camera stores it."""

    color: np.ndarray
    """[height, width, 3] RGB; may be of another size than depth."""
    depth: np.ndarray
    """[height, width] uint16, millimetres."""
    pose: np.ndarray
    """[4, 4] camera to dataset."""


def scan_frames(frames, T_dataset_world: np.ndarray) -> list[ScanFrame]:
    """Frames of a sequence (or of `datasets_room.shots`) as a scan in another frame has them."""
    return [
        ScanFrame(
            f.color,
            np.round(np.asarray(f.depth_m) * 1000).astype(np.uint16),
            T_dataset_world @ f.T_world_camera,
        )
        for f in frames
    ]


def matrix(fx: float, fy: float, cx: float, cy: float) -> np.ndarray:
    """A 4x4 matrix of intrinsics."""
    K = np.eye(4)
    K[0, 0], K[1, 1], K[0, 2], K[1, 2] = fx, fy, cx, cy
    return K


# SceneNN


def write_scenenn(
    path: Path, frames: list[ScanFrame], K: np.ndarray | None = None, *, ending: str = "png"
) -> Path:
    """What the playback tool extracts, with ``trajectory.log``; ``asus.ini`` where K is given."""
    for folder in ("image", "depth"):
        (path / folder).mkdir(parents=True)
    log, times = [], []
    for i, frame in enumerate(frames):
        write_image(path / f"image/image{i + 1:05d}.{ending}", frame.color)
        cv2.imwrite(str(path / f"depth/depth{i + 1:05d}.png"), frame.depth)
        rows = [" ".join(f"{v:.9g}" for v in row) for row in frame.pose]
        log += [f"{i} {i} {i + 1}", *rows]
        times.append(f"{i + 1} {33000 * i} {33000 * i + 400}")
    (path / "trajectory.log").write_text("\n".join(log) + "\n")
    (path / "timestamp.txt").write_text("\n".join(times) + "\n")
    if K is not None:
        height, width = frames[0].depth.shape
        (path / "intrinsic").mkdir()
        (path / "intrinsic/asus.ini").write_text(
            f"depth_width {width}\ndepth_height {height}\nfx {K[0, 0]}\nfy {K[1, 1]}\n"
        )
    return path


def write_image(path: Path, color: np.ndarray) -> None:
    cv2.imwrite(str(path), np.ascontiguousarray(color[..., ::-1]))


@dataclasses.dataclass(frozen=True)
class ScanLabel:
    """One annotated object."""

    id: int
    text: str
    nyu_class: str | None = None
    obbox: tuple[float, ...] | None = None
    """Centre, size, quaternion x y z w, dataset frame."""


def write_scenenn_truth(
    path: Path, vertices: np.ndarray, faces: np.ndarray, label: np.ndarray, labels: list[ScanLabel]
) -> Path:
    """``<folder>.ply`` with a label a vertex, and ``<folder>.xml``."""
    path.mkdir(parents=True, exist_ok=True)
    table = vertex_table(vertices, label=np.asarray(label, np.uint16))
    write_ply(path / f"{path.name}.ply", table, faces)
    lines = ['<?xml version="1.0" encoding="utf-8"?>', "<annotation>"]
    for item in labels:
        fields = {"id": str(item.id), "color": f"{item.id} 40 200", "text": item.text}
        if item.nyu_class is not None:
            fields["nyu_class"] = item.nyu_class
        if item.obbox is not None:
            fields["obbox"] = " ".join(f"{v:.9g}" for v in item.obbox)
        lines.append("  <label " + " ".join(f'{k}="{v}"' for k, v in fields.items()) + "/>")
    (path / f"{path.name}.xml").write_text("\n".join([*lines, "</annotation>"]) + "\n")
    return path


# ScanNet


def sens_bytes(
    frames: list[ScanFrame],
    K_color: np.ndarray,
    K_depth: np.ndarray,
    *,
    color: str = "jpeg",
    depth: str = "zlib_ushort",
    version: int = 4,
    units: float = 1000.0,
    declared: int | None = None,
    sensor: bytes = b"StructureSensor",
    sizes: tuple[int, int, int, int] | None = None,
) -> tuple[bytes, list[int]]:
    """A ``.sens`` file, and where its frames begin (and the last ends)."""
    h, w = frames[0].depth.shape
    color_h, color_w = frames[0].color.shape[:2]
    out = struct.pack("<I", version) + struct.pack("<Q", len(sensor)) + sensor
    for M in (K_color, np.eye(4), K_depth, np.eye(4)):
        out += np.asarray(M, "<f4").tobytes()
    out += struct.pack("<ii", COLOR_CODES[color], DEPTH_CODES[depth])
    out += struct.pack("<IIII", *(sizes or (color_w, color_h, w, h)))
    out += struct.pack("<fQ", units, len(frames) if declared is None else declared)
    starts = [len(out)]
    for i, frame in enumerate(frames):
        images = _color_bytes(frame.color, color), _depth_bytes(frame.depth, depth)
        out += np.asarray(frame.pose, "<f4").tobytes()
        out += struct.pack("<QQQQ", 33333 * i, 33333 * i + 7, *(len(b) for b in images))
        out += b"".join(images)
        starts.append(len(out))
    imu = struct.pack("<Q", 1) + np.zeros(15, "<f8").tobytes() + struct.pack("<Q", 0)
    return out + imu, starts


def _color_bytes(color: np.ndarray, coding: str) -> bytes:
    if coding == "raw":
        return color.tobytes()
    ending = {"jpeg": ".jpg", "png": ".png"}[coding]
    return cv2.imencode(ending, np.ascontiguousarray(color[..., ::-1]))[1].tobytes()


def _depth_bytes(depth: np.ndarray, coding: str) -> bytes:
    data = depth.astype("<u2").tobytes()
    return zlib.compress(data) if coding == "zlib_ushort" else data


def write_sens(path: Path, frames: list[ScanFrame], K_color, K_depth, **changes) -> Path:
    """A scan's folder with its ``<folder>.sens``."""
    path.mkdir(parents=True, exist_ok=True)
    data, _ = sens_bytes(frames, K_color, K_depth, **changes)
    (path / f"{path.name}.sens").write_bytes(data)
    return path


def write_scannet_folders(path: Path, frames: list[ScanFrame], K_color, K_depth) -> Path:
    """What SensReader exports: numbers without leading zeros."""
    for folder in ("color", "depth", "pose", "intrinsic"):
        (path / folder).mkdir(parents=True)
    for i, frame in enumerate(frames):
        write_image(path / f"color/{i}.jpg", frame.color)
        cv2.imwrite(str(path / f"depth/{i}.png"), frame.depth)
        np.savetxt(path / f"pose/{i}.txt", frame.pose, fmt="%f")
    for name, K in (("color", K_color), ("depth", K_depth)):
        np.savetxt(path / f"intrinsic/intrinsic_{name}.txt", K, fmt="%f")
        np.savetxt(path / f"intrinsic/extrinsic_{name}.txt", np.eye(4), fmt="%f")
    return path


def write_scannet_truth(
    path: Path,
    vertices: np.ndarray,
    faces: np.ndarray,
    segment: np.ndarray,
    groups: list[tuple[int, str, list[int]]],
    *,
    axis_alignment: np.ndarray | None = None,
    nyu40: dict[str, int] | None = None,
) -> Path:
    """Mesh, segs.json, aggregation.json and, where given, the scan's txt and the label table.

    Args:
        groups: (objectId, label, segments) of every object.
        nyu40: NYU40 id of each label, for ``scannetv2-labels.combined.tsv`` beside the scan.
    """
    path.mkdir(parents=True, exist_ok=True)
    scan = path.name
    colors = {
        c: np.full(len(vertices), v, np.uint8)
        for c, v in zip(("red", "green", "blue", "alpha"), (90, 100, 110, 255), strict=True)
    }
    write_ply(path / f"{scan}_vh_clean_2.ply", vertex_table(vertices, **colors), faces)
    segments = {
        "params": {"kThresh": "0.01", "segMinVerts": "20"},
        "sceneId": f"scannet.{scan}",
        "segIndices": [int(v) for v in segment],
    }
    aggregation = {
        "sceneId": f"scannet.{scan}",
        "appId": "Aggregator.v2",
        "segGroups": [
            {"id": id, "objectId": id, "segments": segments_of, "label": label}
            for id, label, segments_of in groups
        ],
        "segmentsFile": f"scannet.{scan}_vh_clean_2.0.010000.segs.json",
    }
    (path / f"{scan}_vh_clean_2.0.010000.segs.json").write_text(json.dumps(segments))
    (path / f"{scan}.aggregation.json").write_text(json.dumps(aggregation))
    if axis_alignment is not None:
        row = " ".join(f"{v:f}" for v in np.ravel(axis_alignment))
        (path / f"{scan}.txt").write_text(f"axisAlignment = {row} \ncolorHeight = 968\n")
    if nyu40 is not None:
        lines = ["id\traw_category\tcategory\tcount\tnyu40id\teigen13id\tnyuClass\tnyu40class"]
        lines += [
            f"{i}\t{k}\t{k}\t1\t{v}\t0\t{k}\t{k}" for i, (k, v) in enumerate(nyu40.items(), 1)
        ]
        (path.parent / "scannetv2-labels.combined.tsv").write_text("\n".join(lines) + "\n")
    return path


# PLY


def vertex_table(vertices: np.ndarray, **columns: np.ndarray) -> np.ndarray:
    """Positions as float32 and more columns, packed."""
    kinds = [(c, "f4") for c in "xyz"] + [(k, v.dtype) for k, v in columns.items()]
    table = np.zeros(len(vertices), kinds)
    for axis, name in enumerate("xyz"):
        table[name] = np.asarray(vertices)[:, axis]
    for name, values in columns.items():
        table[name] = values
    return table


_NAMES = {"f4": "float", "f8": "double", "u1": "uchar", "u2": "ushort", "i4": "int", "i2": "short"}


def ply_bytes(table: np.ndarray, faces, *, format: str = "binary_little_endian") -> bytes:
    """A PLY file; ``faces`` may have any number of corners."""
    names = table.dtype.names or ()
    lines = ["ply", f"format {format} 1.0", "comment a scan", f"element vertex {len(table)}"]
    lines += [f"property {_NAMES[table.dtype[n].str[1:]]} {n}" for n in names]
    lines += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    head = ("\n".join(lines) + "\n").encode()
    if format == "ascii":
        rows = [" ".join(repr(v.item()) for v in row) for row in table]
        rows += [" ".join(str(int(v)) for v in (len(f), *f)) for f in faces]
        return head + ("\n".join(rows) + "\n").encode()
    order = "<" if format == "binary_little_endian" else ">"
    packed = table.astype(table.dtype.newbyteorder(order)).tobytes()
    items = [bytes([len(f)]) + np.asarray(f, order + "i4").tobytes() for f in faces]
    return head + packed + b"".join(items)


def write_ply(path: Path, table: np.ndarray, faces, **changes) -> Path:
    path.write_bytes(ply_bytes(table, faces, **changes))
    return path


def merged(parts: list[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(vertices, faces) of several meshes as one, and the part of each vertex, counted from 1."""
    starts = np.cumsum([0, *(len(v) for v, _ in parts)])
    vertices = np.concatenate([v for v, _ in parts])
    faces = np.concatenate([f + s for (_, f), s in zip(parts, starts[:-1], strict=True)])
    part = np.repeat(np.arange(1, len(parts) + 1), np.diff(starts))
    return vertices, faces, part
