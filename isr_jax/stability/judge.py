"""ISR-Stab: does a scene stand still, counted from t = 0?"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from ..borders import simulation
from ..config import StabilitySettings
from ..errors import SceneError
from ..runtime.cores import usable_cores
from ..scene_file import SceneFile, read_scene
from .measures import body_motions, joint_motions, left_room, rates, variant_rates
from .report import Overlap, ResetReport, SetReport, StabilityReport

_OVERLAP_M = 1e-5
_SURVIVAL_M = 0.05
_ROOM_MARGIN_M = 0.5
"""A centre of mass this far outside the box about everything has left the room."""
_COMPILED = "a compiled MjModel cannot be freed: give the file or the MjSpec that it came from"


def settle(
    scene: simulation.SceneSource,
    settings: StabilitySettings | None = None,
    *,
    anchored: Sequence[str] | None = None,
) -> StabilityReport:
    """Let a scene move by itself in MuJoCo and report how far it stays where it was put.

    The start is ``qpos0``: keyframes are not read, controls are zero. The verdict does not depend
    on how many processors share the work.

    Args:
        scene: Path of an MJCF or URDF file, an `MjSpec`, or an `MjModel`. Beside a path,
            ``scene.json`` is read where there is one. An `MjModel` is judged as it is, but cannot
            be freed: `StabilityReport.freed` is None and `StabilityReport.not_freed` says why.
        settings: By default those of the preset ``default``.
        anchored: Static top-level bodies that stay fixed when everything is freed, besides those
            without mass. By default the layout and what hangs on it, from scene.json.

    Raises:
        SceneError: the scene cannot be loaded, ``scene.json`` cannot be read, or a body that is
            to be anchored is none of the static ones.
    """
    settings = settings or StabilitySettings()
    model = simulation.load_model(scene)
    stored = _scene_beside(scene)
    names = set(simulation.static_bodies(model)) | set(simulation.free_bodies(model))
    failed = () if stored is None else _without_body(stored, names)
    held = _held(model, stored, anchored)
    freed = None if simulation.is_compiled(scene) else simulation.freed_model(scene, held)
    errors = _alignment_errors(stored)
    return StabilityReport(
        scene=simulation.scene_label(scene),
        exported=_judge(model, "as exported", settings, len(failed)),
        freed=None if freed is None else _judge(freed, "everything freed", settings, len(failed)),
        not_freed=_COMPILED if freed is None else None,
        resets=_resets(model, settings, len(failed)),
        failed=failed,
        fixed=tuple(n for n in simulation.static_bodies(model) if n not in held),
        anchored=held,
        alignment_error_mean_m=float(np.mean(errors)) if errors else None,
        scans_kept=None if stored is None else sum(e.type == "scan" for e in stored.entities),
    )


def _held(model, stored: SceneFile | None, anchored: Sequence[str] | None) -> tuple[str, ...]:
    """What stays fixed when everything is freed."""
    static = simulation.static_bodies(model)
    unknown = [name for name in anchored or () if name not in static]
    if unknown:
        raise SceneError(
            f"anchored bodies that are not fixed to the world: {', '.join(unknown)}",
            f"use some of: {', '.join(static) or 'none'}",
        )
    held = _hung_or_layout(static, stored) if anchored is None else tuple(anchored)
    return held + tuple(n for n in simulation.unfreeable_bodies(model) if n not in held)


def _scene_beside(scene: simulation.SceneSource) -> SceneFile | None:
    if not isinstance(scene, str | Path):
        return None
    path = Path(scene).parent / "scene.json"
    return read_scene(path) if path.is_file() else None


def _hung_or_layout(static: Sequence[str], stored: SceneFile | None) -> tuple[str, ...]:
    entities = () if stored is None else stored.entities
    holds = {e.name for e in entities if e.type == "layout" or e.attachment in ("wall", "hanging")}
    return tuple(name for name in static if name in holds)


def _without_body(scene: SceneFile, names: set[str]) -> tuple[str, ...]:
    return tuple(e.name for e in scene.entities if e.type != "layout" and e.name not in names)


def _alignment_errors(scene: SceneFile | None) -> list[float]:
    cads = [] if scene is None else [e.cad for e in scene.entities if e.cad is not None]
    return [c.alignment_error_m for c in cads if c.alignment_error_m is not None]


def _judge(model, label: str, settings: StabilitySettings, failed: int) -> SetReport:
    touching = simulation.touches(model)
    depths = [max(0.0, t.depth_m) for t in touching]
    path = simulation.simulate(model, settings.duration_s)
    low, high = simulation.bounds(model, _ROOM_MARGIN_M)
    ranges = simulation.joint_ranges(model)
    early_s = min(1.0, settings.duration_s)
    motions = body_motions(path, low, high, (early_s, settings.duration_s))
    return SetReport(
        label=label,
        bodies=motions,
        joints=joint_motions(path, ranges),
        overlaps=tuple(
            Overlap(t.body_a, t.body_b, t.depth_m) for t in touching if t.depth_m > _OVERLAP_M
        ),
        penetration_max_m=max(depths, default=0.0),
        penetration_mean_m=float(np.mean(depths)) if depths else 0.0,
        contacts=sum(t.contacts for t in touching),
        warnings=path.warnings,
        early_s=early_s,
        end_s=float(path.time_s[-1]),
        rates=rates(motions, failed),
        variants=variant_rates(path, ranges, failed),
        left_room=sum(m.left_room for m in motions),
    )


def _resets(model, settings: StabilitySettings, failed: int) -> ResetReport:
    count = settings.perturbed_resets
    keys = np.random.SeedSequence(settings.seed).spawn(count)
    low, high = simulation.bounds(model, _ROOM_MARGIN_M)

    def stands(key: np.random.SeedSequence) -> np.ndarray:
        rng = np.random.default_rng(key)
        start = simulation.perturbed_start(model, rng, settings.perturbation_m)
        path = simulation.simulate(model, settings.duration_s, qpos=start)
        drift = np.linalg.norm(path.position_m[-1] - path.position_m[0], axis=-1)
        gone = left_room(path.position_m, low, high).any(0)
        return (drift < _SURVIVAL_M) & ~gone & (not path.warnings)

    # MuJoCo releases the interpreter lock while it steps; the order of results is that of keys.
    with ThreadPoolExecutor(usable_cores()) as pool:
        outcomes = list(pool.map(stands, keys))
    tries = sum(len(o) for o in outcomes) + count * failed
    return ResetReport(
        resets=count,
        perturbation_m=settings.perturbation_m,
        survived=sum(bool(o.all()) for o in outcomes),
        body_survival=float(sum(o.sum() for o in outcomes) / tries) if tries else None,
    )


__all__ = ["settle"]
