"""Does this scene, mine or anybody's, stand in MuJoCo?

python examples/judge_any_mjcf.py out/scene/scene.xml
"""

from __future__ import annotations

import argparse

import isr_jax as isr


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", help="an MJCF or URDF file")
    parser.add_argument("--seconds", type=float, default=5.0, help="simulated time")
    options = parser.parse_args(arguments)

    model = isr.simulation.load_model(options.scene)
    for touch in isr.simulation.touches(model)[:5]:
        print(f"{touch.body_a} and {touch.body_b}: {1000 * touch.depth_m:.2f} mm deep at t = 0")
    settings = isr.preset("default").stability
    report = isr.settle(
        options.scene, type(settings)(duration_s=options.seconds, perturbed_resets=2)
    )
    print(report)
    fallen = [b.name for b in report.exported.bodies if b.drift_end_m > 0.05]
    print("moved more than 5 cm:", ", ".join(fallen) or "nothing")


if __name__ == "__main__":
    main()
