"""The nouns that pass between stages.

Device-friendly types (`Box`, `PlaneSet`, `Camera`) are `eqx.Module`s, valid unbatched or with
leading axes. Host types hold NumPy arrays and are frozen dataclasses. Units are metres, radians
and seconds; the world is z up with the floor at z = 0; transforms `T_a_b` map b's points to a.
"""

from __future__ import annotations

import dataclasses
import enum
from collections.abc import Iterator
from pathlib import Path
from typing import Literal, Protocol, SupportsIndex, runtime_checkable

import equinox as eqx
import jax
import numpy as np
from jaxtyping import Bool, Float, Int, UInt8

Array = jax.Array | np.ndarray

ROOM = -1
"""Parent of layout entities: the root of the contact graph."""
UNSUPPORTED = -2
"""Parent of an entity that nothing carries (`parent: null` in scene.json)."""
Attachment = Literal["none", "wall", "hanging", "leaning"]
"""How an entity stays up that nothing carries; ``none`` also for what is carried."""


class Box(eqx.Module):
    """Gravity-aligned oriented box. Its own axes are the world's turned by ``yaw`` about z."""

    center: Float[Array, "*batch 3"]
    """Centre, world frame, metres."""
    yaw: Float[Array, "*batch"]
    """Turn about +z in [-pi/4, pi/4), radians."""
    size: Float[Array, "*batch 3"]
    """Full extent along the box's own x, y, z, metres; not sorted."""


class PlaneSet(eqx.Module):
    """Planes n . v + d = 0 with unit normals pointing out of the object, and their extents."""

    normal: Float[Array, "*batch planes 3"]
    offset: Float[Array, "*batch planes"]
    """d, metres."""
    corners: Float[Array, "*batch planes 4 3"]
    """Extent: a rectangle in the plane, counter-clockwise seen against the normal, metres."""
    area_m2: Float[Array, "*batch planes"]
    """Area of the observed (or modelled) surface, at most that of the rectangle."""
    valid: Bool[Array, "*batch planes"]
    """False for padding. Padding is finite: normal +z, everything else 0."""


class Camera(eqx.Module):
    """Pinhole camera, OpenCV axes: x right, y down, z forward."""

    fx: float
    fy: float
    cx: float
    cy: float
    width: int = eqx.field(static=True)
    height: int = eqx.field(static=True)

    @property
    def K(self) -> np.ndarray:
        """Intrinsic matrix [3, 3], pixels."""
        return np.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1]], np.float64)


@dataclasses.dataclass(frozen=True, eq=False)
class Frame:
    """One posed RGB-D image, already in the world frame."""

    index: int
    name: str
    color: UInt8[np.ndarray, "height width 3"]
    """RGB."""
    depth_m: Float[np.ndarray, "height width"]
    """Depth along the optical axis, metres; 0 = no return."""
    T_world_camera: Float[np.ndarray, "4 4"]
    camera: Camera


@runtime_checkable
class RgbdSequence(Protocol):
    """A posed RGB-D sequence: a length, and a frame for an index."""

    @property
    def name(self) -> str: ...

    @property
    def source(self) -> Path:
        """The folder it came from."""
        ...

    @property
    def camera(self) -> Camera: ...

    @property
    def T_world_dataset(self) -> np.ndarray:
        """[4, 4]: from the dataset's own frame to the world (z up, floor at 0)."""
        ...

    @property
    def notes(self) -> tuple[str, ...]:
        """What was assumed or changed while opening it, for the user."""
        ...

    def __len__(self) -> int: ...

    def __getitem__(self, index: int) -> Frame:
        """The frame; raises `errors.FrameError` when that one frame cannot be read."""
        ...

    def content_hash(self) -> str:
        """Hex digest of what the frames are made of; part of the key of stored results."""
        ...


@dataclasses.dataclass(frozen=True, eq=False)
class PanopticFrame:
    """What a segmenter says of one image. Row 0 of the tables stands for "nothing here"."""

    mask: Int[np.ndarray, "height width"]
    """Row of the tables per pixel; 0 = none."""
    class_id: Int[np.ndarray, " masks"]
    """Row of `classes.CLASSES`; 0 = none."""
    score: Float[np.ndarray, " masks"]


@dataclasses.dataclass(frozen=True, eq=False)
class FrameSegments:
    """Geometric segments of one frame with the class and instance that the masks gave them."""

    segment: Int[np.ndarray, "height width"]
    """Row of the tables per pixel; 0 = none."""
    class_id: Int[np.ndarray, " segments"]
    """Row of `classes.CLASSES`; 0 = background."""
    instance: Int[np.ndarray, " segments"]
    """Instance within this frame; 0 = none. Segments of one instance share it."""


@dataclasses.dataclass(frozen=True, eq=False)
class Mesh:
    """Triangle mesh, world or model frame (the holder says which), metres."""

    vertices: Float[np.ndarray, "vertices 3"]
    faces: Int[np.ndarray, "faces 3"]
    colors: UInt8[np.ndarray, "vertices 3"] | None = None
    """RGB per vertex."""
    normals: Float[np.ndarray, "vertices 3"] | None = None
    """Unit, pointing out of the surface."""
    uv: Float[np.ndarray, "faces 3 2"] | None = None
    """Texture coordinates per face corner, so that faces with seams between them share vertices."""


@dataclasses.dataclass(frozen=True, eq=False)
class PanopticSurface:
    """The surface of a panoptic map: one mesh, one instance per vertex, one class per instance."""

    mesh: Mesh
    instance: Int[np.ndarray, " vertices"]
    """Instance per vertex; 0 = none."""
    instance_ids: Int[np.ndarray, " instances"]
    """Every instance that occurs, ascending, without 0."""
    class_ids: Int[np.ndarray, " instances"]
    """Class of each of ``instance_ids``. All of one stuff class is one instance."""
    voxel_size_m: float


