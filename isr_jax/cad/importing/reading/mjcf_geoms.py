"""Border: geoms of a compiled MuJoCo model as meshes, with the colours that MuJoCo draws."""

# MuJoCo's compiled names have no stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import dataclasses

import mujoco
import numpy as np

from ....types import Mesh
from .convex_shapes import ball, box, capsule, cylinder
from .mesh_parts import MeshPart, cleaned
from .mjcf_text import MjcfText, MjcfTexture
from .textures import Images

_HIDDEN_GROUP = 3  # MuJoCo's viewer shows groups 0, 1 and 2
_DEFAULT_RGBA = np.array([0.5, 0.5, 0.5, 1.0], np.float32)
_KIND = mujoco.mjtGeom


@dataclasses.dataclass(frozen=True, eq=False)
class Geom:
    """One geom as a mesh in its link's frame."""

    row: int
    mesh: Mesh
    seen: bool
    """MuJoCo's viewer shows it."""
    collides: bool


class Geoms:
    """The geoms of one model."""

    def __init__(
        self, model: mujoco.MjModel, text: MjcfText, images: Images, notes: list[str]
    ) -> None:
        self._model, self._text, self._images, self._notes = model, text, images, notes

    def of_body(self, body: int, offset: np.ndarray) -> list[Geom]:
        """All but planes, which are noted.

        Args:
            body: Its id.
            offset: Origin of its link in its own frame.
        """
        model, start = self._model, int(self._model.body_geomadr[body])
        rows = range(start, start + int(model.body_geomnum[body])) if start >= 0 else range(0)
        meshes = [(row, self._mesh(row, offset)) for row in rows]
        return [
            Geom(row, mesh, self._is_seen(row), self._collides(row))
            for row, mesh in meshes
            if mesh is not None
        ]

    def parts(self, geom: Geom) -> list[MeshPart]:
        """Its surface with colour or texture; none where it has no area."""
        model, row, texture = self._model, geom.row, None
        rgb, alpha = self._rgba(row)[:3].astype(np.float64), float(self._rgba(row)[3])
        uv, found = None, self._texture(row)
        if found is not None:
            image = None if found.file is None else self._images.find("", found.file)
            rgb = rgb * (found.rgb if image is None else image.mean_rgb)
            if image is not None and geom.mesh.uv is not None:
                texture = image.texture
                uv = geom.mesh.uv * model.mat_texrepeat[model.geom_matid[row]]
        red, green, blue = (float(v) for v in np.round(rgb, 4))
        part = MeshPart(
            name=model.geom(row).name or self._mesh_name(row) or f"geom_{row}",
            vertices=geom.mesh.vertices,
            faces=geom.mesh.faces,
            uv=uv,
            rgba=(red, green, blue, round(alpha, 4) or 1.0),
            texture=texture,
        )
        clean = cleaned(part, part.name)
        return [clean] if len(clean.faces) else []

    def _collides(self, row: int) -> bool:
        return bool(self._model.geom_contype[row] or self._model.geom_conaffinity[row])

    def _is_seen(self, row: int) -> bool:
        return bool(self._model.geom_group[row] < _HIDDEN_GROUP and self._rgba(row)[3] > 0)

    def _mesh(self, row: int, offset: np.ndarray) -> Mesh | None:
        model = self._model
        shape = _shape(model, row)
        if shape is None:
            is_plane = int(model.geom_type[row]) == _KIND.mjGEOM_PLANE
            self._notes.append("ground planes left out" if is_plane else "odd geoms left out")
            return None
        T = pose_of(model.geom_pos[row] - offset, model.geom_quat[row])
        vertices = shape.vertices.astype(np.float64) @ T[:3, :3].T + T[:3, 3]
        return Mesh(vertices, shape.faces, uv=shape.uv)

    def _mesh_name(self, row: int) -> str:
        model = self._model
        if int(model.geom_type[row]) != _KIND.mjGEOM_MESH:
            return ""
        return model.mesh(int(model.geom_dataid[row])).name

    def _rgba(self, row: int) -> np.ndarray:
        """As MuJoCo draws it: the material's colour, unless the geom has its own."""
        model, material = self._model, int(self._model.geom_matid[row])
        own = np.array(model.geom_rgba[row])
        is_default = np.array_equal(own, _DEFAULT_RGBA)
        return np.array(model.mat_rgba[material]) if material >= 0 and is_default else own

    def _texture(self, row: int) -> MjcfTexture | None:
        model, material = self._model, int(self._model.geom_matid[row])
        if material < 0:
            return None
        ids = [int(i) for i in np.ravel(model.mat_texid[material]) if i >= 0]
        return self._text.textures.get(model.texture(ids[0]).name) if ids else None


def _shape(model: mujoco.MjModel, row: int) -> Mesh | None:
    """A geom's mesh in its own frame; None for what has none."""
    kind, size = int(model.geom_type[row]), np.array(model.geom_size[row], np.float64)
    if kind == _KIND.mjGEOM_MESH:
        return _stored_mesh(model, int(model.geom_dataid[row]))
    if kind == _KIND.mjGEOM_BOX:
        return box(2 * size)
    if kind == _KIND.mjGEOM_SPHERE:
        return ball(np.full(3, size[0]))
    if kind == _KIND.mjGEOM_ELLIPSOID:
        return ball(size)
    if kind == _KIND.mjGEOM_CYLINDER:
        return cylinder(float(size[0]), float(2 * size[1]))
    if kind == _KIND.mjGEOM_CAPSULE:
        return capsule(float(size[0]), float(2 * size[1]))
    return None


def _stored_mesh(model: mujoco.MjModel, mesh: int) -> Mesh:
    """Vertices, faces and texture coordinates of a compiled mesh, in its own moved frame."""
    first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
    start, faces = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
    rows = slice(start, start + faces)
    uv, at = None, int(model.mesh_texcoordadr[mesh])
    if at >= 0:
        corners = np.asarray(model.mesh_facetexcoord[rows])
        uv = np.asarray(model.mesh_texcoord, np.float32).reshape(-1, 2)[at + corners]
        uv = np.stack([uv[..., 0], 1.0 - uv[..., 1]], -1)  # MuJoCo counts v from the top
    vertices = np.array(model.mesh_vert[first : first + count], np.float64)
    return Mesh(vertices, np.array(model.mesh_face[rows], np.int32), uv=uv)


def pose_of(position: np.ndarray, quaternion: np.ndarray) -> np.ndarray:
    """[4, 4] of a position and a quaternion (w x y z)."""
    T, R = np.eye(4), np.zeros(9)
    mujoco.mju_quat2Mat(R, np.asarray(quaternion, np.float64))
    T[:3, :3], T[:3, 3] = R.reshape(3, 3), position
    return T
