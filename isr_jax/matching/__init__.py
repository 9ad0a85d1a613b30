"""Matching: the models of the library that resemble an entity most, each in 24 rotations.

Follows section V-B of the paper:

    D(x, y) = w_s d_s + w_pi d_pi + w_b d_b  (+ w_w d_w: backs to the wall)      (Eq. 4)

for every functional entity x, every model y of its match group and every rotation of the cube.
The assignment of planes in d_pi is exact; all (scene, entity, model, rotation) lie on one flat
axis. The best of each entity are its shortlist.
"""

from ..runtime.stage import Stage
from ..types import Shortlist
from .distance import (
    EntityFeatures,
    ModelFeatures,
    PairTerms,
    assignment_cost,
    matching_errors,
    pair_terms,
)
from .shortlist import match

__all__ = [
    "STAGE",
    "VERSION",
    "EntityFeatures",
    "ModelFeatures",
    "PairTerms",
    "assignment_cost",
    "match",
    "matching_errors",
    "pair_terms",
]

VERSION: int = 4
STAGE = Stage("matching", VERSION, Shortlist, ("matching", "support"))
