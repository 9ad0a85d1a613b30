"""The table of variants: each is its base with some settings taken from another preset."""

from __future__ import annotations

import dataclasses

from isr_jax.config import Settings, preset, with_overrides
from isr_jax.errors import SettingError

PRESET_GROUP, STEPS = "presets", "steps"
PAPER_WITHOUT, OURS_WITHOUT, OPTIONS = "paper-minus", "default-minus", "options"
GROUPS = {
    PRESET_GROUP: "the presets",
    STEPS: "from voxblox++ to paper, each row the one above with one change of the paper's more",
    PAPER_WITHOUT: "paper with one change of the paper's less",
    OURS_WITHOUT: "default with one idea of ours less",
    OPTIONS: "default with one other choice",
}
ABLATED = ("segmentation", "mapping", "entities")
"""Sections of the settings that variants change."""


@dataclasses.dataclass(frozen=True)
class Variant:
    """One row of the ablation."""

    group: str
    """Of `GROUPS`."""
    name: str
    base: str
    """The variant that it is compared with; of a preset, its own name."""
    source: str
    """The preset that the changed settings are taken from, if they do not say their values."""
    changes: tuple[str, ...]
    """Settings that differ from the base, as section.name or section.name=value."""
    shows: str

    @property
    def changed(self) -> tuple[str, ...]:
        """`changes` without their values."""
        return tuple(change.partition("=")[0] for change in self.changes)

    def settings(self, overrides: tuple[str, ...] = ()) -> Settings:
        """Of the base with ``overrides`` (section.name=value), then with the changes."""
        if self.base == self.name:
            return with_overrides(preset(self.name), list(overrides))
        settings = variant(self.base).settings(overrides)
        for change in self.changes:
            settings = self._with(settings, change)
        return settings

    def _with(self, settings: Settings, change: str) -> Settings:
        if "=" in change:
            return with_overrides(settings, [change])
        section, name = change.split(".")
        value = getattr(getattr(preset(self.source), section), name)
        stage = dataclasses.replace(getattr(settings, section), **{name: value})
        return dataclasses.replace(settings, **{section: stage})


def _preset(name: str, shows: str) -> Variant:
    return Variant(PRESET_GROUP, name, name, name, (), shows)


_TRIPLET = ("mapping.counts",)
_BILATERAL = ("segmentation.bilateral", "segmentation.majority_ratio")
_OUTLIERS = ("segmentation.remove_outliers",)
_REGULATE = ("mapping.regulate",)
_MERGE = ("mapping.merge_overlap_ratio", "mapping.merge_min_frames")


def _step(name: str, base: str, changes: tuple[str, ...], shows: str) -> Variant:
    return Variant(STEPS, name, base, "paper", changes, shows)


def _less(what: str, changes: tuple[str, ...], shows: str) -> Variant:
    return Variant(PAPER_WITHOUT, f"paper - {what}", "paper", "voxblox++", changes, shows)


def _ours(what: str, changes: tuple[str, ...], shows: str) -> Variant:
    return Variant(OURS_WITHOUT, f"default - {what}", "default", "paper", changes, shows)


def _option(what: str, change: str, shows: str) -> Variant:
    return Variant(OPTIONS, f"default, {what}", "default", "default", (change,), shows)


def _in(section: str, *names: str) -> tuple[str, ...]:
    return tuple(f"{section}.{name}" for name in names)


VARIANTS: tuple[Variant, ...] = (
    _preset("default", "all of ours"),
    _preset("paper", "all of the paper's"),
    _preset("voxblox++", "the paper's baseline"),
    _step("+ triplets", "voxblox++", _TRIPLET, "label, class and instance counted together"),
    _step("+ bilateral", "+ triplets", _BILATERAL, "masks split depth segments"),
    _step("+ outliers", "+ bilateral", _OUTLIERS, "stray pieces of a mask go to the background"),
    _step("+ regulation", "+ outliers", _REGULATE, "instances that share labels merge"),
    _step("+ merging", "+ regulation", _MERGE, "when segments merge, as in the paper: its preset"),
    _less("triplets", _TRIPLET, "counted in pairs"),
    _less("bilateral", _BILATERAL, "depth segments stay whole"),
    _less("outliers", _OUTLIERS, "stray pieces stay"),
    _less("regulation", _REGULATE, "instances never merge"),
    _less("merging", _MERGE, "when segments merge, as in voxblox++"),
    _ours("filling", _in("segmentation", "fill_from_masks"), "pixels of no segment follow a mask"),
    _ours("stuff cut out", _in("segmentation", "cut_out_stuff"), "as things are"),
    _ours("label band", _in("mapping", "label_band_voxels"), "labels only near the surface"),
    _ours("carving", _in("mapping", "carve"), "blocks that are seen through are freed"),
    _ours("shared labels", _in("mapping", "share_labels"), "pieces of one mask take one map label"),
    _ours("merge by class", _in("mapping", "merge_any_class"), "other classes do not merge"),
    _ours("frames", _in("mapping", "instance_min_frames"), "what one frame saw is not believed"),
    _ours("early merging", _in("mapping", "instance_merge_min"), "instances merge sooner"),
    _ours("class regulation", _in("mapping", "regulate_classes"), "also across classes"),
    _ours("silhouettes", _in("mapping", "mesh_max_jump_voxels"), "no surface across depth steps"),
    _ours("pieces", _in("entities", "piece_min_ratio"), "far pieces of a mesh are dropped"),
    _ours("coverage", _in("entities", "min_coverage"), "scattered flakes are no entity"),
    _ours("parts", _in("entities", "merge_inside_ratio"), "parts of a thing are joined"),
    _ours("hung classes", _in("entities", "hung_min_bottom_m"), "high cabinets hang"),
    _ours("box", _in("entities", "box_trim", "box_normal_weight"), "boxes robust to strays"),
    _ours("planes", _in("entities", "plane_min_area_m2", "board_min_area_m2"), "least planes"),
    _ours("walls", _in("entities", "wall_min_top_m"), "low planes are no walls"),
    _option("optimal association", "mapping.association=optimal", "not the largest count first"),
    _option("2 cm voxels", "mapping.voxel_size_m=0.02", "what resolution is worth"),
)


def variant(name: str) -> Variant:
    """The variant of this name.

    Raises:
        SettingError: there is none.
    """
    found = next((v for v in VARIANTS if v.name == name), None)
    if found is None:
        raise SettingError(
            f"unknown variant {name!r}", f"use one of: {', '.join(v.name for v in VARIANTS)}"
        )
    return found


def chosen(names: tuple[str, ...]) -> tuple[Variant, ...]:
    """Variants by name or by group, in the order of the table.

    Raises:
        SettingError: a name is neither.
    """
    for name in names:
        if name not in GROUPS:
            variant(name)
    return tuple(v for v in VARIANTS if v.name in names or v.group in names)