@dataclasses.dataclass(frozen=True, eq=False)
class MappingResult:
    """The map of a sequence: its surface, and which frames went in."""

    surface: PanopticSurface
    frames_used: int
    skipped: tuple[str, ...]
    """What was wrong with each frame that was left out."""


@dataclasses.dataclass(frozen=True, eq=False)
class Entity:
    """A thing or a piece of layout: a node of the contact graph."""

    id: int
    name: str
    """Unique, fit for MJCF and URDF: ``chair_3``."""
    class_name: str
    box: Box
    planes: PlaneSet
    mesh: Mesh
    """World frame."""
    is_layout: bool
    """Floor, wall or ceiling: planes[0] with its extent, normal into the room. A wall that is
    known to have openings has a plane for each rectangle between them, the largest first."""
    merged_ids: tuple[int, ...] = ()
    """Other instances of the map that turned out to be parts of this one."""


@dataclasses.dataclass(frozen=True, eq=False)
class Entities:
    """All entities of one scene."""

    items: tuple[Entity, ...]
    T_world_dataset: Float[np.ndarray, "4 4"]
    voxel_size_m: float

    def __len__(self) -> int:
        return len(self.items)

    def __iter__(self) -> Iterator[Entity]:
        return iter(self.items)

    def __getitem__(self, index: SupportsIndex) -> Entity:
        return self.items[index]


@dataclasses.dataclass(frozen=True, eq=False)
class ContactGraph:
    """Support tree and proximal pairs over the entities of one scene, by position in it."""

    parent: Int[np.ndarray, " entities"]
    """Position of the supporting parent, or `ROOM`, or `UNSUPPORTED`."""
    support_plane: Int[np.ndarray, " entities"]
    """Plane of the parent that carries the entity; -1 where there is none, or none was seen."""
    score: Float[np.ndarray, " entities"]
    """S of the chosen parent; 0 where there is none."""
    attachment: tuple[Attachment, ...]
    refined_box: Box
    """[entities]: bottoms moved onto their supporting planes (the boxes of mAP_re)."""
    support_height_m: Float[np.ndarray, " entities"]
    """d^s: height of what carries the entity (`geometry.support_heights`)."""
    proximal: Int[np.ndarray, "pairs 2"]
    proximal_depth_m: Float[np.ndarray, " pairs"]
    """Depth to which the two boxes overlap."""

    def children(self, position: int) -> np.ndarray:
        """Positions of what ``position`` carries."""
        return np.flatnonzero(self.parent == position)


@dataclasses.dataclass(frozen=True, eq=False)
class Shortlist:
    """The best (entity, model, rotation) triples: one flat axis, sorted by entity, then error."""

    entity: Int[np.ndarray, " candidates"]
    """Position in the entities."""
    model: Int[np.ndarray, " candidates"]
    """Position in the library's models."""
    rotation: Int[np.ndarray, " candidates"]
    """Row of `geometry.CUBE_ROTATIONS` applied to the model."""
    error: Float[np.ndarray, " candidates"]
    """Matching error D."""
    plane_match: Int[np.ndarray, "candidates planes"]
    """Model plane for each entity plane, -1 = without partner."""


@dataclasses.dataclass(frozen=True, eq=False)
class Alignments:
    """What alignment found for each row of a shortlist, on the same flat axis."""

    scale: Float[np.ndarray, " candidates"]
    yaw: Float[np.ndarray, " candidates"]
    """World yaw of the rotated model, radians."""
    translation: Float[np.ndarray, "candidates 3"]
    T_world_cad: Float[np.ndarray, "candidates 4 4"]
    """Without scale, the 24-rotation in it: p_world = T diag(scale) p_cad."""
    cost: Float[np.ndarray, " candidates"]
    """J at the pose, the prior left out."""
    status: Int[np.ndarray, " candidates"]
    """`AlignmentStatus`."""
    alignment_error_m: Float[np.ndarray, " candidates"]
    """RMS distance from the entity's vertices to the moved model's surface."""


class AlignmentStatus(enum.IntEnum):
    """Outcome of one alignment."""

    CONVERGED = 0
    AT_BOUND = 1
    NOT_CONVERGED = 2
    SINGULAR = 3
    SLID = 4
    """Solved, then moved flush with what was seen: no minimum of J, but a smaller AE."""

    @property
    def label(self) -> str:
        """As it is written: ``not converged``."""
        return self.name.lower().replace("_", " ")

    @property
    def usable(self) -> bool:
        """Whether the pose may be taken."""
        return self not in (AlignmentStatus.NOT_CONVERGED, AlignmentStatus.SINGULAR)


@dataclasses.dataclass(frozen=True)
class Candidate:
    """One tried model of an entity, and why it lost."""

    cad_id: str
    rotation: int
    matching_error: float
    alignment_error_m: float
    status: str
    reason: str | None
    """Why it was not taken; None for the chosen one."""


@dataclasses.dataclass(frozen=True, eq=False)
class Placement:
    """What stands for one entity in the scene: a CAD model, or its scan mesh."""

    entity_id: int
    cad_id: str | None
    """None: the scan mesh stays."""
    T_world_cad: Float[np.ndarray, "4 4"] | None
    scale: Float[np.ndarray, "3"] | None
    matching_error: float | None
    alignment_error_m: float | None
    candidates: tuple[Candidate, ...]
    reason: str | None
    """Why no CAD stands here (layout, class without models, nothing fits), else None."""
