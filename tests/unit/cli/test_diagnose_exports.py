"""`diagnose` and `compare` take a file of several loops as a historian exports it."""

import json

import pytest

from agent.cli import main
from agent.cli.diagnosing.work import longest_first
from connectors.sources import export_file
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


def run(capsys, *words):
    with pytest.raises(SystemExit) as left:
        main([*map(str, words)])
    printed = capsys.readouterr()
    return left.value.code, [json.loads(line) for line in printed.out.splitlines()], printed.err


@pytest.mark.parametrize("name", ["wide_dots.csv", "long_by_time.csv"])
def test_each_loop_of_a_file_gets_an_answer(export, capsys, name):
    code, answers, _ = run(capsys, "diagnose", export(name), "--quantifier", "lee2008", "--json")
    assert code == 0
    assert [answer["loop"] for answer in answers] == [loop.name for loop in LOOPS]
    assert {answer["recording"] for answer in answers} == {name}


def test_the_largest_is_begun_first_and_answers_keep_the_order_of_the_files(export, capsys):
    assert longest_first([100, 110, 9000, 120]) == [2, 0, 1, 3]
    files = [export(name) for name in ("plain_iso.csv", "long_by_time.csv", "units_row.csv")]
    assert longest_first([each.stat().st_size for each in files])[0] == 1
    _, answers, _ = run(capsys, "diagnose", *files, "--quantifier", "lee2008", "--json")
    names = ["plain_iso", *(loop.name for loop in LOOPS), "units_row"]
    assert [answer["loop"] for answer in answers] == names


def test_one_loop_is_picked_by_its_name(export, capsys):
    path = export("wide_slashes.csv")
    code, answers, _ = run(capsys, "diagnose", path, "--loop", "PIC202", "--quantifier", "lee2008", "--json")
    assert (code, [answer["loop"] for answer in answers]) == (0, ["PIC202"])
    code, answers, fault = run(capsys, "diagnose", path, "--loop", "PIC999", "--json")
    assert (code, answers) == (2, [])
    assert "no loop 'PIC999', it holds: FIC101, PIC202, TIC303" in fault


def test_what_is_open_is_refused_with_the_option_that_settles_it_and_the_others_are_done(export, capsys):
    good, unclear = export("plain_iso.csv"), export("day_or_month.csv")
    words = ("diagnose", unclear, good, "--quantifier", "lee2008", "--json")
    code, answers, fault = run(capsys, *words)
    assert (code, [answer["loop"] for answer in answers]) == (2, ["plain_iso"])
    assert "--date-order" in fault
    code, answers, _ = run(capsys, *words, "--date-order", "dmy")
    assert (code, len(answers)) == (0, 2)


def test_compare_says_that_a_file_holds_several_loops(export, capsys):
    code, _, fault = run(capsys, "compare", export("wide_dots.csv"), "--json")
    assert code == 2
    assert "name it by --loop" in fault


def test_replay_takes_what_the_preview_settles(export, capsys, tmp_path):
    path = export("wide_slashes.csv")
    code, _, fault = run(capsys, "replay", path)
    assert code == 2
    assert "name it by --loop" in fault
    mapping = tmp_path / "map.yaml"
    mapping.write_text("loops: {FIC9: {PV: Area1/FIC101/PV, OP: Area1/FIC101/OP}}\n")
    code, _, fault = run(capsys, "replay", path, "--mapping", mapping, "--loop", "NOPE")
    assert code == 2
    assert fault == f"slipjump: {path}: has no loop 'NOPE', it holds: FIC9\n"


def test_what_is_left_out_of_a_file_is_stated_once(tmp_path, capsys):
    path = tmp_path / "two.csv"
    rows = [f"{k},{50 + k % 7},{20 + k % 5},{30 + k % 7},{40 + k % 5},1" for k in range(120)]
    rows[40], rows[60] = "cut off", "60,oops,20,30,40,1"
    path.write_text("\n".join(["time,FIC101.OP,FIC101.PV,PIC202.OP,PIC202.PV,SPEED.X", *rows]))
    words = ("--quantifier", "lee2008", "--ts", 1, "--delay", "0.2s", "--json")
    code, answers, said = run(capsys, "diagnose", path, *words)
    assert (code, len(answers)) == (0, 2)
    assert said.count("--delay: 0.2 s of records every 1 s was taken as 1 sample") == 1
    assert said.count(f"{path}: line 42: has another number of cells, it is a gap") == 1
    assert said.count("line 62: FIC101.OP is 'oops'") == 1


def test_a_process_reads_a_file_once_and_anew_in_the_next_command(tmp_path, capsys, monkeypatch):
    read = []

    def counted(path, options):
        read.append(path)
        return read_export(path, options)

    read_export = export_file.read_export
    monkeypatch.setattr(export_file, "read_export", counted)
    monkeypatch.setattr("agent.runtime.capabilities.cores", lambda: 1)  # all in this process
    wide, other = tmp_path / "a_wide.csv", tmp_path / "b.csv"
    tags = [f"FIC{k}.{role}" for k in range(7) for role in ("OP", "PV")]
    rows = [[k, *(50 + (k + j) % 7 for j in range(len(tags)))] for k in range(120)]
    wide.write_text("\n".join(",".join(map(str, each)) for each in [["time", *tags], *rows]))
    other.write_text("time,OP,PV\n" + "\n".join(f"{k},{50 + k % 7},{k % 5}" for k in range(120)))
    words = ("diagnose", wide, other, "--quantifier", "lee2008", "--json")
    _, answers, _ = run(capsys, *words)
    assert [answer["loop"] for answer in answers] == [*(f"FIC{k}" for k in range(7)), "b"]
    assert read == [wide, other]
    wide.write_text(wide.read_text().replace("FIC6", "FIC9"))
    _, answers, _ = run(capsys, *words)
    assert [answer["loop"] for answer in answers][5:] == ["FIC5", "FIC9", "b"]
    assert read == [wide, other] * 2
