"""What a depth camera and its tracking add to the truth; no stage of the pipeline reads these."""

from __future__ import annotations

import dataclasses

from .fields import Checked, setting


@dataclasses.dataclass(frozen=True)
class NoiseModel(Checked):
    """A structured-light depth camera (`synthetic.sensor_depth` has the equations)."""

    axial_m: float = setting(0.0012, "axial sigma at 0.4 m", unit="m", low=0.0)
    axial_growth_per_m: float = setting(
        0.0019,
        "growth of the axial sigma: times (z - 0.4)^2, added to axial_m",
        unit="1/m",
        low=0.0,
    )
    grazing_m: float = setting(
        1e-4,
        "growth at grazing angles: times theta^2 / (pi/2 - theta)^2 / sqrt(z), added to axial_m",
        unit="m",
        low=0.0,
    )
    lateral_px: float = setting(0.8, "sigma of the jitter of depth edges", unit="px", low=0.0)
    lateral_growth_px: float = setting(
        0.035,
        "growth of the lateral sigma: times theta / (pi/2 - theta), added to lateral_px",
        unit="px",
        low=0.0,
    )
    correlated_share: float = setting(
        0.5, "share of the axial variance that neighbours have in common", low=0.0, high=1.0
    )
    correlation_px: int = setting(
        9,
        "side of the window over which neighbours have axial noise in common",
        unit="px",
        low=1,
        high=99,
    )
    baseline_m: float = setting(
        0.075, "distance between projector and camera; 0 = no quantisation", unit="m", low=0.0
    )
    disparity_step_px: float = setting(0.125, "quantum of the disparity", unit="px", low=0.0)
    projector_shadow: bool = setting(
        True,
        "surfaces that the projector, one baseline to the right, does not light return nothing",
    )
    edge_dropout: float = setting(0.4, "share of pixels lost at depth edges", low=0.0, high=1.0)
    dropout: float = setting(0.002, "share of pixels lost anywhere", low=0.0, high=1.0)
    grazing_limit: float = setting(
        1.40, "surfaces seen flatter than this return nothing", unit="rad", low=0.0
    )
    least_return: float = setting(
        0.002,
        "albedo x cosine / depth^2 below which a surface returns nothing; fades in at twice that",
        unit="1/m^2",
        low=0.0,
    )
    range_min_m: float = setting(0.4, "nearer surfaces return nothing", unit="m", low=0.0)
    range_max_m: float = setting(4.5, "farther surfaces return nothing", unit="m", low=0.1)


@dataclasses.dataclass(frozen=True)
class PoseNoise(Checked):
    """What tracking makes of the camera's way (`synthetic.tracked_path` has the equations)."""

    drift_m: float = setting(
        0.0,
        "sigma per axis after one metre of way, growing with the root of the way",
        unit="m",
        low=0.0,
    )
    drift_rad: float = setting(
        0.0,
        "sigma of the heading after one radian of turning, growing with the root of the turning",
        unit="rad",
        low=0.0,
    )
    jitter_m: float = setting(0.0, "sigma per axis of each frame by itself", unit="m", low=0.0)
    jitter_rad: float = setting(0.0, "sigma of each frame's turn by itself", unit="rad", low=0.0)
