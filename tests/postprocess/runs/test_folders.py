import os
from pathlib import Path

import pytest

from postprocess.runs.folders import prepared_folder, require_possible_folder
from swe.errors import InputError


def test_folder_is_made_with_those_above_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for path in (tmp_path / "one" / "two", tmp_path, Path("relative")):
        assert prepared_folder(path) == path
        assert path.is_dir()


def test_trying_makes_nothing(tmp_path: Path) -> None:
    require_possible_folder(tmp_path / "one" / "two")
    assert not list(tmp_path.iterdir())


def test_file_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for path in (tmp_path / "file", tmp_path / "file" / "below"):
        with pytest.raises(
            InputError, match=f"results cannot be written to {path}: {tmp_path}/file is not a writable folder"
        ):
            prepared_folder(path)


def test_folder_that_is_read_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "access", lambda path, mode: Path(path) != tmp_path)  # as the superuser may write anyway
    with pytest.raises(
        InputError, match=f"results cannot be written to {tmp_path}/below: {tmp_path} is not a writable folder"
    ):
        prepared_folder(tmp_path / "below")


def test_folder_behind_a_link_that_leads_to_nothing_yet(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "target")
    assert prepared_folder(tmp_path / "link") == tmp_path / "link"
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "target").is_dir()


def test_folder_behind_links_that_go_round(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "other")
    (tmp_path / "other").symlink_to(tmp_path / "link")
    with pytest.raises(InputError, match=r"link cannot be made \(Too many levels .*\); choose another place"):
        prepared_folder(tmp_path / "link")
