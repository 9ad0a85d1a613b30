"""How do I furnish many scenes in one call, and sweep a setting?

The entities of all scenes go through every stage together; kernels compile once, and a number that
only scales something (a weight, a threshold) compiles nothing new when it changes.

    python examples/batch_of_scenes.py out/kitchen out/office --weights 0.2 1.0
"""

from __future__ import annotations

import argparse

import isr_jax as isr


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="+", help="folders that `isr run` wrote")
    parser.add_argument(
        "--weights", type=float, nargs="+", default=[0.2, 1.0], help="of matching.weight_upright"
    )
    options = parser.parse_args(arguments)

    rooms = [isr.load_scene(folder) for folder in options.scenes]
    for weight in options.weights:
        settings = isr.with_overrides(rooms[0].settings, [f"matching.weight_upright={weight}"])
        scenes = isr.furnish_scenes([r.entities for r in rooms], rooms[0].library, settings)
        for folder, scene in zip(options.scenes, scenes, strict=True):
            placed = sum(p.cad_id is not None for p in scene.placements)
            print(f"weight_upright {weight:g}: {folder}: {placed} models placed")


if __name__ == "__main__":
    main()
