"""Bounds on what is read from foreign files, and on how long one model may take."""

from __future__ import annotations

import dataclasses

from ....config.fields import Checked, setting


@dataclasses.dataclass(frozen=True)
class ReadLimits(Checked):
    """What is beyond them is refused before it is read, or made smaller and said so."""

    max_file_mb: float = setting(
        512.0, "of one file, unpacked; 2 million triangles of STL are 100", unit="MB", low=1e-3
    )
    max_archive_ratio: float = setting(
        200.0, "unpacked by packed size of an archive's file; OBJ text packs 3 to 20 times", low=1.0
    )
    max_archive_files: int = setting(200_000, "files in one archive", low=1)
    max_faces: int = setting(2_000_000, "triangles of one model; more are refused", low=1)
    simplify_faces: int = setting(
        200_000, "triangles of one model; more are simplified to so many", low=4
    )
    max_texture_px: int = setting(1024, "longer side; larger textures are made smaller", low=1)
    max_image_px: float = setting(64e6, "pixels of a texture; more are not decoded", low=1.0)
    max_xml_depth: int = setting(200, "elements inside one another", low=1)
    max_copies: int = setting(1000, "of one body by <replicate>", low=1)
    time_limit_s: float = setting(300.0, "for one model, reading to writing", unit="s", low=0.1)
