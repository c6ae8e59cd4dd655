"""`slipjump import`: what was understood, as text, as JSON, and as a mapping that is read back."""

import json

import pytest
import yaml
from typer.testing import CliRunner

from agent.cli import main
from agent.cli.commands import app
from tests.exports.corpus import CASES
from tests.exports.truth import LOOPS

CORPUS = {case.name: case for case in CASES}


@pytest.fixture
def export(tmp_path):
    def _write(name):
        path = tmp_path / name
        path.write_bytes(CORPUS[name].content)
        return path

    return _write


def preview(path, *options):
    result = CliRunner().invoke(app, ["import", str(path), "--preview", "--json", *options])
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def test_the_preview_has_the_keys_of_the_interface(export):
    found = preview(export("long_by_tag.csv"))
    assert (found["file"], found["format"], found["zone"]) == ("long_by_tag.csv", "long", "UTC")
    loop = found["loops"][0]
    assert loop["loop"] == "FIC101"
    assert loop["columns"] == {"PV": "FIC101.PV", "OP": "FIC101.OP"}
    assert (loop["ts"], loop["samples"], loop["start"]) == (5.0, 240, "2026-03-01T08:00:00Z")
    assert (loop["gaps"], loop["missing"], loop["bad"]) == (2, 3, 3)
    assert found["problems"] == []


def test_the_preview_says_how_long_and_what_is_not_there(export):
    result = CliRunner().invoke(app, ["import", str(export("excel_days.csv")), "--preview"])
    assert "20 min  2026-03-01T08:00:00Z" in result.stdout  # not a millisecond before
    assert "raw" in result.stdout
    assert "- no set point" in result.stdout
    assert "- no mode" in result.stdout


def test_a_loop_without_op_is_named(export, tmp_path):
    lines = export("wide_dots.csv").read_text().splitlines()
    cut = tmp_path / "cut.csv"
    cut.write_text("\n".join(line.rsplit(",", 2)[0] for line in lines))
    assert [loop["loop"] for loop in preview(cut)["loops"]] == ["FIC101", "PIC202"]
    assert any("TIC303" in problem and "OP" in problem for problem in preview(cut)["problems"])


def test_the_mapping_is_read_back_and_can_be_corrected(export, tmp_path):
    path = export("deltav.csv")
    target = tmp_path / "map.yaml"
    assert CliRunner().invoke(app, ["import", str(path), "-o", str(target)]).exit_code == 0
    content = yaml.safe_load(target.read_text())
    assert list(content["loops"]) == [loop.name for loop in LOOPS]
    content["loops"] = {"FLOW": content["loops"]["FIC101"]}
    target.write_text(yaml.safe_dump(content))
    assert [loop["loop"] for loop in preview(path, "--mapping", str(target))["loops"]] == ["FLOW"]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("loops: [", "line 1"),
        ("zones: UTC", "zones"),
        ("decimal: ';'", "decimal"),
        ("loops: {FIC101: {FLOW: x}}", "FLOW"),
    ],
)
def test_a_wrong_mapping_is_one_line(export, tmp_path, capsys, text, expected):
    target = tmp_path / "map.yaml"
    target.write_text(text)
    with pytest.raises(SystemExit) as left:
        main(["import", str(export("deltav.csv")), "--mapping", str(target)])
    assert left.value.code == 2
    said = capsys.readouterr().err
    assert expected in said
    assert str(target) in said
    assert said.count("\n") == 1


@pytest.mark.parametrize("case", [case for case in CASES if case.settles], ids=lambda case: case.name)
def test_the_option_that_the_message_names_exists(case, export, capsys):
    path = export(case.name)
    with pytest.raises(SystemExit):
        main(["import", str(path), "--preview"])
    assert case.names_option in capsys.readouterr().err
    value = next(iter(case.settles.values()))
    assert preview(path, case.names_option, value)["loops"][0]["samples"] == 240


def test_a_mapping_that_may_be_corrected_is_not_written_over(export):
    path = export("wide_dots.csv")
    mapping = path.with_name("wide_dots.csv.yaml")
    assert CliRunner().invoke(app, ["import", str(path)]).exit_code == 0
    mapping.write_text("zone: Europe/Berlin\n")
    assert CliRunner().invoke(app, ["import", str(path)]).exit_code == 2
    assert mapping.read_text() == "zone: Europe/Berlin\n"
    assert CliRunner().invoke(app, ["import", str(path), "--output", str(mapping)]).exit_code == 0
    assert "FIC101.PV" in mapping.read_text()


def test_what_was_taken_for_granted_is_said(export):
    assert any("--date-order dmy" in each for each in preview(export("am_pm.csv"))["problems"])
