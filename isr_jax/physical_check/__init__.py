"""Physical check (Sec. V-D): one candidate per entity, so that all stand together."""

from ..runtime.stage import Stage
from .check import check, check_scenes
from .contact import contact_ratio
from .min_conflicts import min_conflicts

VERSION: int = 3
"""Changes when the results of this stage do."""
STAGE = Stage("physical_check", VERSION, tuple, ("physical_check", "support", "cad"))

__all__ = ["STAGE", "VERSION", "check", "check_scenes", "contact_ratio", "min_conflicts"]
