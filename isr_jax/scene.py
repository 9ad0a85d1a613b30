"""A scene in memory: what the stages found, to a folder and back."""

from __future__ import annotations

import dataclasses
import hashlib
from pathlib import Path
from typing import Any

import numpy as np

from .alignment import AlignmentProblem, SurfacePairs, problem_of, surfaces_of
from .borders.ply import read_mesh
from .cad import default_library, open_library
from .config import Settings, preset, settings_from_dict, settings_to_dict
from .errors import LibraryError, SceneError
from .export import export_scene
from .library import CadLibrary
from .runtime.run_folder import versions
from .runtime.store import StageKey, StageStore
from .scene_file import (
    SceneFile,
    entities_of_scene,
    graph_of_scene,
    placements_of_scene,
    read_scene,
)
from .types import (
    Alignments,
    ContactGraph,
    Entities,
    MappingResult,
    Mesh,
    Placement,
    Shortlist,
)

_CANDIDATES, _CANDIDATES_VERSION = "candidates", 1
_NO_MESH = Mesh(np.zeros((0, 3), np.float32), np.zeros((0, 3), np.int32))


@dataclasses.dataclass(frozen=True, eq=False)
class Scene:
    """A reconstructed scene: what is there, what carries it, and which model stands for it."""

    entities: Entities
    graph: ContactGraph
    shortlist: Shortlist | None
    """None for a true scene, for which no models were looked for."""
    aligned: Alignments | None
    """Of each row of the shortlist; None where there is none."""
    placements: tuple[Placement, ...]
    library: CadLibrary
    settings: Settings
    mapping: MappingResult | None = None
    """None when the entities did not come from frames, and in a scene that was loaded."""

    def save(self, out_dir: str | Path) -> SceneFile:
        """Write scene.json, scene.xml, the URDF package and the GLB; each is read back and checked.

        `load_scene` brings the scene back.

        Raises:
            OutputError: the folder cannot be written, or an export differs from the scene.
        """
        out_dir = Path(out_dir)
        written = export_scene(
            self.entities,
            self.graph,
            self.placements,
            self.library,
            out_dir,
            self.settings.export,
            metrics=self._metrics(),
            all_settings=settings_to_dict(self.settings),
            versions=versions(),
            surface=self.mapping.surface if self.mapping else None,
        )
        if self.shortlist is not None and self.aligned is not None:
            store = StageStore(out_dir / "stages")
            store.save(_CANDIDATES, _key(store, out_dir), (self.shortlist, self.aligned))
        return written

    def _metrics(self) -> dict[str, Any]:
        if self.mapping is None:
            return {}
        skipped = list(self.mapping.skipped)
        return {"frames_used": self.mapping.frames_used, "frames_skipped": skipped}


def load_scene(folder: str | Path, *, library: CadLibrary | None = None) -> Scene:
    """The scene that `Scene.save` or ``isr run`` wrote: entities, graph, candidates, placements.

    Poses and supports are those of ``scene.json``, meshes those in ``map/``. A true scene
    (``truth/`` of a film) comes back too; it has no candidates.

    Args:
        folder: Holds ``scene.json``.
        library: The models that stand in the scene; by default those that it names. Candidates
            are positions in a library: with another one the scene comes without them.

    Raises:
        SceneError: a file is missing, damaged, or is not what it should be.
        SettingError: the settings are of another version.
        LibraryError: a model of the scene is in no library at hand.
        OutputError: what is stored of the candidates is damaged.
    """
    folder = Path(folder)
    saved = read_scene(folder / "scene.json")
    settings = _settings_of(saved)
    entities = entities_of_scene(
        saved, lambda record: _mesh_at(folder, record.mesh), settings.mapping.voxel_size_m
    )
    models = _library_of(saved, folder, library)
    shortlist, aligned = _candidates_of(folder) if _is_of(saved, models) else (None, None)
    return Scene(
        entities,
        graph_of_scene(saved, entities),
        shortlist,
        aligned,
        placements_of_scene(saved),
        models,
        settings,
    )


def alignment_problem(*scenes: Scene) -> AlignmentProblem:
    """The (entity, candidate) pairs of scenes, as `align` solves them: for gradients.

    Row k is row k of the shortlists, laid end to end; after them comes padding (``valid`` is
    False there).

    Args:
        *scenes: From `reconstruct`, `furnish_scenes` or `load_scene`, of one library.

    Raises:
        SceneError: a scene holds no candidates.
    """
    found, shortlists = _with_candidates(scenes)
    entities, graphs = [s.entities for s in found], [s.graph for s in found]
    return problem_of(entities, graphs, shortlists, found[0].library, found[0].settings.support)


def alignment_surfaces(*scenes: Scene) -> SurfacePairs:
    """The points and triangles that `alignment_error` compares, row by row of the problem.

    Args:
        *scenes: As for `alignment_problem`.

    Raises:
        SceneError: a scene holds no candidates.
    """
    found, shortlists = _with_candidates(scenes)
    entities, settings = [s.entities for s in found], found[0].settings.alignment
    return surfaces_of(entities, shortlists, found[0].library, settings)


def _with_candidates(scenes: tuple[Scene, ...]) -> tuple[tuple[Scene, ...], list[Shortlist]]:
    shortlists = [scene.shortlist for scene in scenes if scene.shortlist is not None]
    if not scenes or len(shortlists) < len(scenes):
        raise SceneError(
            f"{len(scenes) - len(shortlists)} of {len(scenes)} scenes hold no candidates",
            "give at least one scene; `replace_with_cad(scene.entities)` finds candidates",
        )
    return scenes, shortlists


def _key(store: StageStore, folder: Path) -> StageKey:
    """Candidates belong to one scene.json: rows are positions of its entities."""
    digest = hashlib.sha256((folder / "scene.json").read_bytes()).hexdigest()
    return store.key(_CANDIDATES, _CANDIDATES_VERSION, {}, {"scene.json": digest})


def _candidates_of(folder: Path) -> tuple[Shortlist | None, Alignments | None]:
    if not (folder / "stages").is_dir():
        return None, None
    store = StageStore(folder / "stages")
    return store.load(_CANDIDATES, _key(store, folder), tuple) or (None, None)


def _settings_of(saved: SceneFile) -> Settings:
    """Of a true scene, which no settings made, those of the preset ``default``."""
    return settings_from_dict(saved.settings) if "preset" in saved.settings else preset("default")


def _mesh_at(folder: Path, path: str | None) -> Mesh:
    """Of an entity; one without a path was never seen (a floor that was put in)."""
    if path is None:
        return _NO_MESH
    return read_mesh(folder / path, "keep the folder as it was written")


def _library_of(saved: SceneFile, folder: Path, given: CadLibrary | None) -> CadLibrary:
    """The given library, or the one that the scene names, or the kit; it holds what stands."""
    library = default_library() if given is None else given
    named = saved.library
    if given is None and named is not None and named.content_hash != library.content_hash:
        library = open_library(named.source)
    known = {model.id for model in library.models}
    absent = sorted({e.cad.id for e in saved.entities if e.cad is not None} - known)
    if absent:
        raise LibraryError(
            f"{folder / 'scene.json'} has models that {library.source} lacks: {', '.join(absent)}",
            "give the library that it was made with",
        )
    return library


def _is_of(saved: SceneFile, library: CadLibrary) -> bool:
    return saved.library is not None and saved.library.content_hash == library.content_hash


__all__ = ["Scene", "alignment_problem", "alignment_surfaces", "load_scene"]
