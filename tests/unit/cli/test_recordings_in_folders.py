"""A folder stands for the recordings in it."""

import pytest
import typer

from agent.cli.common.recordings import in_folders


def test_a_folder_stands_for_its_recordings_by_name(tmp_path, capsys):
    for name in ("b.csv", "a.parquet", "C.CSV", "d.zip", "e.xls", "notes.txt", "README.md"):
        (tmp_path / name).touch()
    alone = tmp_path / "notes.txt"
    names = [each.name for each in in_folders([alone, tmp_path])]
    assert names == ["notes.txt", "C.CSV", "a.parquet", "b.csv", "d.zip", "e.xls"]
    assert capsys.readouterr().err == f"slipjump: {tmp_path}: not read unless you name them: notes.txt\n"


def test_a_folder_without_recordings_is_reported(tmp_path):
    with pytest.raises(typer.BadParameter, match="a folder without recordings"):
        in_folders([tmp_path])
