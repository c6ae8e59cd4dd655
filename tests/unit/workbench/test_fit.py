import numpy as np
import pytest
from loops import DELAY, GAIN, TAU, S, made, slack

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases import Fopdt
from agent.physics.effects.deadband import Deadband
from agent.physics.effects.load_step import LoadStepEffect
from agent.physics.effects.sinusoid import Sinusoid
from agent.physics.loop_model import LoopModel
from agent.workbench.fit import contributions, fit, fit_at, nested_fit, refit, spread_from
from agent.workbench.folds import FEWEST_BLOCKS, FOLDS, block_losses, folds_of, held_out
from agent.workbench.projection import target_of
from agent.workbench.record import bare_record
from agent.workbench.space import space_of
from simulators.draws.open_records import open_record

FOPDT = LoopModel(Fopdt())


def test_the_base_finds_its_own_numbers():
    record = bare_record(made(noise=0.01))
    fitted = fit(FOPDT, record, record.weight)
    assert fitted.values == pytest.approx([DELAY, TAU], rel=0.01)
    assert fitted.coefficients == pytest.approx([GAIN], rel=0.01)
    assert fitted.at_bound == ()


def test_a_nested_fit_finds_the_band_and_gives_the_delay_back():
    record = bare_record(slack())
    base = fit(FOPDT, record, record.weight)
    assert base.values[0] > DELAY + 0.5  # the delay that it needs to stand for the slack
    larger = nested_fit(base.values, LoopModel(Fopdt(), (Deadband(),)), record)
    assert larger.values[:3] == pytest.approx([DELAY, TAU, S], rel=0.05)
    assert larger.error < 0.1 * base.error


def test_contributions_add_up_to_the_model():
    window = made(noise=0.01)
    wave = 0.4 * np.sin(2 * np.pi * 0.011 * np.arange(len(window)))
    record = bare_record(type(window)("wave", 0.0, 1.0, window.op, window.pv + wave))
    base = fit(FOPDT, record, record.weight)
    starts = np.array([[*base.values, 0.011]])
    larger = nested_fit(base.values, LoopModel(Fopdt(), (Sinusoid(),)), record, starts)
    added = contributions(larger, record)["sinusoid"]
    assert added == pytest.approx(wave, abs=0.05)


def test_a_fit_that_does_not_see_a_step_keeps_when_and_how_high_it_was():
    window = made(noise=0.05)
    at, height = 700.0, 1.5
    pv = window.pv + height * (np.arange(len(window)) > at)
    record = bare_record(type(window)("step", 0.0, 1.0, window.op, pv))
    base = fit(FOPDT, record, record.weight)
    values = np.array([*base.values, at, 300.0, 450.0, 0.0])
    target = target_of(record, record.weight, linear=True)
    larger = refit(
        fit_at(LoopModel(Fopdt(), (LoadStepEffect(),)), record, target, values), record, record.weight
    )
    assert larger.coefficients[1] == pytest.approx(height, abs=0.1)
    blind, other = record.weight.copy(), record.weight.copy()
    blind[600:800] = 0.0
    other[100:250] = 0.0
    unseen, seen = (refit(larger, record, weight) for weight in (blind, other))
    for each in (unseen, seen):
        assert each.values[2:5] == pytest.approx(larger.values[2:5], abs=1e-6)
    assert unseen.coefficients[1:] == pytest.approx(larger.coefficients[1:], abs=1e-12)
    assert (seen.coefficients[1:] != larger.coefficients[1:]).all()
    assert (unseen.coefficients[0] != larger.coefficients[0]).all()
    missed = (record.pv - unseen.pv)[600:800]
    assert np.sqrt(np.mean(missed**2)) < 2 * 0.05


