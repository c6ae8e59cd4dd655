"""Verdicts from held-out errors of blocks, where the truth is known."""

import numpy as np
import pytest
from scipy import stats

from agent.workbench.decision import judge
from agent.workbench.paired_blocks import reduction, sign_flip_p, stretches
from agent.workbench.residual.holm import holm

BLOCKS = 24
FAMILIES = {
    "deadband": "valve_hysteresis",
    "stiction": "valve_hysteresis",
    "sinusoid": "disturbance",
    "load_step": "disturbance",
    "decoy": "decoy",
}


def base_losses(rng, blocks=BLOCKS):
    return rng.gamma(4.0, 1.0, blocks)


def less(rng, losses, percent, scatter=0.1):
    """Losses of a model that makes ``percent`` less error, each block by its own luck."""
    return losses * (1 - percent / 100) * np.exp(scatter * rng.normal(size=len(losses)))


def judged(losses_base, losses, **options):
    return judge(losses_base, losses, FAMILIES, **options)


def test_holm_by_hand():
    np.testing.assert_allclose(holm(np.array([0.01, 0.04, 0.03, 0.005])), [0.03, 0.06, 0.06, 0.02])
    np.testing.assert_allclose(holm(np.array([0.6, 0.5])), [1.0, 1.0])
    assert holm(np.empty(0)).size == 0


def test_stretches_hold_every_block_once():
    assert stretches(np.ones(10)).tolist() == [1.0] * 10
    assert stretches(np.ones(40)).sum() == 40
    assert len(stretches(np.ones(40))) == 14


def test_sign_flips_are_those_of_scipy():
    rng = np.random.default_rng(3)
    base, other = rng.gamma(4.0, 1.0, (2, 10))
    exact = stats.permutation_test(
        (base - other,), np.mean, permutation_type="samples", alternative="greater", n_resamples=np.inf
    )
    assert sign_flip_p(base, other) == pytest.approx(exact.pvalue)


def test_an_effect_with_which_the_record_is_likelier_is_not_reported_from_the_best():
    """The best of the free run may be the one that hides more of OP's answer to the load."""
    rng = np.random.default_rng(4)
    base = base_losses(rng)
    losses = {"deadband": less(rng, base, 60), "stiction": less(rng, base, 75)}
    assert judged(base, losses).effect == "stiction"
    assert judged(base, losses, likelier={"deadband": 90.0, "stiction": 120.0}).effect == "stiction"
    found = judged(base, losses, likelier={"deadband": 120.0, "stiction": 90.0})
    assert (found.kind, found.effect, found.indistinguishable) == ("family", "deadband", ("stiction",))


@pytest.mark.parametrize(
    ("ahead", "kind", "effect"),
    [(7.0, "confirmed", "deadband"), (5.0, "suggested", "deadband"), (-5.0, "suggested", "decoy")],
)
def test_the_likelier_is_named_and_another_family_about_as_likely_beside_it(ahead, kind, effect):
    rng = np.random.default_rng(4)
    base = base_losses(rng)
    losses = {"deadband": less(rng, base, 75), "decoy": less(rng, base, 20)}
    likelier = {"deadband": 90.0, "decoy": 90.0 - ahead}
    found = judged(base, losses, likelier=likelier, comparable=("deadband", "decoy"))
    assert (found.kind, found.effect) == (kind, effect)
    other = "decoy" if effect == "deadband" else "deadband"
    assert found.rivals == found.indistinguishable == (() if kind == "confirmed" else (other,))
    objections = {"decoy": "it stands for another"}
    rejected = judged(
        base, losses, likelier=likelier, comparable=("deadband", "decoy"), objections=objections
    )
    assert rejected.kind == "confirmed"


def test_what_makes_the_error_larger_is_no_rival_however_likely():
    base = base_losses(np.random.default_rng(4))
    losses = {"deadband": less(np.random.default_rng(5), base, 60), "decoy": 1.5 * base}
    likelier = {"deadband": 90.0, "decoy": 89.0}
    assert judged(base, losses, likelier=likelier, comparable=tuple(losses)).kind == "confirmed"


