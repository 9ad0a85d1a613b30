"""Physical check (Sec. V-D): one candidate an entity, so that all stand together."""

from ..runtime.stage import Stage
from .check import check
from .contact import contact_ratio
from .min_conflicts import min_conflicts

VERSION: int = 2
"""Changes when the results of this stage do."""
STAGE = Stage("physical_check", VERSION, tuple, ("physical_check", "support"))

__all__ = ["STAGE", "VERSION", "check", "contact_ratio", "min_conflicts"]
