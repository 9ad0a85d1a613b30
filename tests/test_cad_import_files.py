"""Files of foreign folders and archives: nothing outside them, nothing too large, no bombs."""

from __future__ import annotations

import os
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from isr_jax.cad.importing.names import Unique, fit_name, shown, slug
from isr_jax.cad.importing.reading.files import FolderFiles, ZipFiles, locate, within
from isr_jax.cad.importing.reading.limits import ReadLimits
from isr_jax.cad.importing.reading.properties import read_properties
from isr_jax.cad.importing.reading.safe_xml import parse_xml
from isr_jax.errors import LibraryError

from .foreign_models import BOMB, OUTSIDE, write, write_zip

LIMITS = ReadLimits()


@given(st.text(alphabet="ab./\\:", max_size=20), st.sampled_from(["", "a", "a/b"]))
def test_what_a_reference_means_is_below_the_root_or_refused(reference: str, folder: str) -> None:
    try:
        name = within(folder, reference)
    except LibraryError as error:
        assert "leads out of" in error.problem
        return
    root = os.path.realpath("/some/root")
    assert os.path.realpath(os.path.join(root, name)).startswith(root)


def test_out_of_the_root_and_into_it_again_is_inside() -> None:
    assert within("sub", "../../top/x.obj", "top") == "x.obj"
    with pytest.raises(LibraryError, match="leads out"):
        within("sub", "../../topper/x.obj", "top")


@pytest.mark.parametrize("reference", ["Wood.PNG", "wood.png", ".\\wood.png", "C:\\x\\Wood.png"])
def test_letter_case_and_foreign_paths_are_no_obstacle(tmp_path: Path, reference: str) -> None:
    files = FolderFiles(write(tmp_path, {"a/Wood.png": b"x"}), LIMITS)
    assert locate(files, "a", reference) == "a/Wood.png"
    assert locate(files, "a", "other.png") is None


def test_names_in_another_encoding_are_found(tmp_path: Path) -> None:
    (tmp_path / os.fsdecode(b"ma\xf1ana.png")).write_bytes(b"x")
    files = FolderFiles(tmp_path, LIMITS)
    found = locate(files, "", "mañana.png")
    assert found is not None and files.read(found) == b"x"
    assert shown(found) == "mañana.png"


def test_absolute_references_stay_inside(tmp_path: Path) -> None:
    files = FolderFiles(write(tmp_path, {"a.obj": "x"}), LIMITS)
    assert locate(files, "", "/etc/passwd") is None


def test_links_to_outside_are_refused(tmp_path: Path) -> None:
    (tmp_path / "secret").write_text("s")
    folder = tmp_path / "models"
    folder.mkdir()
    (folder / "a.obj").symlink_to(tmp_path / "secret")
    (folder / "b.obj").write_text("x")
    (folder / "c.obj").symlink_to(folder / "b.obj")
    files = FolderFiles(folder, LIMITS)
    with pytest.raises(LibraryError, match="link to outside"):
        files.read("a.obj")
    assert files.read("c.obj") == b"x"


def test_pipes_and_missing_files_are_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.obj")
    files = FolderFiles(tmp_path, LIMITS)
    with pytest.raises(LibraryError, match="no plain file"):
        files.read("pipe.obj")
    with pytest.raises(LibraryError, match="No such file"):
        files.read("none.obj")


def test_large_files_are_refused_before_they_are_read(tmp_path: Path) -> None:
    with open(tmp_path / "huge.stl", "wb") as file:
        file.truncate(50_000_000 * 50)  # sparse: nothing is on the disk
    with pytest.raises(LibraryError, match="2500 MB, above 512"):
        FolderFiles(tmp_path, LIMITS).read("huge.stl")


@pytest.mark.parametrize(
    ("name", "reason"),
    [("../evil.obj", "leads out"), ("/etc/evil.obj", "absolute"), ("C:\\evil.obj", "leads out")],
)
def test_unsafe_names_in_archives_are_refused(tmp_path: Path, name: str, reason: str) -> None:
    path = write_zip(tmp_path / "a.zip", {name: "x", "good.obj": "y"})
    files = ZipFiles(path, "a.zip", LIMITS)
    assert files.names == ("good.obj",)
    assert files.read("good.obj") == b"y"
    ((found, said),) = files.refused.items()
    assert reason in said
    with pytest.raises(LibraryError):
        files.read(found)


