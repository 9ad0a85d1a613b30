"""A map that is asked while it grows: a frame in, and mesh, entities and contact graph at any time.

For a camera of one's own, without a sequence on disk:

    from isr_jax import LiveMap
    from isr_jax.types import Camera, Frame

    camera = Camera(fx=525.0, fy=525.0, cx=319.5, cy=239.5, width=640, height=480)
    live = LiveMap(camera, segmenter)                 # segmenter: a Frame to its PanopticFrame
    for i, (color, depth_m, T_world_camera) in enumerate(stream):
        live.integrate(Frame(i, str(i), color, depth_m, T_world_camera, camera))
        if i % 10 == 0:
            graph, entities = live.contact_graph(), live.entities()
            for k, entity in enumerate(entities):
                carried = [entities[c].name for c in graph.children(k)]
                print(entity.name, "carries", carried)
    live.save("map.npz")                              # LiveMap.load goes on from it

Poses are those of the world: z up, the floor at z = 0 (`Camera` and `Frame` say the rest).
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from jaxtyping import Float

from .. import contact_graph, entities, mapping, segmentation
from ..config import Settings, preset
from ..types import Camera, ContactGraph, Entities, Frame, Mesh, PanopticFrame, PanopticSurface

MaskSource = Callable[[Frame], PanopticFrame]
"""Anything that finds the masks of a frame; every `segmentation.Segmenter` is one."""


class LiveMap:
    """A panoptic map that grows frame by frame and answers between any two.

    Only what has changed since the last question is meshed again. Entities and the graph are
    computed from the whole mesh, once for each state of the map.

    Args:
        camera: Of every frame to come.
        segmenter: Finds the masks of a frame: a function, or what `open_segmenter` returns.
        settings: From `preset`; by default ``default``.
        T_world_dataset: What the entities say of where the poses came from, saved with the map; by
            default the identity, for poses that are the world's.

    Raises:
        MapError: the camera cannot be that of its images.
    """

    def __init__(
        self,
        camera: Camera,
        segmenter: MaskSource,
        settings: Settings | None = None,
        *,
        T_world_dataset: Float[np.ndarray, "4 4"] | None = None,
    ) -> None:
        self.settings = settings or preset("default")
        self.mapper = mapping.PanopticMapper(camera, self.settings.mapping, T_world_dataset)
        self._segmenter = segmenter
        self._entities: Entities | None = None
        self._graph: ContactGraph | None = None

    @classmethod
    def load(
        cls,
        path: str | Path,
        segmenter: MaskSource,
        settings: Settings | None = None,
    ) -> LiveMap:
        """A saved map that goes on as if it had never stopped.

        Its own camera, ``T_world_dataset`` and mapping settings hold; of ``settings`` the other
        stages' are used.

        Raises:
            MapError: the file is no saved map, or one of another release.
        """
        mapper = mapping.PanopticMapper.load(Path(path))
        live = cls(mapper.camera, segmenter, settings)
        live.mapper = mapper
        return live

    @property
    def frames(self) -> int:
        """Frames integrated so far."""
        return self.mapper.frames

    def integrate(self, frame: Frame) -> None:
        """Find the segments of a frame and integrate it.

        Raises:
            FrameError: this one frame cannot be used; the map is as before, the next may come.
            MapError: the map cannot go on; what was integrated is kept and can be saved.
        """
        masks = self._segmenter(frame)
        segments = segmentation.segment_frame(frame, masks, self.settings.segmentation)
        self._entities = self._graph = None
        self.mapper.integrate(frame, segments)

    def surface(self) -> PanopticSurface:
        """The mesh as it is now, one instance per vertex, one class per instance."""
        return self.mapper.surface()

    def mesh(self) -> Mesh:
        """The mesh as it is now: vertices, faces, colours, normals."""
        return self.surface().mesh

    def entities(self) -> Entities:
        """What is there now: layout and things, with boxes, planes and meshes."""
        if self._entities is None:
            self._entities = entities.extract_entities(
                self.surface(), self.mapper.T_world_dataset, self.settings.entities
            )
        return self._entities

    def contact_graph(self) -> ContactGraph:
        """What carries what now, by position in `entities`."""
        if self._graph is None:
            found, settings = self.entities(), self.settings
            self._graph = contact_graph.build_contact_graphs(
                [found], settings.contact_graph, settings.support
            )[0]
        return self._graph

    def save(self, path: str | Path) -> None:
        """Write the map (npz); `load` continues it bit for bit.

        Raises:
            OutputError: the file cannot be written.
        """
        self.mapper.save(Path(path))


__all__ = ["LiveMap", "MaskSource"]