def test_of_two_alike_the_far_likelier_is_named():
    base = base_losses(np.random.default_rng(4))
    best = less(np.random.default_rng(5), base, 60)
    losses = {"deadband": less(np.random.default_rng(6), best, 0, 0.02), "stiction": best}
    for ahead, named in ((9.0, "deadband"), (11.0, "stiction")):
        found = judged(base, losses, likelier={"deadband": 90.0, "stiction": 90.0 + ahead})
        other = ({"deadband", "stiction"} - {named}).pop()
        assert (found.kind, found.effect, found.indistinguishable) == ("family", named, (other,))


def test_an_interval_that_holds_zero_confirms_nothing_but_with_what_the_innovations_show():
    """Few blocks of a load that wanders scatter more than what an effect does in them."""
    base = np.ones(14)
    losses = {"stiction": np.where(np.arange(14) < 2, 0.2, 1.02)}
    found = judged(base, losses)
    assert found.candidates[0].low <= 0
    assert found.kind == "none"
    assert judged(base, losses, by_chance={"stiction": 1e-6}).kind == "confirmed"
    event = {"load_step": losses["stiction"]}
    assert judged(base, event, seen={"load_step"}).kind == "none"
    found = judged(base, event, seen={"load_step"}, by_chance={"load_step": 1e-6})
    assert (found.kind, found.effect) == ("confirmed", "load_step")
    small = {"stiction": np.where(np.arange(14) < 2, 0.8, 1.0)}
    assert judged(base, small, by_chance={"stiction": 1e-6}).kind == "none"  # of 3 % of the error


def test_what_hardly_lowers_the_error_is_not_as_good_as_what_surely_does():
    base = np.ones(14)
    losses = {"sinusoid": np.full(14, 0.2), "stiction": np.where(np.arange(14) < 2, 0.0, 1.02)}
    found = judged(base, losses, by_chance={"stiction": 1e-6, "sinusoid": 1e-6})
    assert (found.kind, found.effect, found.indistinguishable) == ("confirmed", "sinusoid", ())


def test_models_that_are_alike_have_p_one_and_no_reduction():
    base = base_losses(np.random.default_rng(0))
    assert sign_flip_p(base, base) == 1.0
    found = reduction(base, base, np.random.default_rng(0))
    assert (found.percent, found.low, found.high) == (0.0, 0.0, 0.0)


def test_a_clear_effect_is_confirmed_and_named():
    rng = np.random.default_rng(1)
    base = base_losses(rng)
    losses = {"deadband": less(rng, base, 40), "stiction": less(rng, base, 60), "decoy": less(rng, base, 0)}
    found = judged(base, losses)
    assert (found.kind, found.effect, found.family) == ("confirmed", "stiction", "valve_hysteresis")
    assert found.indistinguishable == found.rivals == ()
    assert [each.effect for each in found.candidates] == ["stiction", "deadband", "decoy"]
    best = found.candidates[0]
    assert best.low < best.error_reduction_percent < best.high
    assert best.error_reduction_percent == pytest.approx(60, abs=4)


def test_members_of_one_family_that_do_as_well_leave_the_simplest_and_the_subtype_open():
    rng = np.random.default_rng(2)
    base = base_losses(rng)
    best = less(rng, base, 60)
    losses = {"deadband": less(rng, best, 0, 0.02), "stiction": best, "sinusoid": less(rng, base, 10)}
    found = judged(base, losses)
    assert (found.kind, found.effect) == ("family", "deadband")
    assert found.indistinguishable == ("stiction",)


def test_a_rival_of_another_family_keeps_it_a_suggestion():
    rng = np.random.default_rng(2)
    base = base_losses(rng)
    best = less(rng, base, 60)
    found = judged(base, {"stiction": best, "sinusoid": less(rng, best, -1, 0.02)})
    assert (found.kind, found.effect, found.family) == ("suggested", "stiction", "valve_hysteresis")
    assert found.rivals == found.indistinguishable == ("sinusoid",)


def test_the_signs_of_blocks_that_are_not_blind_do_not_count():
    rng = np.random.default_rng(1)
    base = base_losses(rng)
    losses = {"load_step": less(rng, base, 60), "decoy": less(rng, base, 0)}
    families = {"load_step": "disturbance", "decoy": "decoy"}
    assert judge(base, losses, families).kind == "confirmed"
    seen = ["load_step"]
    assert judge(base, losses, families, seen=seen).kind == "none"
    assert judge(base, losses, families, seen=seen, by_chance={"load_step": 0.1}).kind == "suggested"
    assert judge(base, losses, families, seen=seen, by_chance={"load_step": 1e-6}).kind == "confirmed"


