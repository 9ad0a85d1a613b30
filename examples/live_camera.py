"""How do I ask a map what stands where while the camera still moves?

A recording plays the camera here; `frames_of` is what you replace by your own driver: color
[height, width, 3] uint8, depth_m [height, width] metres, T_world_camera [4, 4] (OpenCV camera to a
world with z up and the floor at 0).

    python examples/live_camera.py out/room --segmenter simulated:medium
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator

import isr_jax as isr
from isr_jax.types import Frame, RgbdSequence


def frames_of(sequence: RgbdSequence) -> Iterator[Frame]:
    for k in range(len(sequence)):
        seen = sequence[k]
        yield Frame(k, f"{k:06d}", seen.color, seen.depth_m, seen.T_world_camera, sequence.camera)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recording", help="a folder in a layout that `isr inspect` knows")
    parser.add_argument("--segmenter", default="masks", help="as in `isr run`")
    parser.add_argument("--every", type=int, default=30, help="frames between two questions")
    parser.add_argument("--set", nargs="*", default=[], help="mapping.voxel_size_m=0.02 ...")
    options = parser.parse_args(arguments)

    settings = isr.with_overrides(isr.preset("default"), options.set)
    sequence = isr.open_sequence(options.recording, settings.input)
    live = isr.LiveMap(
        sequence.camera, isr.open_segmenter(options.segmenter, options.recording), settings
    )
    for frame in frames_of(sequence):
        live.integrate(frame)
        if live.frames % options.every == 0:
            graph, entities = live.contact_graph(), live.entities()
            carried = {
                entity.name: [entities[c].name for c in graph.children(k)]
                for k, entity in enumerate(entities)
                if len(graph.children(k))
            }
            print(f"after {live.frames} frames: {len(entities)} entities; {carried}")


if __name__ == "__main__":
    main()
