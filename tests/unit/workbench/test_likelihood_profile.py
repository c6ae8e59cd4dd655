import numpy as np
import pytest
from loops import S, made, slack

from agent.physics.bases import Fopdt
from agent.physics.effects.deadband import Deadband
from agent.physics.loop_model import LoopModel
from agent.workbench.certainty.likelihood_profile import likelihood_profile
from agent.workbench.fit import fit, nested_fit
from agent.workbench.prediction_search import predictor
from agent.workbench.record import bare_record

WITH_BAND = LoopModel(Fopdt(), (Deadband(),))


def ends_of(window):
    record = bare_record(window)
    base = fit(LoopModel(Fopdt()), record, record.weight)
    predicts, best = predictor(nested_fit(base.values, WITH_BAND, record), record)
    ends = np.tile(best, (3, 1))
    ends[1:, 2] = likelihood_profile(predicts, best, 2)
    return predicts.space.values(ends)[:, 2]


def test_it_is_about_the_truth_and_widens_with_the_noise():
    widths = []
    for noise in (0.05, 1.0):
        best, low, high = ends_of(slack(noise=noise))
        assert low - 0.05 * S <= S <= high
        assert low <= best <= high
        widths.append(high - low)
    assert widths[0] < 0.05 * S
    assert widths[1] > 2 * widths[0]


def test_it_ends_at_nothing_where_there_is_nothing():
    _, low, high = ends_of(made(noise=0.5))
    assert low == pytest.approx(0.0)
    assert high < 1.0
