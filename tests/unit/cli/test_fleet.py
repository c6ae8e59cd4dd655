"""Many recordings as one list of valves: ranking, one answer a valve, and its files."""

import csv
import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import typer

from agent.analysis.data_quality import data_quality
from agent.analysis.diagnosis import Diagnosis, RecordSummary
from agent.analysis.record.interesting_stretch import LEAST, interesting_stretch
from agent.analysis.record.recording import LoopWindow
from agent.analysis.response.no_response import NoResponse
from agent.analysis.results import CauseShare, IntervalEstimate, Oscillation, Quantification, StictionEstimate
from agent.cli.common.pictures import picture_files
from agent.cli.diagnosing.answer import Answer, Task, printed_of
from agent.cli.diagnosing.fleet import Fleet
from agent.report.fleet.page import fleet_html
from agent.report.fleet.quality_words import quality_words, record_instead
from agent.report.fleet.rows import finding_of, valve_rows
from agent.report.fleet.table import fleet_csv, fleet_lines
from agent.report.fleet.thumbnail import PIECES, thumbnail
from agent.units import FrictionBands
from connectors.recording import Columns

T = np.arange(1200)
WAVE = np.sin(2 * np.pi * T / 60)
EVIL = "<script>alert(1)</script>"


def window(loop, ts=1.0):
    return LoopWindow(loop, 0.0, ts, op=50 + 5 * WAVE, pv=20 + np.roll(WAVE, 5))


def diagnosis(loop, verdict="stiction", s=2.0, confidence=0.9, **other):
    bands = StictionEstimate.of(FrictionBands(0.75 * s, 0.25 * s))
    bands = replace(bands, s=IntervalEstimate(s, 0.9 * s, 1.1 * s))
    found = Quantification("free_run", bands, None, 91.2, 60.0, 16.0, "stiction")
    cause = "stiction" if verdict == "stiction" else "undecided"
    sure = confidence if verdict in ("stiction", "no_stiction") else 0.0
    cls = "stick_slip" if verdict == "stiction" else None
    oscillation = Oscillation(detected=True, period=60.0, regularity=9.0)
    record = RecordSummary.of(window(loop), oscillation)
    shares = (CauseShare(cause, 1.0),)
    return Diagnosis(loop, verdict, sure, cause, shares, cls, oscillation, found, record=record, **other)


def finding(loop, *args, **options):
    found = diagnosis(loop, *args, **options)
    own = window(loop)
    return finding_of(f"{loop}.csv", found, data_quality(own, found), thumbnail(own, found))


def rows(*findings, valve=None):
    valve = list(range(len(findings))) if valve is None else valve
    return valve_rows(findings, valve, [each.loop for each in findings])


def test_the_most_urgent_comes_first():
    found = rows(
        finding("sound", "no_stiction"),
        finding("open", "undecided"),
        finding("small", s=1.0),
        finding("large", s=3.0),
        finding("poor", "not_testable"),
    )
    assert [each.name for each in found] == ["large", "small", "open", "poor", "sound"]
    lines = list(fleet_lines(found))
    assert lines[0] == "5 valves, 5 recordings, the most urgent first"
    assert "3 (2.7 to 3.3)" in lines[2]


def test_two_valves_of_one_name_have_their_files_behind_it():
    same = [replace(finding("FIC101", s=s), recording=f"{s}.csv") for s in (3.0, 2.0)]
    assert [each.name for each in rows(*same, finding("FIC102", "no_stiction"))] == [
        "FIC101 (3.0.csv)",
        "FIC101 (2.0.csv)",
        "FIC102",
    ]


@pytest.mark.parametrize("width", [80, 100, 200, None])
def test_the_table_is_no_wider_than_the_terminal(width):
    found = rows(finding("FIC101"), finding("FIC102", "no_stiction"), finding("FIC103", "not_testable"))
    table = list(fleet_lines(found, width))
    assert all(len(line) <= (width or 999) for line in table)
    assert any("bump test" in line for line in table)


@pytest.mark.parametrize(
    ("verdicts", "group", "lead"),
    [
        (("stiction", "stiction", "no_stiction"), "sticks", "v1"),
        (("no_stiction", "undecided", "no_stiction"), "healthy", "v2"),
        (("stiction", "no_stiction"), "suspected", "v0"),
        (("undecided", "not_testable"), "suspected", "v0"),
        (("not_testable", "not_testable"), "not_testable", "v0"),
    ],
)
def test_a_valve_has_one_answer_by_majority(verdicts, group, lead):
    own = [finding(f"v{k}", verdict, confidence=0.8 + k / 100) for k, verdict in enumerate(verdicts)]
    (row,) = rows(*own, valve=[0] * len(own))
    assert (row.group, row.lead.loop, len(row.findings)) == (group, lead, len(own))


def test_the_page_escapes_names_and_loads_nothing():
    page = fleet_html(rows(finding(EVIL), finding("open", "undecided")), f"plant {EVIL}")
    assert EVIL not in page
    assert "&lt;script&gt;" in page
    assert "http" not in page
    assert page.count("<svg") >= 5  # shapes, bars and pictures
    assert page.index("Sticks") < page.index("Suspected")


def test_csv_has_every_number_and_no_formula():
    found = rows(finding("=cmd()"), finding("FIC102", "no_stiction"))
    first, second = csv.DictReader(io.StringIO(fleet_csv(found)))
    assert (first["valve"], first["s"], first["s_low"]) == ("'=cmd()", "2.0", "1.8")
    assert (second["valve"], second["s"], second["verdict"]) == ("FIC102", "", "No stiction")


