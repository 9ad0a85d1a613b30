"""Names of the things of one scene: ``chair_1`` is the largest chair."""

from __future__ import annotations

from collections.abc import Iterable


def number_by_class(things: Iterable[tuple[str, float, int]]) -> list[tuple[int, str]]:
    """Number things in their class by the volume of their box, largest first.

    Args:
        things: Class, volume of the gravity-aligned box in m^3, and id of each. Of equal volumes
            the lower id comes first.

    Returns:
        Position in ``things`` and name, ``class_k``, by class and then by k.
    """
    ordered = sorted(enumerate(things), key=lambda item: (item[1][0], -item[1][1], item[1][2]))
    counts: dict[str, int] = {}
    named = []
    for position, (class_name, _, _) in ordered:
        counts[class_name] = k = counts.get(class_name, 0) + 1
        named.append((position, f"{class_name}_{k}"))
    return named
