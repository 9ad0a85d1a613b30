"""How does the fit of a reconstructed scene change with weights, planes and boxes?

python examples/gradients_of_alignment.py out/scene
"""

from __future__ import annotations

import argparse
import dataclasses

import equinox as eqx
import jax
import jax.numpy as jnp

import isr_jax as isr


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", help="a folder that `isr run` wrote")
    options = parser.parse_args(arguments)

    scene = isr.load_scene(options.scene)
    settings = scene.settings.alignment
    problem = isr.alignment_problem(scene)
    weights = isr.AlignmentWeights.of(settings)

    def cost(weights, problem):
        return isr.align(problem, weights, settings).cost.sum()

    by_weight = jax.grad(cost)(weights, problem)
    for field in dataclasses.fields(by_weight):
        print(f"d cost / d {field.name:10} {float(getattr(by_weight, field.name)):+.3e}")

    by_input = eqx.filter_grad(lambda problem: cost(weights, problem))(problem)
    pull = jnp.abs(by_input.entity_offset).max(1)
    k = int(pull.argmax())
    name = scene.entities[int(scene.shortlist.entity[k])].name
    print(f"one millimetre of a plane of {name} changes the cost by {pull[k] / 1000:.2e} at most")

    surfaces = isr.alignment_surfaces(scene)

    def mean_error(weights):
        found = isr.align(problem, weights, settings)
        return isr.alignment_error(found, surfaces).mean()

    error_m, slope = jax.value_and_grad(mean_error)(weights)
    print(f"mean AE {1000 * float(error_m):.1f} mm; d AE / d height {float(slope.height):+.2e}")


if __name__ == "__main__":
    main()