def test_a_parameter_at_a_bound_is_no_confirmation():
    rng = np.random.default_rng(1)
    base = base_losses(rng)
    losses = {"deadband": less(rng, base, 60), "decoy": less(rng, base, 0)}
    assert judged(base, losses).kind == "confirmed"
    found = judged(base, losses, at_bound=["deadband"])
    assert (found.kind, found.effect) == ("suggested", "deadband")


def test_of_two_alike_the_one_inside_its_bounds_is_named():
    rng = np.random.default_rng(2)
    base = base_losses(rng)
    best = less(rng, base, 60)
    losses = {"deadband": less(rng, best, -1, 0.02), "stiction": best}
    found = judged(base, losses, at_bound=["stiction"])
    assert (found.kind, found.effect, found.indistinguishable) == ("family", "deadband", ("stiction",))
    found = judged(base, losses, at_bound=["deadband"])
    assert (found.kind, found.effect, found.indistinguishable) == ("family", "stiction", ("deadband",))


def test_an_effect_too_small_to_matter_is_none():
    rng = np.random.default_rng(4)
    base = base_losses(rng)
    found = judged(base, {"stiction": 0.97 * base})
    assert found.candidates[0].p < 0.001
    assert (found.kind, found.effect, found.family) == ("none", None, None)


def test_what_holm_fails_alone_is_suggested():
    base = np.ones(5)
    losses = {"stiction": 0.8 * base, "sinusoid": base, "decoy": base}
    found = judged(base, losses)  # p of five blocks is 1/32 at least, times three candidates
    assert found.candidates[0].p == pytest.approx(3 / 32)
    assert (found.kind, found.effect) == ("suggested", "stiction")


def test_chance_must_exclude_an_event():
    rng = np.random.default_rng(5)
    base = base_losses(rng)
    losses = {"sinusoid": less(rng, base, 60)}
    assert judged(base, losses, input_p={"sinusoid": 0.005}).kind == "confirmed"
    found = judged(base, losses, input_p={"sinusoid": 0.3})
    assert found.candidates[0].p == 0.3
    assert found.kind == "suggested"


def test_what_few_blocks_show_plainly_may_be_reported_by_the_innovations():
    """Four of fourteen blocks: their signs alone have p of at least 1/16."""
    base = np.ones(BLOCKS)
    losses = {"stiction": base.copy(), "sinusoid": base.copy()}
    losses["stiction"][::7] = 0.1
    assert judged(base, losses).kind == "suggested"
    assert judged(base, losses, by_chance={"stiction": 1e-6}).kind == "confirmed"
    rejected = judged(base, losses, by_chance={"stiction": 1e-6}, objections={"stiction": "a reason"})
    assert rejected.kind != "confirmed"


def test_a_block_without_an_error_counts_for_no_model():
    rng = np.random.default_rng(6)
    base = base_losses(rng)
    losses = {"stiction": less(rng, base, 50), "decoy": base.copy()}
    losses["decoy"][3] = np.nan
    kept = np.delete(np.arange(BLOCKS), 3)
    assert judged(base, losses) == judged(base[kept], {name: each[kept] for name, each in losses.items()})


def test_no_candidates_is_none():
    assert judged(np.ones(12), {}).kind == "none"


def test_decoys_are_hardly_ever_confirmed():
    """Ten that gain nothing in blocks whose luck is shared with their neighbours'."""
    confirmed = 0
    for seed in range(100):
        rng = np.random.default_rng(seed)
        base = base_losses(rng, 30)
        luck = 0.3 * (rng.normal(size=(10, 31))[:, 1:] + rng.normal(size=(10, 31))[:, :-1])
        losses = {f"decoy {k}": base * np.exp(each) for k, each in enumerate(luck)}
        found = judge(base, losses, dict.fromkeys(losses, "decoy"))
        confirmed += found.kind in ("confirmed", "family")
    assert confirmed <= 1


def test_the_interval_of_a_reduction_holds_the_truth():
    held, runs, scatter = 0, 200, 0.3
    true = 100 * (1 - 0.6 * np.exp(scatter**2 / 2))
    for seed in range(runs):
        rng = np.random.default_rng(seed)
        base = base_losses(rng)
        found = reduction(base, less(rng, base, 40, scatter), rng)
        held += found.low <= true <= found.high
    assert 0.82 * runs <= held <= 0.97 * runs
