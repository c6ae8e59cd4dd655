import numpy as np
import pytest

from agent.analysis.quantify.valves.genetic_search import genetic_search
from tests.unit.quantify.test_bounded_search import bowl

START = np.array([12.0, 6.0])


@pytest.mark.parametrize(("s", "j"), [(13.0, 13.0), (12.0, 2.0), (20.0, 0.0), (20.0, 20.0), (0.0, 0.0)])
def test_it_finds_the_minimum_inside_and_on_the_bounds(s, j):
    found = genetic_search(bowl((s + j) / 2, (s - j) / 2), START, 20.0)
    np.testing.assert_allclose(found, (s, j), atol=0.1)


def test_it_leaves_a_wrong_minimum_next_to_its_start():
    def two_bowls(bands):
        return np.minimum(3.0 + bowl(9.0, 3.0)(bands), bowl(2.0, 1.0)(bands))

    np.testing.assert_allclose(genetic_search(two_bowls, START, 20.0), (3.0, 1.0), atol=0.1)


def test_it_stays_within_the_space_and_repeats_itself():
    tried = []

    def rugged(bands):
        tried.append(bands)
        return np.sin(bands @ [7.0, 3.0]) + 0.1 * bands.sum(axis=1)

    first, second = genetic_search(rugged, START, 20.0), genetic_search(rugged, START, 20.0)
    f_s, f_d = np.concatenate(tried).T
    assert ((f_d >= -1e-9) & (f_d <= f_s + 1e-9) & (f_s + f_d <= 20.0 + 1e-9)).all()
    assert first.tolist() == second.tolist()


def test_it_gives_up_where_nothing_gets_better():
    calls = []

    def nothing(bands):
        calls.append(len(bands))
        return np.full(len(bands), np.inf)

    genetic_search(nothing, START, 20.0)
    assert len(calls) == 1 + 20
