from dataclasses import replace

import numpy as np
import pytest

from benchmarks.cases.case import Case, shape_of
from benchmarks.cases.case_file import append_cases, read_cases
from benchmarks.simulated import jobs, left_of
from benchmarks.tables.strata import STRATA
from benchmarks.tables.targets import targets

CASE = Case(
    kind="stiction",
    seed=1000,
    method="free_run",
    law="lugre",
    process="first order",
    shape="both",
    noise_percent=10.0,
    quantised=True,
    op_span=20.0,
    true_f_s=3.0,
    true_f_d=1.0,
    verdict="stiction",
    evidence=4.5,
    failure=None,
    cpu_seconds=0.4,
    identifiable_s=True,
    identifiable_j=True,
    f_s=3.0,
    f_s_low=2.9,
    f_s_high=3.1,
    f_d=1.1,
    f_d_low=1.0,
    f_d_high=1.2,
    s=4.1,
    s_low=4.0,
    s_high=4.2,
    j=1.9,
    j_low=1.7,
    j_high=1.95,
)
NOTHING = {f"{amount}{end}": None for amount in ("f_s", "f_d", "s", "j") for end in ("", "_low", "_high")}
SOUND = replace(
    CASE,
    **NOTHING,
    kind="drift",
    law="none",
    shape="none",
    true_f_s=0.0,
    true_f_d=0.0,
    verdict="no_stiction",
    evidence=None,
    identifiable_s=None,
    identifiable_j=None,
)


def test_errors_widths_and_coverage_are_in_percent_of_the_op_span():
    assert CASE.error("s") == pytest.approx(0.5)
    assert CASE.error("j") == pytest.approx(0.5)
    assert CASE.width("s") == pytest.approx(1.0)
    assert CASE.covers("s")
    assert not CASE.covers("j")
    assert SOUND.error("s") == np.inf
    assert not SOUND.has_interval("s")


@pytest.mark.parametrize(
    ("f_s", "f_d", "shape"),
    [(0, 0, "none"), (1, 1, "dead band"), (3, 1, "both"), (1, 0.02, "stick-slip")],
)
def test_a_valve_counts_to_the_shape_of_its_j_over_s(f_s, f_d, shape):
    assert shape_of(f_s, f_d) == shape


def test_a_file_gives_back_what_was_written_in_two_goes(tmp_path):
    file = tmp_path / "cases.csv"
    assert read_cases(file) == []
    failed = replace(SOUND, seed=1001, verdict="undecided", failure='OP, "so it seems", does not move')
    append_cases(file, [CASE])
    append_cases(file, [SOUND, failed])
    assert read_cases(file) == [CASE, SOUND, failed]


def test_a_file_of_another_version_is_refused(tmp_path):
    file = tmp_path / "cases.csv"
    file.write_text("kind,seed\nstiction,1000\n")
    with pytest.raises(ValueError, match="another file"):
        read_cases(file)


def test_a_run_that_was_stopped_does_what_is_left():
    wanted = jobs(40)
    done = [
        replace(CASE, kind=job.kind, seed=job.seed, method=each) for job in wanted for each in job.methods
    ]
    assert left_of(wanted, []) == wanted
    assert left_of(wanted, done) == []
    (left,) = left_of(wanted, done[1:])
    assert (left.seed, left.methods) == (wanted[0].seed, wanted[0].methods[:1])


def test_each_sticking_loop_is_in_one_stratum_of_each_kind():
    belongs = {name for name, holds in STRATA.items() if holds(CASE)}
    assert belongs == {"all", "noise <= 15 %", "both", "first order", "lugre", "PV quantised"}


def holding(cases):
    """The table's word for each target."""
    rows = [line.split(" | ") for line in targets(cases, "free_run").splitlines() if line.startswith("| ")]
    return {row[0].removeprefix("| "): row[-1].removesuffix(" |") for row in rows[2:]}


def test_targets_hold_where_the_errors_are_small_and_intervals_hold_the_truth():
    good = replace(CASE, j_high=2.1)
    cases = [*[good] * 9, replace(good, s_low=4.05, j_high=1.95), SOUND]
    words = holding(cases)
    assert {name for name, word in words.items() if word == "not measured"} == {
        "intervals of S that hold the truth, not identifiable, %",
        "intervals of J that hold the truth, not identifiable, %",
    }
    assert set(words.values()) == {"yes", "not measured"}


def test_each_target_can_fail():
    bad = replace(CASE, s=9.0, j=8.0, s_low=8.0, s_high=9.5, j_low=7.0, j_high=9.0)
    unknown = replace(bad, identifiable_s=False, identifiable_j=False)
    accused = replace(SOUND, verdict="stiction")
    words = holding([bad, unknown, accused])
    assert set(words.values()) == {"**no**"}


def test_loops_with_more_noise_and_missing_numbers_count_as_they_should():
    noisy = replace(CASE, noise_percent=20.0, s=9.0)
    silent = replace(CASE, **NOTHING, identifiable_s=None, identifiable_j=None)
    assert holding([CASE, noisy])["error of S, % of OP span, median"] == "yes"
    assert holding([CASE, silent])["error of S, % of OP span, 90th percentile"] == "**no**"
