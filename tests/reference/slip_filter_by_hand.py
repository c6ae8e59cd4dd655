"""All that a stem with scattered friction may do in a short record, one history after the other."""

import math

from agent.analysis.innovations.slip_filter import HOLDS, LEAST_CHANCE, SAME_PLACE


def all_histories(op, f_s, f_d, scatter, rests, *, slides):
    """Yield of each history its probability, rest, positions (n,) and factors (n,) of slips that begin."""
    for x in rests:
        held = min(abs(op[0] - x) / f_s, HOLDS)
        for probability, positions, factors in histories(
            op, 0, (x, 0, None, held, 0.0), f_s, f_d, scatter, slides=slides
        ):
            yield probability / len(rests), x, positions, factors


def histories(op, t, state, f_s, f_d, scatter, *, slides):
    """The same of one stem from sample t on: where it is, moves to, its factor if shown, held, and place."""
    if t == len(op):
        yield 1.0, [], []
        return
    for probability, position, begun, after in one_sample(op[t], state, f_s, f_d, scatter, slides=slides):
        for later, positions, factors in histories(op, t + 1, after, f_s, f_d, scatter, slides=slides):
            yield probability * later, [position, *positions], [begun, *factors]


def one_sample(op, state, f_s, f_d, scatter, *, slides):
    x, moves, factor, held, place = state
    force = abs(op - x) / f_s
    if moves:
        further = moves * (op - x) - f_d * factor > 0
        return (
            [(1.0, *moved(op, state, f_s, f_d, factor, moves, place, 0.0, slides=slides))]
            if further
            else [(1.0, *stopped(op, x, f_s, f_d, factor, place))]
        )
    toward = 1 if op > x else -1
    if factor is not None:
        if force > factor:
            return [(1.0, *moved(op, state, f_s, f_d, factor, toward, place, 0.0, slides=slides))]
        return [(1.0, x, 0.0, (x, 0, factor, max(force, held), place))]
    slips = 0.0
    if force > held:
        slips = 1 - above(force, scatter) / above(held, scatter)
    found = []
    if slips > LEAST_CHANCE:
        drawn = min(max(1.0, held), force * (1 - 1e-9))
        found.append((slips, *moved(op, state, f_s, f_d, drawn, toward, x, drawn, slides=slides)))
    if 1 - slips > LEAST_CHANCE:
        found.append((1 - slips, x, 0.0, (x, 0, None, max(force, held), place)))
    return found


def moved(op, state, f_s, f_d, factor, toward, place, begun, *, slides):
    x = op - toward * f_d * factor
    if slides:
        return x, begun, (x, toward, factor, state[3], place)
    _, _, after = stopped(op, x, f_s, f_d, factor, place)
    return x, begun, after


def stopped(op, x, f_s, f_d, factor, place):
    """A stem that went far has another friction; one that did not has the one that it showed."""
    if abs(x - place) > SAME_PLACE * (f_s + f_d):
        return x, 0.0, (x, 0, None, min(abs(op - x) / f_s, HOLDS), place)
    return x, 0.0, (x, 0, factor, 0.0, place)


def above(force, scatter):
    return 1.0 if force <= 0 else 0.5 * math.erfc(math.log(force) / (scatter * math.sqrt(2)))


def answers(rest, positions, process):
    """What the process answers to each sample of one history, ``process.whole`` samples later."""
    passed = first = second = older = 0.0
    former, found = rest, []
    for position in positions:
        passed = process.keep * passed + position - former
        former = position
        first = process.pole * first + passed
        older, second = second, process.pole2 * second + first
        found.append(process.now * second + process.then * older)
    return found


def student(rest, positions, seen, process):
    """Likelihood of PV behind one history, less a constant."""
    likelihood, answered = 1.0, answers(rest, positions, process)
    for t, now in enumerate(seen.target[process.whole :]):
        past = sum(a * answered[t - 1 - lag] for lag, a in enumerate(seen.coefficients) if t - 1 - lag >= 0)
        likelihood *= (1 + (now - seen.gain * (answered[t] - past)) ** 2 / seen.squares) ** -seen.power
    return likelihood
