"""The panoptic mapper: one call per frame, a surface at any time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Int, Int8

from ..config import MappingSettings
from ..errors import MapError
from ..types import Camera, Frame, FrameSegments, PanopticSurface
from . import frame_checks, free_space, saved_map
from .blocks import BlockIndex
from .integrator import Integrator
from .kept_frames import KeptFrames
from .labels import MapLabels
from .packing import DEPTH_STEP_M, pack_frame
from .pool import VoxelPool, empty_pool
from .state import MapState, PosedFrame, ReadyFrame
from .surface import SurfaceExtractor
from .voxel_kernel import MapScale


class PanopticMapper:
    """Integrates posed frames and their segments into one panoptic voxel map (paper, sec. IV).

    With ``frames_per_step`` frames wait for each other; whatever asks for the map integrates those
    that wait first, so the map is the same, bit for bit, for any number of frames per step.

    Args:
        camera: The camera of every frame to come.
        settings: `MappingSettings`.
        T_world_dataset: From the frame in which a data set gave its poses to the world of the map;
            by default the identity, for poses that are the world's. It is kept and saved for those
            who add frames of the same data set; poses given to the map are in its world already.

    Raises:
        MapError: the camera cannot be that of its images.
    """

    def __init__(
        self,
        camera: Camera,
        settings: MappingSettings | None = None,
        T_world_dataset: Float[np.ndarray, "4 4"] | None = None,
    ) -> None:
        frame_checks.check_camera(camera)
        self.camera = camera
        self.settings = settings or MappingSettings()
        self.T_world_dataset = np.eye(4) if T_world_dataset is None else np.array(T_world_dataset)
        self.scale = _scale(self.settings)
        """The lengths of this map, for the kernels."""
        self.state = MapState(self.settings)
        pool = empty_pool(self.state.blocks.capacity, self.settings.label_slots)
        self.integrator = Integrator(camera, self.scale, pool)
        self.kept = KeptFrames(camera) if self.settings.keep_frames else None
        """The frames so far, with the setting ``keep_frames``."""
        self._waiting: list[ReadyFrame] = []
        self._surface = SurfaceExtractor(self.settings)

    @property
    def frames(self) -> int:
        """Frames integrated so far, those that wait for others included."""
        return self.state.frames + len(self._waiting)

    @property
    def pool(self) -> VoxelPool:
        """The voxels after all frames so far, in rows by `blocks`."""
        self.finish()
        return self.integrator.pool

    @property
    def blocks(self) -> BlockIndex:
        """Which block lies in which row of `pool`."""
        self.integrator.join()
        return self.state.blocks

    @property
    def labels(self) -> MapLabels:
        """What is known of the map's labels after all frames so far."""
        self.finish()
        return self.state.labels

    @property
    def step(self) -> int:
        """Rises with every change of voxels, renumbering included; see `BlockIndex.stamp`."""
        self.integrator.join()
        return self.state.step

    def integrate(self, frame: Frame, segments: FrameSegments) -> None:
        """Integrate one frame: geometry and colour, then labels, classes and instances.

        Raises:
            FrameError: this frame cannot be used; the map is as before and goes on with others.
            MapError: the map outgrows ``max_blocks`` or the memory; the frame leaves no trace, and
                the map so far can be used and saved. Or one of the frames before gave too many
                labels: these are counted while later ones are integrated.
        """
        self._add(self.posed(frame, segments))

    def posed(self, frame: Frame, segments: FrameSegments) -> PosedFrame:
        """The frame checked and packed.

        Raises:
            FrameError: this frame cannot be used.
        """
        depth_m, segment = frame_checks.checked(frame, segments, self.camera)
        packed = pack_frame(depth_m, segment, frame.color)
        farthest = int(np.rint(depth_m.max() / DEPTH_STEP_M))
        # Copies: frames wait and are kept, and the caller may use the arrays again.
        tables = frame.T_world_camera, segments.class_id, segments.instance
        return PosedFrame(packed, farthest, *(table.copy() for table in tables))

    def _add(self, frame: PosedFrame) -> None:
        ready = self.state.ready(frame, self.camera, self.scale, self.integrator.reserve)
        self.keep(frame)
        self._waiting.append(ready)
        if len(self._waiting) >= self.settings.frames_per_step:
            self._integrate_waiting()

    def keep(self, frame: PosedFrame) -> None:
        """Keep a frame for `reintegrate`, if the setting says so.

        Raises:
            MapError: it cannot be kept as PNG.
        """
        if self.kept is not None:
            self.kept.append(frame)

    def _integrate_waiting(self) -> None:
        waiting, self._waiting = self._waiting, []
        if waiting:
            self.integrator.integrate([self.state], [waiting])

    def finish(self) -> None:
        """Integrate the frames that wait, and write today's label numbers into all voxels.

        Raises:
            MapError: one of the frames gave too many labels.
        """
        self._integrate_waiting()
        self.integrator.renumber(self.state)

    def reintegrate(self, poses: Float[np.ndarray, "frames 4 4"]) -> PanopticMapper:
        """The map of the kept frames with corrected poses, as if they had come with these.

        Args:
            poses: T_world_camera of each integrated frame, in their order.

        Raises:
            FrameError: one of them is no pose, or too far from the origin.
            MapError: they are not as many as the frames, no frames were kept, or with these poses
                the map cannot grow.
        """
        if self.kept is None:
            raise MapError(
                "this map has kept no frames to integrate again",
                "map with MappingSettings.keep_frames = true",
            )
        if np.shape(poses) != (len(self.kept), 4, 4):
            raise MapError(
                f"poses of shape {np.shape(poses)} for {len(self.kept)} kept frames",
                "give one 4x4 T_world_camera for every frame that was integrated",
            )
        for i, T_world_camera in enumerate(poses):
            frame_checks.check_pose(T_world_camera, f"pose {i}")
        other = PanopticMapper(self.camera, self.settings, self.T_world_dataset)
        for frame in self.kept.replay(np.asarray(poses)):
            other._add(frame)
        return other

    def seen_empty(self, points: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, " n"]:
        """Whether points of the world were seen to be free space."""
        return self.observed(points) == free_space.EMPTY

    def observed(self, points: Float[np.ndarray, "n 3"]) -> Int8[np.ndarray, " n"]:
        """`free_space.UNKNOWN`, `EMPTY` or `SURFACE` at points of the world."""
        return free_space.observed(self.pool, self.blocks, self.scale, points)

    def map_labels(self) -> tuple[Int[np.ndarray, " labels"], Int[np.ndarray, " labels"]]:
        """Class and instance of every map label, as decided so far; 0 = undecided."""
        return self.labels.decisions()

    def surface(self) -> PanopticSurface:
        """The map's surface: a mesh with one instance per vertex, and one class per instance."""
        class_of, instance_of = self.map_labels()
        return self._surface.update(self.pool, self.blocks, class_of, instance_of, self.step)

    def save(self, path: str | Path) -> None:
        """Write the whole map (npz). One that is loaded from it goes on bit for bit.

        Raises:
            OutputError: the file cannot be written.
        """
        saved_map.save(self, Path(path))

    @classmethod
    def load(cls, path: str | Path) -> PanopticMapper:
        """A saved map, with its camera, settings and ``T_world_dataset``.

        Raises:
            MapError: the file is no saved map, or one of an older release.
        """
        return saved_map.load(cls, Path(path))


def _scale(settings: MappingSettings) -> MapScale:
    return MapScale(
        voxel_m=settings.voxel_size_m,
        truncation_m=settings.truncation_voxels * settings.voxel_size_m,
        label_band_m=min(settings.label_band_voxels, settings.truncation_voxels)
        * settings.voxel_size_m,
        max_weight=settings.max_weight,
    )
