"""Libraries of others are those that were fetched, in the wheel, and none comes from another host."""

import re
import shutil

from agent.web.app import STATIC
from agent.web.vendor import FOLDER, faults


def test_every_file_has_its_checksum():
    assert faults() == []


def test_a_changed_a_missing_and_an_unknown_file_are_found(tmp_path):
    shutil.copytree(FOLDER, tmp_path / "vendor")
    folder = tmp_path / "vendor"
    (folder / "htm.mjs").write_text("alert(1)")
    (folder / "preact.mjs").unlink()
    (folder / "left-pad.js").write_text("")
    assert [fault.split(":")[0] for fault in faults(folder)] == ["htm.mjs", "left-pad.js", "preact.mjs"]


def test_source_maps_that_are_named_are_there():
    for path in FOLDER.glob("*.mjs"):
        for name in re.findall(r"sourceMappingURL=(\S+)", path.read_text()):
            assert (FOLDER / name).is_file()


def test_no_file_of_ours_names_another_host():
    ours = [path for path in STATIC.rglob("*.*") if FOLDER not in path.parents and path.suffix != ".svg"]
    assert len(ours) > 10
    for path in ours:
        assert not re.search(r"https?://(?!127)", path.read_text()), path
