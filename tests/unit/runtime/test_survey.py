"""A survey from its archive to its ledger, with an executor that runs right here."""

import json
from dataclasses import replace

import numpy as np
import pyarrow.parquet as pq
import pytest

from agent.analysis.data_quality import data_quality
from agent.analysis.diagnose import diagnose
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.report.diagnosis_json import diagnosis_json
from agent.report.flat import flat, standard_columns
from agent.report.fleet.of_survey import PICTURES, survey_rows
from agent.report.fleet.rows import finding_of
from agent.report.fleet.stored_finding import finding_from, finding_json
from agent.report.fleet.thumbnail import thumbnail
from agent.runtime.survey.executor import Done
from agent.runtime.survey.ledger import Ledger, LoopKey
from agent.runtime.survey.parquet import write_parquet
from agent.runtime.survey.survey import survey
from connectors.base import ConfigError
from connectors.exports.fault import RecordingError
from connectors.recording import ReadOptions
from connectors.sources.archive import parts_of


class Here:
    """An executor without processes, which may stop."""

    def __init__(self, stop_after=None):
        self.diagnosed = []
        self._left = stop_after

    def results(self, function, tasks):
        for task in tasks:
            if function.__name__ == "survey_loop":
                if self._left == 0:
                    raise KeyboardInterrupt
                self._left = None if self._left is None else self._left - 1
                self.diagnosed.append((task.part.recording, task.loop))
            yield Done(task, function(task))


class Silent:
    def __init__(self):
        self.lines, self.progress = [], []

    def begins(self, work, total, done):
        self.progress.append([work, total, done])

    def advances(self):
        self.progress[-1][2] += 1

    def fault(self, line):
        self.lines.append(line)


def recording(path, seed=0, n=300):
    """A record of which nothing can be said, which is quick: OP is constant."""
    path.parent.mkdir(parents=True, exist_ok=True)
    pv = np.round(np.random.default_rng(seed).normal(50, 1, n), 3)
    path.write_text("time,OP,PV\n" + "".join(f"{k},40,{value}\n" for k, value in enumerate(pv)))


@pytest.fixture
def archive(tmp_path):
    folder = tmp_path / "archive"
    for k, name in enumerate(["FIC101.csv", "north/FIC102_1.csv", "north/FIC102_2.csv", "south/FIC103.csv"]):
        recording(folder / name, k)
    wide = "time,FIC1.PV,FIC1.OP,FIC2.PV,FIC2.OP,TI9.PV\n"
    wide += "".join(f"{k},{k % 7},40,{k % 5},41,3\n" for k in range(300))
    (folder / "wide.csv").write_text(wide)
    (folder / "broken.csv").write_text("nothing\n")
    (folder / "notes.txt").write_text("no recording")
    (folder / ".hidden").mkdir()
    recording(folder / ".hidden" / "X.csv")
    return folder


def run(archive, folder, executor=None, options=None):
    executor, watcher = executor or Here(), Silent()
    folder.mkdir(exist_ok=True)
    ledger = Ledger(folder / "survey.sqlite", (str(archive),))
    try:
        parts = parts_of([str(archive)], without=folder)
        summary = survey(parts, options or ReadOptions(), LoopHints(), executor, ledger, watcher)
        return summary, executor, watcher, list(ledger.rows())
    finally:
        ledger.close()


def test_every_loop_of_every_file_is_done_and_what_cannot_be_read_is_named(archive, tmp_path):
    summary, _, watcher, rows = run(archive, tmp_path / "out")
    found = [(row["recording"], row["loop"]) for row in rows]
    assert found == [
        ("FIC101.csv", "FIC101"),
        ("north/FIC102_1.csv", "FIC102_1"),
        ("north/FIC102_2.csv", "FIC102_2"),
        ("south/FIC103.csv", "FIC103"),
        ("wide.csv", "FIC1"),
        ("wide.csv", "FIC2"),
    ]
    assert [line for line in watcher.lines if "broken.csv" in line] == summary.faults == watcher.lines
    assert ["TI9" in line and "wide.csv" in line for line in summary.problems] == [True]
    assert watcher.progress == [["reading the archive", 6, 6], ["diagnosing", 6, 6]]
    assert (summary.loops, summary.resumed) == (6, 0)


def test_a_row_is_what_diagnose_prints(archive, tmp_path):
    _, _, _, rows = run(archive, tmp_path / "out")
    pv = np.round(np.random.default_rng(0).normal(50, 1, 300), 3)
    own = diagnose(LoopWindow("FIC101", 0.0, 1.0, op=np.full(300, 40.0), pv=pv))
    expected = json.loads(json.dumps(diagnosis_json(own, "FIC101.csv")))
    assert {**rows[0], "seconds": 0} == {**expected, "seconds": 0}


@pytest.mark.parametrize("stop", range(6))
def test_an_interrupted_survey_goes_on_where_it_was(archive, tmp_path, stop):
    out = tmp_path / "out"
    first = Here(stop)
    with pytest.raises(KeyboardInterrupt):
        run(archive, out, first)
    summary, second, _, rows = run(archive, out)
    assert len(first.diagnosed) == stop
    done = [*first.diagnosed, *second.diagnosed]
    assert sorted(done) == sorted(set(done)) == [(row["recording"], row["loop"]) for row in rows]
    assert summary.resumed == stop