@pytest.mark.parametrize("wave", [0.0, 0.7])
def test_a_fit_that_does_not_see_the_only_bump_keeps_what_answers_to_op(wave):
    """Else the gain is of hundred millions, and a wave that the rest shows has an absurd held-out error."""
    time = np.arange(600.0)
    op = 50 + 5.0 * ((time > 100) & (time < 200))
    clean = LoopModel(Fopdt()).columns(op, np.array([3.0, 5.0]), bare_record(bumped(op, op)).facts)[:, 0]
    load = wave * np.sin(2 * np.pi * 0.0127 * time)
    pv = 1.2 * clean + load + np.random.default_rng(0).normal(0, 0.05, len(op))
    record = bare_record(bumped(op, pv))
    effects = (Sinusoid(),) if wave else ()
    model = LoopModel(Fopdt(), effects)
    target = target_of(record, record.weight, linear=True)
    known = fit_at(model, record, target, np.array([3.0, 5.0, *([0.0125] if wave else [])]))
    whole = refit(known, record, record.weight)
    blind = record.weight.copy()
    blind[80:320] = 0.0
    found = refit(whole, record, blind)
    assert found.coefficients[0] == whole.coefficients[0] == pytest.approx(1.2, abs=0.05)
    np.testing.assert_array_equal(found.values[:2], whole.values[:2])
    hidden = (record.pv - found.pv)[80:320]
    assert np.sqrt(np.mean(hidden**2)) < 0.12
    if wave:  # what the rest shows is fitted to it
        assert found.values[2] == pytest.approx(0.0127, rel=0.01)
        assert not np.array_equal(found.coefficients[1:], whole.coefficients[1:])


def bumped(op, pv):
    return LoopWindow("bump", 0.0, 1.0, op, pv)


def test_every_block_is_held_out_once_and_seen_otherwise():
    record = bare_record(made())
    base = fit(FOPDT, record, record.weight)
    folds = folds_of(record, base)
    assert folds.count >= FEWEST_BLOCKS
    hidden = np.array([folds.held_out(fold) for fold in range(FOLDS)])
    assert (hidden.sum(axis=0) == (folds.block >= 0)).all()
    assert not hidden[:, : folds.opening].any()
    for fold in range(FOLDS):
        seen = folds.seen(fold, record.weight) > 0
        assert (seen == (record.weight > 0) & ~hidden[fold]).all()
        assert seen.sum() > 0.7 * record.weight.sum()


def test_the_held_out_error_of_the_truth_is_the_noise():
    noise = 0.2
    record = bare_record(made(noise=noise, samples=1500))
    base = fit(FOPDT, record, record.weight)
    folds = folds_of(record, base)
    out = held_out(base, record, folds)
    assert out.rmse == pytest.approx(noise, rel=0.08)
    assert out.losses == pytest.approx(block_losses(record, folds, out.pv))
    assert out.values.shape == (FOLDS, 2)


@pytest.mark.parametrize("seed", [91700, 91722, 91723])
def test_so_it_is_where_one_bump_is_all_that_tests_the_loop(seed):
    """Neighbours of a held-out block say how the process answers; held out with it, nothing does."""
    bump = open_record(seed, "bump", "slow_drift")
    window = bumped(bump.op, bump.pv)
    record = bare_record(window)
    base = fit(FOPDT, record, record.weight)
    out = held_out(base, record, folds_of(record, base))
    assert out.rmse < 1.15 * np.sqrt(base.error / record.weight.sum())


def test_too_few_stretches_are_reported():
    window = made()
    pv = window.pv.copy()
    pv[200:] = np.nan
    record = bare_record(type(window)("short", 0.0, 1.0, window.op, pv))
    base = fit(FOPDT, record, record.weight)
    assert f"{FEWEST_BLOCKS} are needed" in folds_of(record, base)


def test_what_a_base_begins_from_stands_where_its_own_parameters_do_and_all_else_is_spread():
    record = bare_record(slack())
    space = space_of(LoopModel(Fopdt(), (Deadband(),)), record.facts)
    own = np.array([[2.0, 5.0], [4.0, 20.0]])
    values = space.values(spread_from(own, space))
    np.testing.assert_allclose(values[:3, :2], own[[0, 1, 0]], rtol=1e-9)
    assert np.ptp(values[:, 2]) > 0.9 * record.facts.op_span
