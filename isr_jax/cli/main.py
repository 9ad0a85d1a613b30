"""The command line ``isr``."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from rich.console import Console

from ..config import Settings, preset, settings_from_toml, with_overrides
from ..errors import IsrError
from ..runtime.caches import enable_compilation_cache
from ..runtime.console import ConsoleReporter
from ..runtime.run_folder import versions
from .cad import cad
from .classes import classes
from .settings import settings

app = tyro.extras.SubcommandApp()
Positional = tyro.conf.Positional
_Kind = Annotated[str | None, tyro.conf.arg(metavar="KIND", help_behavior_hint="")]
_Text = Annotated[str | None, tyro.conf.arg(metavar="FOLDER", help_behavior_hint="")]


@dataclass(frozen=True)
class SettingsOptions:
    """Where the settings of a run come from."""

    preset: str = "default"
    """default, paper or voxblox++."""
    config: Path | None = None
    """A config.toml of an earlier run, instead of a preset."""
    set: tuple[str, ...] = ()
    """Changes: mapping.voxel_size_m=0.01 matching.shortlist=20"""

    def resolve(self) -> Settings:
        base = settings_from_toml(self.config) if self.config else preset(self.preset)
        return with_overrides(base, list(self.set))


Options = Annotated[SettingsOptions, tyro.conf.arg(name="")]


@app.command
def demo(
    out: Path = Path("out/demo"),
    seed: int | None = None,
    frames: int = 150,
    segmenter: str = "simulated:strong",
    options: Options = SettingsOptions(),
) -> None:
    """Film a built-in room, reconstruct it, settle it in MuJoCo and score it against the truth.

    Example: isr demo --out out/demo

    Args:
        out: Folder for the frames and the results.
        seed: Another room; the built-in one if left out.
        frames: Length of the walk.
        segmenter: simulated:perfect, :strong, :medium or :weak.
        options: Settings.
    """
    from ..demonstration.demo import demo as run_demo
    from .summary import headline_table

    console = Console()
    with ConsoleReporter(console) as reporter:
        result = run_demo(
            out,
            seed=seed,
            frames=frames,
            segmenter=segmenter,
            settings=options.resolve(),
            reporter=reporter,
        )
    console.print(headline_table(result.run, result.evaluation))


@app.command
def run(
    sequence: Positional[Path],
    out: Path,
    segmenter: str = "masks",
    library: str | None = None,
    start_from: Annotated[str | None, tyro.conf.arg(name="from")] = None,
    options: Options = SettingsOptions(),
) -> None:
    """Turn a posed RGB-D sequence into a scene that stands in MuJoCo.

    Example: isr run captures/kitchen --segmenter yolox.onnx+deeplab.onnx --out out/kitchen

    A second run reuses what is finished; a killed one resumes.

    Args:
        sequence: Folder with the frames (7-Scenes, TUM RGB-D, SceneNN, ScanNet, or rgb/ depth/
            poses/).
        out: Folder for the results.
        segmenter: ONNX models (a.onnx+b.onnx), masks (a folder with panoptic.json), or
            simulated:LEVEL for rendered rooms.
        library: Folder of CAD models, or several joined by +; the built-in kit if left out.
        start_from: Compute this stage and all after it anew: mapping, entities, contact_graph,
            matching, alignment or physical_check.
        options: Settings.
    """
    from .. import pipeline
    from .summary import run_tables

    console = Console()
    with ConsoleReporter(console) as reporter:
        result = pipeline.run(
            sequence,
            out,
            segmenter=segmenter,
            library=library,
            settings=options.resolve(),
            start_from=start_from,
            reporter=reporter,
        )
    for table in run_tables(result):
        console.print(table)


@app.command(name="map")
def map_(
    sequence: Positional[Path],
    out: Path,
    segmenter: str = "masks",
    start: int = 0,
    continue_from: Annotated[
        Path | None, tyro.conf.arg(metavar="FILE", help_behavior_hint="")
    ] = None,
    options: Options = SettingsOptions(),
) -> None:
    """Integrate a posed RGB-D sequence into a panoptic map: meshes with classes and instances.

    Example: isr map captures/kitchen --segmenter yolox.onnx+deeplab.onnx --out out/kitchen

    Writes into OUT/map: panoptic.ply (colour, normal, instance and class per vertex),
    panoptic.glb (one node per instance), instances/chair_1.ply and .glb and so on, instances.json
    (what each is), and map.npz, to which `isr map MORE_FRAMES --continue-from
    out/kitchen/map/map.npz` adds frames.

    Args:
        sequence: Folder with the frames (7-Scenes, TUM RGB-D, SceneNN, ScanNet, or rgb/ depth/
            poses/).
        out: Folder for the results.
        segmenter: ONNX models (a.onnx+b.onnx), masks (a folder with panoptic.json), or
            simulated:LEVEL for rendered rooms.
        start: First frame; input.stride and input.max_frames count from it.
        continue_from: A map.npz that goes on. Its camera must be this sequence's, the poses of
            both must be in one frame, and its mapping settings hold.
        options: Settings.
    """
    from ..map_runs.make_map import make_map

    console = Console()
    with ConsoleReporter(console) as reporter:
        made = make_map(
            sequence,
            out,
            segmenter=segmenter,
            settings=options.resolve(),
            start=start,
            continue_from=continue_from,
            reporter=reporter,
        )
    console.print(made.table())
    console.print(f"{made.live.frames} frames, {len(made.skipped)} skipped: {made.folder}")


@app.command
def synth(
    out: Path,
    seed: int = 7,
    kind: _Kind = None,
    library: _Text = None,
    frames: int = 150,
    size: str = "640x480",
    no_noise: tyro.conf.FlagCreatePairsOff[bool] = False,
    drift: tuple[float, float] = (0.0, 0.0),
    jitter: tuple[float, float] = (0.0, 0.0),
    sheet: Annotated[Path | None, tyro.conf.arg(metavar="FILE", help_behavior_hint="")] = None,
) -> None:
    """Make a furnished room that stands in MuJoCo, its RGB-D film and its truth.

    Example: isr synth --seed 7 --kind kitchen --out out/room

    `isr run out/room --segmenter simulated:medium --out out/scene` reconstructs it, `isr eval
    out/scene out/room/truth` scores that. The same arguments write the same bytes; what is
    there already is kept.

    Args:
        out: Folder for the frames; truth/ in it has instances, classes, boxes, planes, supports,
            models, poses, joints and meshes.
        seed: Of the room, the walk and the noise.
        kind: kitchen, office, living, bedroom or meeting; drawn from the seed if left out.
        library: Folder of the models that furnish it, or several joined by +; the built-in kit if
            left out.
        frames: Length of the walk.
        size: Of the images, pixels.
        no_noise: True depth, without the sensor's noise.
        drift: Poses drift: metres after a metre of way, radians after a radian of turning.
        jitter: Poses jitter: metres and radians, each frame by itself.
        sheet: Picture of some frames (colour, depth, instances); OUT/sheet.png if left out.
    """
    from ..cad import open_library
    from ..config import NoiseModel, PoseNoise
    from ..demonstration.film import film_room, image_size
    from ..synthetic import NO_NOISE
    from ..synthetic.film.contact_sheet import contact_sheet

    width, height = image_size(size)
    console, picture = Console(), sheet or out / "sheet.png"
    with ConsoleReporter(console) as reporter:
        film = film_room(
            out,
            seed=seed,
            kind=kind,
            frames=frames,
            width=width,
            height=height,
            noise=NO_NOISE if no_noise else NoiseModel(),
            pose_noise=PoseNoise(*drift, *jitter),
            library=open_library(library) if library else None,
            reporter=reporter,
        )
        contact_sheet(film, picture)
    console.print(f"{frames} frames: {film}; truth: {film / 'truth'}; look at it: {picture}")


@app.command
def inspect(sequence: Positional[Path]) -> None:
    """Say what a sequence is: frames, intrinsics, pose convention, gravity, depth unit, faults.

    Example: isr inspect captures/kitchen

    Args:
        sequence: Folder with the frames.
    """
    from ..datasets import inspect_sequence

    Console().print(inspect_sequence(sequence).table())


@app.command
def settle(scene: Positional[Path], duration: float = 5.0) -> None:
    """Let a scene settle in MuJoCo and print ISR-Stab: penetration, drift, what fell over.

    Example: isr settle out/kitchen/scene.xml

    Args:
        scene: An MJCF file.
        duration: Simulated seconds.
    """
    from ..config import StabilitySettings
    from ..stability import settle as settle_scene

    Console().print(settle_scene(scene, StabilitySettings(duration_s=duration)).table())


@app.command(name="eval")
def evaluate(
    result: Positional[Path],
    truth: Positional[Path],
    library: _Text = None,
    truth_library: _Text = None,
    released_counting: tyro.conf.FlagCreatePairsOff[bool] = False,
) -> None:
    """Score a result against the truth: map, boxes, contact graph, models, surface.

    Example: isr eval out/demo out/demo/sequence/truth

    Args:
        result: Folder that `isr run` wrote.
        truth: Folder with a true scene.json, observed.npz and meshes/.
        library: Folder of the result's models, or several joined by +; the built-in kit if left
            out.
        truth_library: Folder of the models that truly stand there; the result's if left out.
        released_counting: Also count as the released code does, for comparison only.
    """
    from ..cad import default_library, open_library
    from ..evaluation import evaluate as score

    report = score(
        result,
        truth,
        library=open_library(library) if library else default_library(),
        truth_library=open_library(truth_library) if truth_library else None,
        released_counting=released_counting,
    )
    report.write(result / "evaluation.json")
    Console().print(report.table())


@app.command
def view(result: Positional[Path], port: int = 8080) -> None:
    """Show a result in the browser: panoptic mesh, boxes, contact graph and placed models.

    Example: isr view out/demo

    Args:
        result: Folder that `isr run` wrote.
        port: Port on this machine; stop with Ctrl-C.
    """
    from ..viewer import view as show

    show(result, port=port)


app.command(cad)
app.command(classes)
app.command(settings)


def version_line() -> str:
    """The versions of this package and of those whose numbers it depends on, in one line."""
    known = versions()
    others = ", ".join(f"{name} {known[name]}" for name in ("jax", "mujoco", "python"))
    return f"isr_jax {known['isr_jax']} ({others})"


def main() -> None:
    """Entry point; a user's error is one message and exit status 2."""
    if sys.argv[1:] == ["--version"]:
        print(version_line())
        sys.exit(0)
    enable_compilation_cache()
    try:
        app.cli(
            prog="isr",
            description="From a posed RGB-D sequence to a room that a robot can act in. "
            "`isr --version` says which versions run.",
        )
    except IsrError as error:
        Console(stderr=True).print(f"[red]error:[/] {error}", highlight=False)
        sys.exit(2)
    except KeyboardInterrupt:
        Console(stderr=True).print("stopped; what is finished is kept")
        sys.exit(130)


if __name__ == "__main__":
    main()
