"""Physical check (Sec. V-D): one candidate an entity, so that all stand together."""

from .check import check
from .contact import contact_ratio
from .min_conflicts import min_conflicts

VERSION: int = 2
"""Changes when the results of this stage do."""

__all__ = ["VERSION", "check", "contact_ratio", "min_conflicts"]
