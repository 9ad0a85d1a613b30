"""The command ``isr cad``: build, extend, check, list and show libraries of CAD models."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro
from rich.console import Console

from ..config import HullsToCheck
from ..runtime.console import ConsoleReporter
from .files import write_text

if TYPE_CHECKING:
    from ..library import CadLibrary

_Folder = Annotated[
    tyro.conf.Positional[Path | None], tyro.conf.arg(metavar="[LIBRARY]", help_behavior_hint="")
]
_Library = Annotated[Path | None, tyro.conf.arg(metavar="FOLDER", help_behavior_hint="")]
_File = Annotated[Path | None, tyro.conf.arg(metavar="FILE", help_behavior_hint="")]
_Classes = Annotated[
    tuple[str, ...], tyro.conf.arg(name="class", metavar="CLASS ...", help_behavior_hint="")
]
_Models = Annotated[tuple[str, ...], tyro.conf.arg(metavar="ID ...", help_behavior_hint="")]
_Name = Annotated[str | None, tyro.conf.arg(name="class", metavar="CLASS", help_behavior_hint="")]
_Text = Annotated[str | None, tyro.conf.arg(metavar="TEXT", help_behavior_hint="")]
_Direction = Annotated[
    tuple[float, float, float] | None, tyro.conf.arg(metavar="X Y Z", help_behavior_hint="")
]
_Flag = tyro.conf.FlagCreatePairsOff[bool]


@dataclass(frozen=True)
class CadBuild:
    """Write the built-in kit of CAD models; the same bytes every time.

    Example: isr cad build --out my_library
    """

    out: Path = Path("cad_db")
    """Folder for the models; in a checkout of the repository, cad_db is its own library."""

    def run(self, console: Console) -> None:
        from ..cad import build_library
        from ..cad.tables import class_table

        with ConsoleReporter(console) as reporter:
            built = build_library(self.out, lambda d, t: reporter.progress("build", d, t))
        console.print(class_table(built))
        size = sum(p.stat().st_size for p in self.out.rglob("*") if p.is_file())
        classes = len({model.class_name for model in built.models})
        console.print(f"{len(built)} models in {classes} classes, {size / 1e6:.1f} MB: {self.out}")


@dataclass(frozen=True)
class CadAdd:
    """Take models into a library: OBJ, GLB, STL, PLY, DAE, URDF, MJCF, PartNet-Mobility,
    ShapeNetSem, SweetHome3D (.sh3f).

    Unit, up and front are read where the files state them, else estimated, which each model's
    notes say. What cannot be used is refused with its reason; the rest comes in.

    Example: isr cad add ~/furniture --library my_library
    """

    path: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="PATH")]
    """A folder, an archive or a file."""
    library: Annotated[Path, tyro.conf.arg(metavar="FOLDER")]
    """Folder of the library; made if it is not there."""
    class_name: _Name = None
    """Class of all of them, instead of what the files or names say."""
    unit_m: Annotated[float | None, tyro.conf.arg(metavar="METRES", help_behavior_hint="")] = None
    """Metres per unit of length: 0.01 for centimetres."""
    up: _Direction = None
    """Direction that is up in the files: 0 1 0"""
    front: _Direction = None
    """Direction that they face: 0 0 1"""
    licence: _Text = None
    """Licence of all of them, instead of what the files say."""
    creator: _Text = None
    """Who made them, instead of what the files say."""
    workers: int = 2
    """Processes."""

    def run(self, console: Console) -> None:
        from ..cad.importing.add import AddOptions, add_models
        from ..cad.importing.add_report import report_tables

        options = AddOptions(
            class_name=self.class_name,
            up=self.up,
            front=self.front,
            unit_m=self.unit_m,
            licence=self.licence,
            creator=self.creator,
        )
        with ConsoleReporter(console) as reporter:
            report = add_models(
                self.path,
                self.library,
                options=options,
                progress=lambda d, t: reporter.progress("add", d, t),
                workers=self.workers,
            )
        for table in report_tables(report):
            console.print(table)
        notes = sum(bool(added.notes) for added in report.accepted)
        console.print(f"{notes} models with notes; `isr cad show ID --library {self.library}`")
        console.print(f"look at them: isr cad sheet {self.library} --out sheet.png")
        if not report.accepted:
            sys.exit(1)


@dataclass(frozen=True)
class CadCheck:
    """Check every model of a library: files, collision hulls, inertia, joints, planes; that it
    stands still for 5 s in MuJoCo, and that each joint opens when a hand pulls at its handle.

    Prints the models that fail, with reasons, and totals. The exit status is 1 if one fails.

    Example: isr cad check my_library --class chair fridge
    """

    library: _Folder = None
    """Folder of CAD models; the built-in library if left out."""
    class_name: _Classes = ()
    """Only these classes."""
    model: _Models = ()
    """Only these models: chair/ladder_42"""
    workers: int = 2
    """Processes."""
    hulls: HullsToCheck = "stored"
    """Imported models may have no collision hulls yet: stored skips what needs them, vhacd makes
    them within seconds, coacd within some ten seconds per model."""
    every: _Flag = False
    """Show models that passed, too."""
    json: _File = None
    """Write the whole report to this file."""

    def run(self, console: Console) -> None:
        from ..cad.checking.check import check_library

        source = self.library if self.library is not None else _library(None)
        if self.hulls != "stored":
            console.print(f"making collision hulls where there are none ({self.hulls})")
        with ConsoleReporter(console) as reporter:
            report = check_library(
                source,
                workers=self.workers,
                progress=lambda d, t: reporter.progress("check", d, t),
                only=(*self.class_name, *self.model),
                hulls=self.hulls,
            )
        console.print(report.table(every_model=self.every))
        if self.json is not None:
            write_text(self.json, report.json())
        if not report.passed:
            sys.exit(1)


@dataclass(frozen=True)
class CadList:
    """List the models of a library: size, joints, mass, mount, planes, licence, creator, source.

    Example: isr cad list --class fridge microwave
    """

    library: _Folder = None
    """Folder of CAD models; the built-in library if left out."""
    class_name: _Classes = ()
    """Only these classes."""
    count: _Flag = False
    """Only how many models each class has."""

    def run(self, console: Console) -> None:
        from ..cad.selection import of_classes
        from ..cad.tables import class_table, library_table

        library = _library(self.library)
        if self.count:
            console.print(class_table(library))
        else:
            console.print(library_table(library, of_classes(library, self.class_name)))


@dataclass(frozen=True)
class CadShow:
    """Say all about one model: parts, joints with ranges and handles, planes, materials, notes.

    Example: isr cad show fridge/combi_60 --out fridge.png
    """

    model: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="MODEL")]
    """<class>/<name>, as `isr cad list` prints it."""
    library: _Library = None
    """Folder of CAD models; the built-in library if left out."""
    out: _File = None
    """Draw it to this PNG: closed and, where it has joints, with all of them open."""

    def run(self, console: Console) -> None:
        from ..cad.pictures.sheet import draw_model
        from ..cad.selection import model_named
        from ..cad.tables import model_tables

        model = model_named(_library(self.library), self.model)
        console.print(model_tables(model))
        if self.out is not None:
            draw_model(model, self.out)
            console.print(f"picture: {self.out}")


@dataclass(frozen=True)
class CadSheet:
    """Draw a contact sheet: every model in a tile, its name and size below.

    Example: isr cad sheet --class chair --out chairs.png
    """

    library: _Folder = None
    """Folder of CAD models; the built-in library if left out."""
    out: Path = Path("sheet.png")
    """PNG; with --all, the folder of the sheets."""
    class_name: _Classes = ()
    """Only these classes."""
    columns: int = 8
    """Models per row."""
    open: _Flag = False
    """With joints open."""
    all: _Flag = False
    """One sheet per group of classes, cad_<group>.png in the folder --out; what has joints is
    shown open."""

    def run(self, console: Console) -> None:
        from ..cad.pictures.groups import grouped
        from ..cad.pictures.sheet import draw_models
        from ..cad.selection import of_classes

        library = _library(self.library)
        models = of_classes(library, self.class_name)
        share = OPEN_SHARE if self.open or self.all else 0.0
        sheets = {self.out: models}
        if self.all:
            sheets = {self.out / f"cad_{k}.png": group for k, group in grouped(models).items()}
        with ConsoleReporter(console) as reporter:
            for path, shown in sheets.items():
                name = path.stem
                draw_models(
                    shown,
                    path,
                    columns=self.columns,
                    open_share=share,
                    progress=lambda d, t, name=name: reporter.progress(name, d, t),
                )
        for path, shown in sheets.items():
            console.print(f"{len(shown)} models: {path}")


OPEN_SHARE = 0.6
"""How far joints are open where a sheet shows them open."""


def _library(path: Path | None) -> CadLibrary:
    from ..cad import default_library, open_library

    return default_library() if path is None else open_library(path)


_Action = (
    Annotated[CadBuild, tyro.conf.subcommand("build")]
    | Annotated[CadAdd, tyro.conf.subcommand("add")]
    | Annotated[CadCheck, tyro.conf.subcommand("check")]
    | Annotated[CadList, tyro.conf.subcommand("list")]
    | Annotated[CadShow, tyro.conf.subcommand("show")]
    | Annotated[CadSheet, tyro.conf.subcommand("sheet")]
)


def cad(action: Annotated[_Action, tyro.conf.arg(name="")]) -> None:
    """Build, extend, check, list and show libraries of CAD models.

    Example: isr cad list --class chair
    """
    action.run(Console())