def test_only_what_changed_is_done_again(archive, tmp_path):
    out = tmp_path / "out"
    run(archive, out)
    recording(archive / "FIC101.csv", 9, 310)
    recording(archive / "new.csv", 10)
    (archive / "south/FIC103.csv").unlink()
    _, executor, _, rows = run(archive, out)
    assert executor.diagnosed == [("FIC101.csv", "FIC101"), ("new.csv", "new")]
    assert [row["recording"] for row in rows].count("south/FIC103.csv") == 0
    assert len(rows) == 6
    _, executor, _, _ = run(archive, out, options=ReadOptions(decimal="."))
    assert len(executor.diagnosed) == 6, "other options, other results"


def test_a_worker_that_lives_on_reads_a_changed_file_anew(tmp_path):
    only = tmp_path / "only"
    recording(only / "FIC101.csv")
    _, _, _, before = run(only, tmp_path / "out")
    recording(only / "FIC101.csv", seed=1, n=350)
    _, _, _, after = run(only, tmp_path / "out")
    assert before[0]["indices"] != after[0]["indices"]


def test_a_folder_holds_one_survey(archive, tmp_path):
    run(archive, tmp_path / "out")
    with pytest.raises(ConfigError, match=r"holds the survey of .*archive: name another folder"):
        Ledger(tmp_path / "out" / "survey.sqlite", (str(tmp_path / "other"),))


def test_results_within_the_archive_are_no_recordings(archive):
    out = archive / "out"
    run(archive, out)
    recording(out / "survey.csv")
    _, executor, _, rows = run(archive, out)
    assert (executor.diagnosed, len(rows)) == ([], 6)


def test_sources_are_taken_once_and_named_apart(tmp_path):
    for folder in ("a", "b"):
        recording(tmp_path / folder / "x.csv")
    one = parts_of([str(tmp_path / "a"), str(tmp_path / "a" / "x.csv"), str(tmp_path / "*" / "x.csv")])
    assert len(one) == 2
    both = parts_of([str(tmp_path / "a"), str(tmp_path / "b")])
    assert [part.recording for part in both] == [str(tmp_path / "a/x.csv"), str(tmp_path / "b/x.csv")]
    (tmp_path / "empty").mkdir()
    for nothing in (tmp_path / "empty", tmp_path / "*.csv"):
        with pytest.raises(RecordingError, match="no recording is there"):
            parts_of([str(nothing)])
    missing = parts_of([str(tmp_path / "missing.csv")])
    assert missing[0].recording == "missing.csv", "the fault is that of reading it"


def test_the_table_has_every_key_of_diagnose_whatever_was_found(tmp_path):
    t = np.arange(600)
    wave = LoopWindow("W", 0.0, 1.0, op=50 + 5 * np.sin(t / 9), pv=20 + np.sin((t - 5) / 9))
    windows = [LoopWindow("A", 0.0, 1.0, op=np.full(300, 1.0), pv=t[:300] % 7 + 0.0), wave]
    rows = [json.loads(json.dumps(diagnosis_json(diagnose(each), f"{each.loop}.csv"))) for each in windows]
    assert write_parquet(tmp_path / "t.parquet", lambda: iter(rows)) == 2
    table = pq.read_table(tmp_path / "t.parquet")
    read = table.to_pylist()
    for row, back in zip(rows, read, strict=True):
        assert {**dict.fromkeys(back), **flat(row)} == back
    assert set(table.column_names) == set(standard_columns()), "the same columns in every survey"
    assert "stiction.s.value" in back
    assert str(table.schema.field("stiction.s.low").type) == "double"
    assert write_parquet(tmp_path / "none.parquet", lambda: iter(())) == 0
    assert pq.read_schema(tmp_path / "none.parquet") == table.schema


def test_a_finding_comes_back_as_it_was():
    t = np.arange(900)
    pv = np.where(t == 7, np.nan, t % 30 + 0.0)
    own = LoopWindow("A", 0.0, 1.0, op=np.full(900, 1.0), pv=pv)
    diagnosis = diagnose(own)
    finding = finding_of("A.csv", diagnosis, data_quality(own, diagnosis), thumbnail(own, diagnosis))
    back = finding_from(json.loads(json.dumps(finding_json(finding), allow_nan=False)))
    assert replace(back, thumbnail=None) == replace(finding, thumbnail=None)
    np.testing.assert_allclose(back.thumbnail.pv, finding.thumbnail.pv, rtol=1e-4)
    bare = replace(finding, thumbnail=None, s=None)
    assert finding_from(json.loads(json.dumps(finding_json(bare)))) == bare


def test_the_ranking_has_pictures_of_the_most_urgent_only():
    t = np.arange(300)
    own = LoopWindow("A", 0.0, 1.0, op=np.full(300, 1.0), pv=t % 30 + 0.0)
    diagnosis = diagnose(own)
    finding = finding_of("A.csv", diagnosis, data_quality(own, diagnosis), thumbnail(own, diagnosis))
    stored = finding_json(finding)
    many = [{**stored, "loop": f"L{k}", "recording": "A.csv"} for k in range(PICTURES + 5)]
    rows = survey_rows(lambda: iter(many), lambda _, loop: loop)
    assert sum(row.lead.thumbnail is not None for row in rows) == PICTURES
    together = survey_rows(lambda: iter(many), lambda *_: "one valve")
    assert [len(row.findings) for row in together] == [PICTURES + 5]


def test_the_ledger_keeps_a_loop_once(tmp_path):
    ledger = Ledger(tmp_path / "survey.sqlite", ("archive",))
    place = LoopKey("a.csv", "A", "1")
    ledger.plan([place])
    ledger.write(place, {"loop": "A", "n": 1}, {})
    ledger.write(place, {"loop": "A", "n": 2}, {})
    assert list(ledger.rows()) == [{"loop": "A", "n": 2}]
    ledger.plan([replace(place, stamp="2")])
    assert (list(ledger.rows()), ledger.done()) == ([], set())
    ledger.close()
