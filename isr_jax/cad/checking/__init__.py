"""Whether the models of a library are sound: their files, numbers, and behaviour in MuJoCo."""

from .check import check_library
from .model import check_model
from .report import CheckReport, ModelCheck
from .settings import CheckSettings

__all__ = ["CheckReport", "CheckSettings", "ModelCheck", "check_library", "check_model"]
