"""Dynamic time warping straight from its recursion."""

from functools import cache
from math import inf


def warped_distance(a, b, band):
    """The cheapest way from the first to the last points of both curves, over the number of points."""

    @cache
    def cheapest(i, j):
        if i < 0 or j < 0 or abs(i - j) > band:
            return inf
        step = (a[i] - b[j]) ** 2
        if i == j == 0:
            return step
        return step + min(cheapest(i - 1, j - 1), cheapest(i - 1, j), cheapest(i, j - 1))

    return cheapest(len(a) - 1, len(b) - 1) / len(a)
