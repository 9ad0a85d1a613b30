"""Contact graph: what carries what, what hangs on what, and whose boxes overlap.

Follows section III of the paper. For child c, entity i and its plane k, with h(.) the height:

    D = bottom(c) - h(plane k)  (Eq. 1)        A = overlap(c, i, k) / area(bottom of c)  (Eq. 2)
    S = (1 - min(1, |D|)) * A   (Eq. 3)

All (c, i, k) of all scenes are scored at once on a flat axis; the best admissible parent wins.
"""

from ..runtime.stage import Stage
from ..types import ContactGraph
from .build import build_contact_graphs
from .networkx_view import to_networkx
from .support import Support, polygon_contact, support_score, vertex_contact

__all__ = [
    "STAGE",
    "VERSION",
    "Support",
    "build_contact_graphs",
    "polygon_contact",
    "support_score",
    "to_networkx",
    "vertex_contact",
]

VERSION: int = 3
STAGE = Stage("contact_graph", VERSION, ContactGraph, ("contact_graph", "support"))