def test_a_poor_record_says_what_to_record_instead():
    oscillation = Oscillation(detected=True, period=60.0, regularity=9.0)
    coarse = LoopWindow("coarse", 0.0, 10.0, op=window("x").op[::10], pv=window("x").pv[::10])
    found = replace(diagnosis("coarse", "not_testable"), record=RecordSummary.of(coarse, oscillation))
    quality = data_quality(coarse, found)
    assert quality.flaws == ("coarse",)
    assert quality_words(quality) == "only 6.0 samples a period"
    words = record_instead(quality)
    assert (
        words == "record a sample every 1.2 s, raw values without compression or means, for at least 15 min"
    )
    good = data_quality(window("x"), diagnosis("x"))
    assert (good.flaws, record_instead(good), quality_words(good)) == ((), None, "good")


def test_a_day_is_shown_where_the_loop_moves():
    n = 86400
    op = 50 + 0.01 * np.random.default_rng(0).standard_normal(n)
    busy = slice(60000, 60600)
    op[busy] += 5 * np.sign(np.sin(2 * np.pi * np.arange(600) / 60))
    day = LoopWindow("day", 0.0, 1.0, op=op, pv=op.copy())
    shown = interesting_stretch(day, 60.0)
    assert shown.stop - shown.start == max(LEAST, 900)
    assert shown.start <= 60030
    assert shown.stop >= 60570
    assert interesting_stretch(window("short"), 60.0) == slice(0, 1200)
    small = thumbnail(day, diagnosis("day"))
    assert len(small.op) == 2 * PIECES
    assert np.ptp(small.op) > 9  # no stroke is lost
    assert (small.start, small.end) == (shown.start, shown.stop)


def test_no_two_recordings_share_a_picture(tmp_path):
    names = ["a/X.csv", "b/X.csv", "c/X_2.csv", "d/X-contour.csv", "e/x.csv"]
    files = picture_files([Path(name) for name in names], tmp_path)
    stems = [
        f"{file.stem}{suffix}".lower()
        for file in files
        for suffix in ("", "-contour", "-profile", "-detectors")
    ]
    assert len(stems) == len(set(stems))
    assert files[0].name == "X.png"


def fleet(tmp_path, name):
    return Fleet([tmp_path / "FIC101_1.csv", tmp_path / "FIC101_2.csv"], [0, 0], tmp_path / name)


def test_where_pv_does_not_respond_the_range_of_op_is_no_estimate_of_s():
    stands = NoResponse("unknown", 0, 600, 50.0, 9.0, 0.09, 3.0, 90.0, 0.95)
    assert finding("FIC101", "undecided").s is not None
    assert finding("FIC101", "undecided", no_response=stands).s is None
    assert finding("FIC101", "stiction", no_response=stands).s is not None


@pytest.mark.parametrize("name", ["plant.html", "plant.csv", "plant.pdf"])
def test_the_report_is_written_in_each_format(tmp_path, name):
    own = fleet(tmp_path, name)
    for place in (0, 1):
        loop = f"FIC101_{place + 1}"
        found = diagnosis(loop)
        task = Task(tmp_path / f"{loop}.csv", Columns(), window(loop).hints, None, None)
        quality, small = data_quality(window(loop), found), thumbnail(window(loop), found)
        own.add(place, Answer(task, printed_of(task, found, quality, small)))
    assert own.write()
    assert (tmp_path / name).stat().st_size > 500
    assert [row.name for row in own.rows()] == ["FIC101"]
    assert "FIC101" in list(own.table())[3]


@pytest.mark.parametrize("name", ["plant.html", "plant.pdf"])
def test_the_report_lists_what_could_not_be_read(tmp_path, name):
    found = diagnosis("FIC101_1")
    task = Task(tmp_path / "FIC101_1.csv", Columns(), window("FIC101_1").hints, None, None)
    read = Answer(task, printed_of(task, found, data_quality(window("FIC101_1"), found), None))
    refused = Answer(
        replace(task, path=tmp_path / "FIC101_2.csv"), None, ("FIC101_2.csv, line 2: no <number>",)
    )
    own = fleet(tmp_path, name)
    for place, answer in enumerate((read, refused)):
        own.add(place, answer)
    assert own.write()
    content = (tmp_path / name).read_bytes()
    if name.endswith(".pdf"):
        assert content.count(b"/Type /Page ") == 2
    else:
        assert b"FIC101_2.csv, line 2: no &lt;number&gt;" in content
        assert b"1 valve, 1 recording: sticks 1." in content


def test_a_report_of_another_kind_or_over_a_recording_is_refused(tmp_path, capsys):
    with pytest.raises(typer.BadParameter, match=r"expected a name that ends with \.html, \.pdf, \.csv"):
        fleet(tmp_path, "plant.docx")
    with pytest.raises(typer.BadParameter, match="is one of the recordings"):
        fleet(tmp_path, "FIC101_1.csv")
    assert not fleet(tmp_path, "plant.html").write()
    assert "no recording could be read" in capsys.readouterr().err


def test_why_a_valve_is_sound_is_nothing_of_its_data():
    found = diagnosis("FIC103", verdict="no_stiction")
    quiet = Oscillation(detected=False, period=None, regularity=None)
    found = replace(found, record=replace(found.record, manual=20, gaps=2), oscillation=quiet)
    own = finding_of("a.csv", found, data_quality(window("FIC103"), found))
    assert own.reason == "the loop shows no regular oscillation"