def test_links_and_twice_named_files_in_archives_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.zip"
    with zipfile.ZipFile(path, "w") as archive:
        link = zipfile.ZipInfo("link.obj")
        link.external_attr = 0o120777 << 16
        archive.writestr(link, "/etc/passwd")
        archive.writestr("twice.obj", "a")
        with pytest.warns(UserWarning, match="Duplicate name"):
            archive.writestr("twice.obj", "b")
    files = ZipFiles(path, "a.zip", LIMITS)
    assert files.names == ()
    assert "link" in files.refused["link.obj"] and "twice" in files.refused["twice.obj"]


def test_archive_bombs_are_refused(tmp_path: Path) -> None:
    path = write_zip(tmp_path / "a.zip", {"zeros.obj": bytes(20_000_000), "small.obj": bytes(1000)})
    files = ZipFiles(path, "a.zip", LIMITS)
    with pytest.raises(LibraryError, match="times its size"):
        files.read("zeros.obj")
    with pytest.raises(LibraryError, match="20 MB, above 10"):
        ZipFiles(path, "a.zip", ReadLimits(max_file_mb=10.0)).read("zeros.obj")
    assert files.read("small.obj") == bytes(1000)
    with pytest.raises(LibraryError, match="holds 2 files, above 1"):
        ZipFiles(path, "a.zip", ReadLimits(max_archive_files=1))


def test_an_archive_that_lies_about_a_size_gives_no_more_than_it_says(tmp_path: Path) -> None:
    path = write_zip(tmp_path / "a.zip", {"lie.obj": np.random.default_rng(0).bytes(100_000)})
    raw = bytearray(path.read_bytes())
    true, small = struct.pack("<I", 100_000), struct.pack("<I", 10)
    path.write_bytes(bytes(raw).replace(true, small))
    with pytest.raises(LibraryError, match=r"lie\.obj"):
        ZipFiles(path, "a.zip", LIMITS).read("lie.obj")


def test_damaged_archives_are_refused(tmp_path: Path) -> None:
    path = write_zip(tmp_path / "a.zip", {"a.obj": np.random.default_rng(0).bytes(5000)})
    raw = bytearray(path.read_bytes())
    raw[1000] ^= 0xFF
    with pytest.raises(LibraryError, match=r"cannot be unpacked|damaged"):
        ZipFiles(bytes(raw), "a.zip", LIMITS).read("a.obj")
    for broken in (bytes(raw[:2000]), b"", b"no zip"):
        with pytest.raises(LibraryError, match="no ZIP that can be read"):
            ZipFiles(broken, "a.zip", LIMITS)


@pytest.mark.parametrize("doctype", [BOMB, OUTSIDE, "<!DOCTYPE x>"])
def test_document_types_are_refused(doctype: str) -> None:
    with pytest.raises(LibraryError, match="document type or entities"):
        parse_xml(f"{doctype}<x>&a;</x>".encode(), "a.xml", LIMITS)


def test_bad_and_deep_xml_is_refused() -> None:
    with pytest.raises(LibraryError, match="no valid XML"):
        parse_xml(b"<a><b></a>", "a.xml", LIMITS)
    with pytest.raises(LibraryError, match="no valid XML"):
        parse_xml(b'<?xml version="1.0" encoding="klingon"?><a/>', "a.xml", LIMITS)
    with pytest.raises(LibraryError, match="more than 200 deep"):
        parse_xml(b"<a>" * 300 + b"</a>" * 300, "a.xml", LIMITS)
    assert parse_xml(b"<a><b/></a>", "a.xml", LIMITS).tag == "a"


@given(st.text(max_size=80))
def test_fitted_names_fit(name: str) -> None:
    assert fit_name(name, "part").replace("_", "").replace(".", "").replace("-", "").isalnum()
    assert slug(name) == slug(slug(name)) != ""
    assert len(fit_name(name, "part")) <= 60


def test_names_are_unique_whatever_their_letter_case() -> None:
    unique = Unique()
    assert [unique(n) for n in ("Door", "door", "door", "other")] == [
        "Door",
        "door_2",
        "door_3",
        "other",
    ]


def test_properties_have_comments_escapes_and_long_lines() -> None:
    text = "# note\n! note\nname#1 = Mu\\u00f1eca\nlong=a\\\n  b\nkey\\=x:1\nempty=\ncopy=\xa9\n"
    assert read_properties(text.encode("latin-1")) == {
        "name#1": "Muñeca",
        "long": "ab",
        "key=x": "1",
        "empty": "",
        "copy": "©",
    }
