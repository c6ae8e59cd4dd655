"""How much more likely a record is with a sticking valve: what a slip proves, and what a load does not."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats
from scipy.signal import lfilter

from agent.analysis.diagnose import with_innovations
from agent.analysis.innovations import innovations_say
from agent.analysis.innovations.noise_models import noise_models
from agent.analysis.innovations.stems import valve_of
from agent.analysis.quantify import quantifier
from agent.analysis.quantify.free_run.problem import pose
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.results import Quantification
from agent.identify.first_slip import first_slip
from agent.identify.noise.student import student_likelihood
from agent.physics.valves.he2007 import he2007

N = 600
CLEAR = 30.0
"""Nats from which a record speaks for a sticking valve (docs/methods/innovations.md)."""
NOTHING_FOUND = Quantification("free_run", None, None, None, None, 1.0, "no_stiction")


def record(*, sticks, walk=0.01, load_step=0.0, seed=0, span=1.0):
    """OP wanders up and down as a slow controller moves it; PV answers behind a lag, with a load on top."""
    rng = np.random.default_rng(seed)
    op = 50 + 8 * np.sin(2 * np.pi * np.arange(N) / 170) + 3 * np.sin(2 * np.pi * np.arange(N) / 61 + 1)
    load = walk * np.cumsum(rng.normal(size=N)) + load_step * (np.arange(N) > 400)
    stem = he2007(op, 2.0, 1.0, op[0]) if sticks else op
    pv = lfilter([0.0, 0.4], [1.0, -0.6], stem - 50 + load) + 0.1 * rng.normal(size=N)
    return LoopWindow("x", 0.0, 1.0, op=span * op, pv=span * pv)


def test_a_sticking_valve_is_seen_without_any_help():
    assert log_likelihood_ratio(record(sticks=True), NOTHING_FOUND) > 3 * CLEAR


def log_likelihood_ratio(window, found):
    return innovations_say(window, found).log_likelihood_ratio


@pytest.mark.parametrize("walk", [0.0, 0.01, 0.3])
def test_a_load_that_wanders_proves_nothing(walk):
    assert log_likelihood_ratio(record(sticks=False, walk=walk), NOTHING_FOUND) < CLEAR


def test_one_step_of_a_load_proves_nothing():
    assert log_likelihood_ratio(record(sticks=False, load_step=5.0), NOTHING_FOUND) < CLEAR


def test_a_sticking_valve_is_seen_under_a_load_that_wanders():
    assert log_likelihood_ratio(record(sticks=True, walk=0.1), NOTHING_FOUND) > CLEAR


def one_way(*, sticks, load_step=0.0):
    """OP rises only, in three ramps; a stem that sticks stands, follows, and never turns."""
    rng = np.random.default_rng(3)
    op = 50 + np.interp(np.arange(N), [0, 80, 160, 280, 360, 460, 540, N], [0, 0, 4, 4, 6, 6, 9, 9])
    stem = he2007(op, 4.0, 1.5, op[0]) if sticks else op
    assert np.all(np.diff(stem) >= 0)
    load = 0.005 * np.cumsum(rng.normal(size=N)) + load_step * (np.arange(N) > 140)
    pv = lfilter([0.0, 0.4], [1.0, -0.6], stem - 50 + load) + 0.1 * rng.normal(size=N)
    return LoopWindow("x", 0.0, 1.0, op=op, pv=pv)


def test_a_stem_that_never_turns_is_seen_by_where_it_stood():
    assert log_likelihood_ratio(one_way(sticks=True), NOTHING_FOUND) > CLEAR


@pytest.mark.parametrize("load_step", [0.0, -3.0, 3.0])
def test_op_that_never_turns_proves_nothing(load_step):
    assert log_likelihood_ratio(one_way(sticks=False, load_step=load_step), NOTHING_FOUND) < CLEAR / 3


@pytest.mark.parametrize(("f_s", "rest", "direction"), [(2.0, 0.0, 1.0), (2.0, 4.0, -1.0), (9.0, 0.0, 1.0)])
def test_a_stem_slips_first_where_op_leaves_its_band(f_s, rest, direction):
    op = np.array([1.0, 1.5, 3.0, -4.0]) if rest == 0.0 else np.array([3.0, 2.5, 1.0, 9.0])
    assert first_slip(op, 2 * f_s, rest + f_s)[1] == direction


@pytest.mark.parametrize("span", [2.0**-10, 1e3, 0.01])
def test_units_change_nothing(span):
    """By other last digits a search might end at another valve: the record has none in spans."""
    one, other = (log_likelihood_ratio(record(sticks=True, span=each), NOTHING_FOUND) for each in (1.0, span))
    assert other == pytest.approx(one, rel=1e-9)


def test_a_record_that_poses_no_problem_says_nothing():
    window = record(sticks=True)
    assert log_likelihood_ratio(replace(window, op=np.full(N, 50.0)), NOTHING_FOUND) == 0.0
    assert log_likelihood_ratio(replace(window, pv=np.full(N, math.nan)), NOTHING_FOUND) == 0.0


def test_a_record_shows_a_sticking_valve_where_op_moves_and_noise_does_not_hide_it():
    window = record(sticks=False)
    shows = innovations_say(window, NOTHING_FOUND).would_show
    assert shows > 0.8
    noise = np.random.default_rng(5).normal(size=N)
    assert innovations_say(replace(window, pv=window.pv + 40 * noise), NOTHING_FOUND).would_show < 0.2
    still = replace(window, op=50 + 0.1 * (window.op - 50), pv=0.1 * window.pv + 0.5 * noise)
    assert innovations_say(still, NOTHING_FOUND).would_show < shows


def test_without_a_range_of_op_it_is_the_least_that_it_can_be():
    window = record(sticks=False)
    unknown = replace(window, op=window.op + 500)
    span = (float(unknown.op.min()), float(unknown.op.max()))
    stated = replace(unknown, hints=LoopHints(op_range=span))
    shows = innovations_say(unknown, NOTHING_FOUND).would_show
    assert shows == innovations_say(stated, NOTHING_FOUND).would_show
    assert shows < innovations_say(window, NOTHING_FOUND).would_show


def test_the_filter_that_fits_makes_a_walk_with_noise_white():
    """Its innovations have less variance than behind any other filter, and no correlation."""
    rng = np.random.default_rng(1)
    fresh = rng.normal(size=3000)
    keep = math.exp(-1 / 2.0)
    pv = np.cumsum(fresh - keep * np.concatenate(([0.0], fresh[:-1])))
    window = LoopWindow("x", 0.0, 1.0, op=np.sin(np.arange(3000) / 9), pv=pv)
    models = noise_models(window, pose(window))
    powers = [float(np.mean(each.pv[each.weight > 0] ** 2)) for each in models]
    best = models[int(np.argmin(powers))]
    assert best.keep == pytest.approx(keep)
    assert min(powers) == pytest.approx(1.0, rel=0.1)
    white = best.pv[best.weight > 0]
    assert abs(np.corrcoef(white[1:], white[:-1])[0, 1]) < 0.06


def test_student_likelihood_is_that_of_the_distribution():
    values = 3 * np.random.default_rng(2).standard_t(4, size=400)
    _, _, scale = stats.t.fit(values, fdf=4, floc=0)
    true = stats.t.logpdf(values, 4, scale=scale).sum()
    constant = 400 * stats.t.logpdf(0.0, 4)
    assert student_likelihood(values, 0.0) + constant == pytest.approx(true, abs=0.05)


def test_the_innovations_weigh_the_valve_with_the_least_error_and_hand_it_on_to_nobody():
    window = record(sticks=True)
    found = quantifier("free_run").quantify(window)
    least = found.least_error
    seen = valve_of(window, found)
    assert seen.bands == pytest.approx((least.s / window.op_span, least.j / window.op_span))
    np.testing.assert_allclose(seen.stem, (least.mv - window.op.min()) / window.op_span)
    reported = valve_of(window, replace(found, least_error=None))
    assert reported.s == pytest.approx(found.stiction.s.value / window.op_span)
    done = with_innovations(found, window)
    assert done.least_error is None
    assert done.log_likelihood_ratio > CLEAR
