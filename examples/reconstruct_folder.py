"""How do I turn my recording into a scene that a robot can act in?

python examples/reconstruct_folder.py out/room out/scene --segmenter simulated:medium
"""

from __future__ import annotations

import argparse

import isr_jax as isr


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recording", help="a folder in a layout that `isr inspect` knows")
    parser.add_argument("out", help="receives scene.json, scene.xml, the URDF package and the GLB")
    parser.add_argument("--segmenter", default="masks", help="as in `isr run`")
    parser.add_argument("--set", nargs="*", default=[], help="mapping.voxel_size_m=0.02 ...")
    options = parser.parse_args(arguments)

    settings = isr.with_overrides(isr.preset("default"), options.set)
    sequence = isr.open_sequence(options.recording, settings.input)
    masks = isr.open_segmenter(options.segmenter, options.recording)
    scene = isr.reconstruct(sequence, segmenter=masks, settings=settings)
    scene.save(options.out)

    for entity, placement in zip(scene.entities, scene.placements, strict=True):
        print(f"{entity.name:16} {placement.cad_id or placement.reason}")
    print(isr.settle(f"{options.out}/scene.xml", settings.stability))


if __name__ == "__main__":
    main()
