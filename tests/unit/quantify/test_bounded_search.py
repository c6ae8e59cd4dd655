import numpy as np
import pytest

from agent.analysis.quantify.valves.bounded_search import grid, grid_search, random_search


def bowl(f_s, f_d):
    return lambda bands: np.abs(bands[:, 0] - f_s) + np.abs(bands[:, 1] - f_d)


def test_the_grid_is_the_papers_triangle():
    bands = grid(20.0)
    f_s, f_d = bands.T
    assert len(bands) == 2601
    assert bands[0].tolist() == [0.0, 0.0]
    assert ((f_d >= 0) & (f_d <= f_s) & (f_s + f_d <= 20.0 + 1e-9)).all()
    assert len(np.unique(bands.round(6), axis=0)) == 2601


@pytest.mark.parametrize("bands", [(13.0, 0.0), (7.0, 5.0), (10.0, 10.0), (20.0, 0.0), (0.0, 0.0)])
def test_both_searches_find_the_minimum_inside_and_on_the_bounds(bands):
    np.testing.assert_allclose(grid_search(bowl(*bands), 20.0), bands, atol=1e-9)
    np.testing.assert_allclose(random_search(bowl(*bands), 20.0), bands, atol=0.05)


def test_the_random_search_stays_within_the_space_and_repeats_itself():
    tried = []

    def rugged(bands):
        tried.append(bands)
        return np.sin(bands @ [7.0, 3.0]) + 0.1 * bands.sum(axis=1)

    first, second = random_search(rugged, 20.0), random_search(rugged, 20.0)
    f_s, f_d = np.concatenate(tried).T
    assert ((f_d >= -1e-9) & (f_d <= f_s + 1e-9) & (f_s + f_d <= 20.0 + 1e-9)).all()
    assert first.tolist() == second.tolist()


def test_where_nothing_fits_the_answer_is_no_stiction():
    def nothing(bands):
        return np.full(len(bands), np.inf)

    assert grid_search(nothing, 20.0).tolist() == [0.0, 0.0]
    assert random_search(nothing, 20.0).tolist() == [0.0, 0.0]
