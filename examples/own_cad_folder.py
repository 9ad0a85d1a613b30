"""How do my own CAD models stand for what was seen?

A folder that `isr cad add` made (it reads OBJ, GLB, STL, URDF, MJCF, ...) is used beside the
package's own kit; a scene that was reconstructed before is furnished again with both.

    isr cad add ~/furniture --library my_models
    python examples/own_cad_folder.py out/scene my_models out/furnished
"""

from __future__ import annotations

import argparse

import isr_jax as isr


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", help="a folder that `isr run` wrote")
    parser.add_argument("models", help="a folder of models, or several joined by +")
    parser.add_argument("out", help="receives the furnished scene")
    options = parser.parse_args(arguments)

    before, models = isr.load_scene(options.scene), isr.open_library(options.models)
    scene = isr.replace_with_cad(before.entities, models, before.settings)
    scene.save(options.out)
    for entity, old, new in zip(scene.entities, before.placements, scene.placements, strict=True):
        if old.cad_id != new.cad_id:
            print(f"{entity.name:16} {old.cad_id} -> {new.cad_id or new.reason}")


if __name__ == "__main__":
    main()
