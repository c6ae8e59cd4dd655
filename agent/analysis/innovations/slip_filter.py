"""How a stem moved whose friction differs from slip to slip, and how probable PV is then.

A packing is not alike along its stroke, and break-away grows with the time of rest. So the friction of a stem
that sticks again is drawn anew: S and J by one factor, whose logarithm is normal. As long as the stem stands,
the chance that it slips in a sample follows from how far the force has risen above what was held before (a
hazard). There the histories of the stem branch. They are weighed by the innovations of PV, and of the
improbable ones some are drawn for all, so that what is expected of their weights does not change (Fearnhead
and Clifford, J. R. Stat. Soc. B 65 (2003) 887): the sum of weights estimates how probable PV is with any
history, each as often as its slips are probable. No slip has a price of its own.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.identify.arrays import FloatArray
from agent.identify.objective import Process
from agent.jit import kernel, summing_kernel
from agent.physics.valves.damped_stem import Motion, strokes

if TYPE_CHECKING:
    from numpy.typing import NDArray

HISTORIES = 24
"""That are kept. Twelve lose a tenth of the nats of simulated valves, forty gain a hundredth at 1.6 times the
time."""
SAME_PLACE = 0.1
"""Way, over S, up to which a stem that moved has the friction that it had: noise of OP is no slip."""
LEAST_CHANCE = 1e-6
"""Of a slip, or of none, in a sample, below which it is no branch."""
NOTHING = 1e-300
"""Weight below which a history is impossible."""
HOLDS = 0.98
"""Most of the force, over the friction, that a stem that came to rest is held at: it would else go on."""

# What is known of a history, a row: first the stem (``strokes``); then the most of the median
# friction that it has held; its friction over the median; where that was drawn, OP units; 1 where it has
# shown, else 0; the process (``Memory``); and how probable the history is. Behind these come its last
# responses, one for each lag of the noise (``new_in``).
X, FORCE, DIRECTION = 0, 1, 2
HELD, FACTOR, PLACE, SHOWN, PASSED, FORMER, FIRST, SECOND, WEIGHT = range(5, 14)
COLUMNS = 14


class ObservedPv(NamedTuple):
    """The record that weighs the histories, behind a filter; blocks of one sample."""

    op: FloatArray
    """OP units, (n,)."""
    target: FloatArray
    """What the process should answer, PV units, (n,)."""
    weight: FloatArray
    """1 where the target counts, else 0, (n,)."""
    squares: float
    """Degrees of freedom times the square of the scale of its innovations (Student's distribution), PV units
    squared."""
    power: float
    """Of that distribution: half the degrees of freedom plus a half."""
    gain: float
    """Of the process, PV over OP units."""
    coefficients: FloatArray
    """Of the autoregression that the target is behind, (lags,)."""


class Friction(NamedTuple):
    """Of a packing: medians, and how they scatter."""

    f_s: float
    """OP units"""
    f_d: float
    """OP units"""
    scatter: float
    """Standard deviation of the logarithm of the factor of both."""


@kernel
def holds_beyond(force: float, scatter: float) -> float:
    """Return how probable friction is larger than ``force`` (over its median), 0 to 1."""
    return 1.0 if force <= 0.0 else 0.5 * math.erfc(math.log(force) / (scatter * math.sqrt(2.0)))


@kernel
def chance_to_slip(force: float, held: float, scatter: float) -> float:
    """Return how probable a stem that has held ``held`` slips at ``force``, both over the median friction."""
    if force <= held:
        return 0.0
    before = holds_beyond(held, scatter)
    return 1.0 if before <= LEAST_CHANCE**2 else 1.0 - holds_beyond(force, scatter) / before


@kernel
def moved_on(
    history: FloatArray, seen: ObservedPv, t: int, friction: Friction, stem: Motion, scratch: FloatArray
) -> float:
    """Move the stem of a history (columns,) through sample t; return its mean position, OP units."""
    stood, factor = history[X], history[FACTOR]
    bands = (friction.f_s * factor, friction.f_s * factor, friction.f_d * factor)
    strokes(seen.op, t, t + 1, history, bands, stem, scratch, t + 1)
    if history[SHOWN] == 0.0:
        history[PLACE], history[SHOWN] = stood, 1.0
    far = abs(history[X] - history[PLACE]) > SAME_PLACE * (friction.f_s + friction.f_d)
    if far and history[DIRECTION] == 0.0:
        history[SHOWN] = 0.0
        history[HELD] = min(abs(seen.op[t] - history[X]) / friction.f_s, HOLDS)
    return float(scratch[t])


@kernel
def weighed(history: FloatArray, position: float, seen: ObservedPv, t: int, process: Process) -> None:
    """Move the process of a history (columns,) on by a sample, and weigh the history by its innovation."""
    history[PASSED] = process.keep * history[PASSED] + (position - history[FORMER])
    history[FORMER] = position
    history[FIRST] = process.pole * history[FIRST] + history[PASSED]
    older = history[SECOND]
    history[SECOND] = process.pole2 * older + history[FIRST]
    at = t + process.whole
    response = new_in(history[COLUMNS:], process.now * history[SECOND] + process.then * older, t, seen)
    if at < seen.op.size and seen.weight[at] > 0.0:
        error = seen.target[at] - seen.gain * response
        history[WEIGHT] *= (1.0 + error * error / seen.squares) ** -seen.power


@summing_kernel
def new_in(ring: FloatArray, response: float, t: int, seen: ObservedPv) -> float:
    """Return what the autoregression leaves of a response, and keep it among the last ones.

    ``ring`` (2 lags,) has each twice, so that any lags in a row are one behind the other in memory.
    """
    lags = seen.coefficients.size
    if lags == 0:
        return response
    place = t % lags
    new = response
    for i in range(lags):
        new -= seen.coefficients[lags - 1 - i] * ring[place + i]
    ring[place] = ring[place + lags] = response
    return new


@kernel
def likeliest_history(
    seen: ObservedPv, process: Process, friction: Friction, stem: Motion, rests: FloatArray
) -> tuple[FloatArray, FloatArray, float]:
    """Return a probable history of a stem, and how probable PV is with any.

    Args:
        seen: The record.
        process: Of gain one, with its filter (``process_of``).
        friction: Of the packing.
        stem: How the stem moves.
        rests: Where it may have rested before, OP units, each as probable.

    Returns:
        Its mean positions over each sample, OP units, (n,); the factor of its friction where a slip begins,
        else 0, (n,); and the log likelihood of PV, nats, less a constant, over all histories.
    """
    n = seen.op.size
    rows = 2 * (max(HISTORIES, rests.size) + 1)  # one more by rounding
    columns = COLUMNS + 2 * seen.coefficients.size
    kept, grown = np.zeros((rows, columns)), np.zeros((rows, columns))
    parent, position, begun = np.zeros((n, rows), np.int32), np.zeros((n, rows)), np.zeros((n, rows))
    scratch = np.empty(n)
    for i in range(rests.size):
        kept[i, X], kept[i, FORCE], kept[i, FORMER] = rests[i], seen.op[0], rests[i]
        kept[i, HELD] = min(abs(seen.op[0] - rests[i]) / friction.f_s, HOLDS)
        kept[i, FACTOR], kept[i, WEIGHT] = 1.0, 1.0 / rests.size
    many, likely = rests.size, 0.0
    for t in range(n):
        count = 0
        for i in range(many):
            history = kept[i]
            force = abs(seen.op[t] - history[X]) / friction.f_s
            goes, factor = 1.0, history[FACTOR]
            stands, known = history[DIRECTION] == 0.0, history[SHOWN] > 0.0
            if stands and known:
                goes = 1.0 if force > factor else 0.0
            elif stands:
                goes = chance_to_slip(force, history[HELD], friction.scatter)
                # Friction was between both forces: the nearest to its median, and just below the later one.
                factor = min(max(1.0, history[HELD]), force * (1.0 - 1e-9))
            if goes > LEAST_CHANCE:
                grown[count] = history
                grown[count, FACTOR] = factor
                grown[count, WEIGHT] *= goes
                position[t, count] = moved_on(grown[count], seen, t, friction, stem, scratch)
                parent[t, count], begun[t, count] = i, factor if stands and not known else 0.0
                count += 1
            if 1.0 - goes > LEAST_CHANCE:
                grown[count] = history
                grown[count, FORCE], grown[count, HELD] = seen.op[t], max(force, history[HELD])
                grown[count, WEIGHT] *= 1.0 - goes
                parent[t, count], begun[t, count], position[t, count] = i, 0.0, history[X]
                count += 1
        for i in range(count):
            weighed(grown[i], position[t, i], seen, t, process)
        likely += normalised(grown[:count])
        many = drop(grown, count, kept, parent[t], position[t], begun[t])
    path, factors = traced(int(np.argmax(kept[:many, WEIGHT])), parent, position, begun)
    return path, factors, likely


@kernel
def normalised(rows: FloatArray) -> float:
    """Make the weights of rows (k, columns) add up to 1, and return the logarithm of what they added up to.

    Where all are impossible they go on alike.
    """
    total = rows[:, WEIGHT].sum()
    if not total > NOTHING:
        rows[:, WEIGHT] = 1.0 / len(rows)
        return math.log(NOTHING)
    rows[:, WEIGHT] /= total
    return math.log(total)


@kernel
def least_kept(weights: FloatArray) -> float:
    """Return 1 / c, where the sum of min(c w, 1) over ``weights`` (k,) is HISTORIES; for fewer next to 0."""
    if weights.size <= HISTORIES:
        return NOTHING
    ascending = np.sort(weights)
    below, least = 0.0, NOTHING
    for i in range(ascending.size):
        below += ascending[i]
        drawn = HISTORIES - (ascending.size - 1 - i)
        if drawn > 0 and ascending[i] * drawn <= below:
            least = max(below / drawn, NOTHING)
    return least


@kernel
def drop(
    grown: FloatArray,
    count: int,
    kept: FloatArray,
    parent: NDArray[np.int32],
    position: FloatArray,
    begun: FloatArray,
) -> int:
    """Move at most HISTORIES of ``count`` rows from ``grown`` to ``kept``, and return their number.

    Those that are as probable as the least that is kept stay as they are. Of the others as many as there is
    room for are drawn, one in each equal share of their sum, and get that weight. Entries of the other arrays
    move along.
    """
    least = least_kept(grown[:count, WEIGHT])
    many, share = 0, 0.5 * least
    for i in range(count):
        stays = grown[i, WEIGHT] >= least
        if not stays:
            share += grown[i, WEIGHT]
            if share >= least:
                share -= least
                grown[i, WEIGHT] = least
                stays = True
        if stays:
            kept[many] = grown[i]
            parent[many], position[many], begun[many] = parent[i], position[i], begun[i]
            many += 1
    return many


@kernel
def traced(
    last: int, parent: NDArray[np.int32], position: FloatArray, begun: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return positions and factors of the history that ends in the row ``last``, (n,) each."""
    n = len(parent)
    path, factors = np.empty(n), np.empty(n)
    row = last
    for t in range(n - 1, -1, -1):
        path[t], factors[t] = position[t, row], begun[t, row]
        row = parent[t, row]
    return path, factors
