"""Each page's commands run as printed and print what the page shows."""

import os

import pytest

from tests.conftest import ROOT
from tests.docs.page import LIMIT, blocks, run, same_line, same_output, shim

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
BLOCKS = {path.relative_to(ROOT).as_posix(): blocks(path.read_text(encoding="utf-8")) for path in PAGES}
RUNNABLE = {
    name: [block for block in page if block.kind == "console" and block.not_run is None]
    for name, page in BLOCKS.items()
}


@pytest.mark.parametrize("page", BLOCKS)
def test_each_block_with_a_command_is_run_or_says_why_not(page):
    wrong = [
        f"{page}:{block.line}"
        for block in BLOCKS[page]
        if block.shows_a_command and block.not_run is None and (block.kind != "console" or not block.commands)
    ]
    assert wrong == [], (
        "write ```console with $ before each command, or <!-- not run: reason --> before the block"
    )
    assert [block.line for block in BLOCKS[page] if block.not_run == ""] == []


def executed(page, recordings, folder, *, long):
    """Run the blocks of a page in order, in a folder of their own; the long ones too if asked for."""
    (folder / "config").symlink_to(ROOT / "config")
    programs = folder / ".bin"
    programs.mkdir()
    environment = os.environ | {"SLIPJUMP_DATA": str(recordings), "PYTHONPATH": str(ROOT), "COLUMNS": "200"}
    environment["SLIPJUMP_SESSIONS"] = str(programs / "sessions")
    environment["PATH"] = f"{shim(programs)}:{environment['PATH']}"
    wrong = [
        each for block in RUNNABLE[page] if long or not block.long for each in run(block, folder, environment)
    ]
    assert not wrong, "\n\n".join(wrong)


@pytest.mark.slow
@pytest.mark.timeout(LIMIT)
@pytest.mark.parametrize(
    "page", [name for name, found in RUNNABLE.items() if any(not each.long for each in found)]
)
def test_commands_of_a_page_run_as_printed(page, recordings, tmp_path):
    executed(page, recordings, tmp_path, long=False)


@pytest.mark.bench
@pytest.mark.timeout(2 * LIMIT)
@pytest.mark.parametrize(
    "page", [name for name, found in RUNNABLE.items() if any(each.long for each in found)]
)
def test_commands_that_take_long_run_as_printed(page, recordings, tmp_path):
    executed(page, recordings, tmp_path, long=True)


def test_newcomers_pages_have_commands_that_are_run():
    assert RUNNABLE["README.md"]
    assert len(RUNNABLE["docs/tutorial.md"]) >= 4


def test_output_is_compared_but_for_what_is_marked():
    assert same_line("S = 6.583 OP units, ...", "  S = 6.6 OP units, 90 % interval", 0.01)
    assert not same_line("S = 6.583 OP units, ...", "S = 6.7 OP units, 90 % interval", 0.01)
    assert not same_line("S = 6.583 OP units", "J = 6.583 OP units", 0.5)
    assert same_output(["a", "...", "d"], ["a", "b", "c", "d"], 0.0)
    assert not same_output(["a", "...", "d"], ["a", "b", "c"], 0.0)
    assert not same_output(["a"], ["a", "b"], 0.0)


def test_marks_belong_to_the_next_block_only():
    page = "<!-- long --> <!-- exit code 2 -->\n\n```console\n$ slipjump check x\nbad\n```\n\ntext\n"
    page += "\n    slipjump run y\n"
    first, second = blocks(page)
    assert (first.long, first.exit_code, first.commands) == (True, 2, [("slipjump check x", "bad")])
    assert (second.long, second.exit_code, second.shows_a_command) == (False, 0, True)
