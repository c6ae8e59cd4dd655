"""Who is fitted next: doubt before certainty, importance, and nobody waits for ever."""

from agent.analysis.memory.outcome import OUTCOMES
from agent.analysis.memory.value_of_fit import information, worth_of_fit
from agent.analysis.memory.valve_memory import DAY, HALF_LIFE, ValveMemory

NOW = 1.7e9


def memory(**counts):
    return ValveMemory(until=NOW, former=tuple(float(counts.get(each, 0)) for each in OUTCOMES))


def worth(known, priority="medium", waits=0.0, now=NOW):
    return worth_of_fit(known, priority, waits, now)


NEW, SOUND, CERTAIN, DOUBT = memory(), memory(against=20), memory(very_strong=20), memory(fair=1)


def test_a_valve_in_doubt_comes_before_one_that_is_certain():
    assert worth(DOUBT) > max(worth(SOUND), worth(CERTAIN))
    assert worth(NEW) == 1.0


def test_information_is_never_negative_and_small_where_nothing_would_change():
    for each in (NEW, SOUND, CERTAIN, DOUBT):
        assert 0.0 <= information(each) <= 0.5
    assert information(SOUND) < 0.1 * information(NEW)
    assert information(CERTAIN) < 0.1 * information(DOUBT)


def test_importance_counts():
    assert worth(DOUBT, "critical") > worth(DOUBT)


def test_nobody_waits_for_ever():
    assert worth(SOUND, waits=3000 * DAY) > worth(DOUBT)


def test_what_is_forgotten_is_worth_a_fit_again():
    assert worth(SOUND, now=NOW + 12 * HALF_LIFE) > worth(SOUND)
