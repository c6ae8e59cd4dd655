"""Who is fitted next: doubt before certainty, importance, and nobody waits for ever."""

from agent.analysis.memory.outcome import OUTCOMES
from agent.analysis.memory.value_of_fit import WaitingFit, in_order, information, value_of_fit
from agent.analysis.memory.valve_memory import DAY, HALF_LIFE, ValveMemory

NOW = 1.7e9


def memory(**counts):
    return ValveMemory(until=NOW, former=tuple(float(counts.get(each, 0)) for each in OUTCOMES))


NEW, SOUND, CERTAIN, DOUBT = memory(), memory(against=20), memory(very_strong=20), memory(fair=1)


def test_a_valve_in_doubt_comes_before_one_that_is_certain():
    waiting = [WaitingFit("sound", SOUND), WaitingFit("certain", CERTAIN), WaitingFit("doubt", DOUBT)]
    assert in_order(waiting, NOW)[0] == "doubt"
    assert in_order(waiting[::-1], NOW) == in_order(waiting, NOW)


def test_information_is_never_negative_and_small_where_nothing_would_change():
    for each in (NEW, SOUND, CERTAIN, DOUBT):
        assert 0.0 <= information(each) <= 0.5
    assert information(SOUND) < 0.1 * information(NEW)
    assert information(CERTAIN) < 0.1 * information(DOUBT)


def test_importance_counts():
    waiting = [WaitingFit("a", DOUBT), WaitingFit("b", DOUBT, "critical")]
    assert in_order(waiting, NOW) == ("b", "a")


def test_nobody_waits_for_ever():
    waiting = [WaitingFit("doubt", DOUBT), WaitingFit("sound", SOUND, waits=3000 * DAY)]
    assert in_order(waiting, NOW) == ("sound", "doubt")


def test_what_is_forgotten_is_worth_a_fit_again():
    later = NOW + 12 * HALF_LIFE
    assert value_of_fit(WaitingFit("x", SOUND), later) > value_of_fit(WaitingFit("x", SOUND), NOW)
