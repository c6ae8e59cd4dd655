# ruff: noqa: ARG005 - each lambda takes what the method takes that it replaces
"""The public checks find what is wrong: members that break one demand each, and what a user reads of them."""

import inspect
import subprocess
import sys
from dataclasses import dataclass, replace

import numpy as np
import pytest

from agent.analysis.oscillation import AcfFiltered  # a member that keeps its contract
from agent.analysis.quantify import quantifier
from agent.analysis.results import MethodResult, Oscillation
from agent.analysis.stiction.horch_ccf import HorchCcf
from agent.checks import FAMILIES, ContractError, check_all, checks_of, faults_of
from agent.physics.effect import Parameter
from agent.physics.effects import EFFECTS
from agent.physics.processes import PROCESSES
from agent.physics.valves import LAWS

FOPDT, HE = PROCESSES[0], LAWS[0]
STICTION = next(effect for effect in EFFECTS if effect.name == "stiction")


@dataclass(frozen=True)
class Gain:
    """A valve effect that is right; each wrong one changes one thing."""

    name: str = "own_gain"
    family: str = "own"
    stage: str = "valve"
    bases: tuple[str, ...] = ("fopdt",)

    def parameters(self, facts):
        low, high = facts.op_low, facts.op_high
        return (
            Parameter("at", "OP", low + 0.1 * facts.op_span, high - 0.1 * facts.op_span),
            Parameter("ratio", "1", 0.2, 5.0, null=1.0, log=True),
        )

    def apply(self, position, values, ts):
        del ts
        at, ratio = values
        return np.minimum(position, at) + ratio * np.maximum(position - at, 0.0)


class Unnamed(Gain):
    def parameters(self, facts):
        at, ratio = super().parameters(facts)
        return replace(at, unit="%"), ratio


class Unbounded(Gain):
    def parameters(self, facts):
        at, ratio = super().parameters(facts)
        return replace(at, high=np.inf), ratio


class Lost(Gain):
    def apply(self, position, values, ts):
        return np.where(position > 60, np.nan, super().apply(position, values, ts))


class Short(Gain):
    def apply(self, position, values, ts):
        return super().apply(position, values, ts)[:-1]


class Writes(Gain):
    def apply(self, position, values, ts):
        position[0] += 0.0
        return super().apply(position, values, ts)


class Restless(Gain):
    drawn = np.random.default_rng(0)

    def apply(self, position, values, ts):
        return super().apply(position, values, ts) + 1e-3 * self.drawn.normal(size=len(position))


class Always(Gain):
    def apply(self, position, values, ts):
        return 1.0 + super().apply(position, values, ts) * 1.1


class Idle(Gain):
    def parameters(self, facts):
        return (*super().parameters(facts), Parameter("idle", "1", 0.0, 1.0))

    def apply(self, position, values, ts):
        return super().apply(position, values[:2], ts)


class InPercent(Gain):
    def apply(self, position, values, ts):
        return super().apply(position, values, ts) + np.sin(position) * (values[1] - 1.0)


class InSamples(Gain):
    def apply(self, position, values, ts):
        return super().apply(position, values, ts) * (1 + (values[1] - 1.0) * ts / 10)


@dataclass(frozen=True)
class WrongStart:
    """Stiction whose ``start`` is half of what it says."""

    name: str = "wrong_start"
    family: str = STICTION.family
    stage: str = "valve"
    bases: tuple[str, ...] = ("fopdt",)

    def parameters(self, facts):
        return STICTION.parameters(facts)

    def apply(self, position, values, ts):
        return STICTION.apply(position, values, ts)

    def values_of(self, bands, start, stem, ts):
        return STICTION.values_of(bands, 0.5 * start, stem, ts)

    def valve_of(self, values, ts):
        bands, start, stem = STICTION.valve_of(values, ts)
        return bands, 2 * start, stem


WRONG_EFFECTS = [
    (Unnamed, "names"),
    (Unbounded, "bounds"),
    (Lost, "finite_output"),
    (Short, "finite_output"),
    (Writes, "input_untouched"),
    (Restless, "repeatable"),
    (Always, "nothing_at_the_null"),
    (Idle, "every_parameter_counts"),
    (InPercent, "op_in_other_units"),
    (InSamples, "time_in_other_units"),
    (WrongStart, "first_slip"),
]


class Changed:
    """A member of which one method is another; everything else comes from the member."""

    def __init__(self, member, **methods):
        self.member, self.methods = member, methods

    def __getattr__(self, name):
        if name in ("member", "methods") or name.startswith("__"):
            raise AttributeError(name)
        if name in self.methods:
            return lambda *given: self.methods[name](self.member, *given)
        return getattr(self.member, name)


def drawn(member, window, oscillation):
    found = member.detect(window, oscillation)
    return replace(found, index=None if found.index is None else found.index + DRAWS.normal())


DRAWS = np.random.default_rng(0)
STICKS = MethodResult("stiction", 1.0, "always", seen="nothing")


def wrong_detector(name, detect):
    return pytest.param(Changed(HorchCcf(), detect=detect), name, id=name)


WRONG_DETECTORS = [
    wrong_detector("travels", lambda *_: MethodResult("undecided", None, "x", seen=None) and (lambda: None)),
    wrong_detector("repeatable", drawn),
    wrong_detector(
        "units_and_offsets", lambda m, w, o: replace(STICKS, index=float(np.nanmean(w.pv))) if len(w) else m
    ),
    wrong_detector("reversed_pv", lambda m, w, o: replace(STICKS, index=float(np.nanmean(w.pv)))),
    wrong_detector("slower_time", lambda m, w, o: replace(STICKS, index=w.ts)),
    wrong_detector("gaps_at_the_ends", lambda m, w, o: replace(STICKS, index=float(len(w)))),
    wrong_detector("storm_of_gaps", lambda *_: STICKS),
    wrong_detector("nothing_recorded", lambda *_: replace(STICKS, verdict="undecided")),
    wrong_detector("still_signals", lambda *_: STICKS),
    wrong_detector("few_samples", lambda *_: STICKS),
    wrong_detector("no_oscillation", lambda *_: STICKS),
    wrong_detector("any_hint", lambda m, w, o: m.detect(w, o) if w.hints.integrating is None else None),
    wrong_detector("any_record", lambda m, w, o: replace(STICKS, index=float("nan"))),
    wrong_detector("long_record", lambda m, w, o: 1 / 0 if len(w) > 10_000 else m.detect(w, o)),
]
SWINGS = Oscillation(True, 60.0, 2.0)
WRONG_OSCILLATION = {
    "sees_a_wave": lambda *_: Oscillation(False, None, None),
    "units_and_offset": lambda m, w: replace(SWINGS, period=float(np.ptp(w.op))),
    "period_in_seconds": lambda *_: SWINGS,
    "gaps": lambda m, w: replace(SWINGS, regularity=float(np.mean(w.op))),
    "short_record": lambda *_: SWINGS,
    "still_signals": lambda *_: SWINGS,
    "repeatable": lambda *_: replace(SWINGS, period=DRAWS.normal()),
    "noise": lambda *_: SWINGS,
}
WRONG_PROCESSES = {
    "linear": lambda m, p, v: m.respond(p, v) ** 2,
    "time_invariant": lambda m, p, v: m.respond(p, v) * np.linspace(1, 2, len(p)),
    "delay_and_gain": lambda m, p, v: 1.1 * m.respond(p, v),
    "smooth_in_the_delay": lambda m, p, v: m.respond(p, v) * (1 + (v[-1] % 1 > 0)),
    "missing_position": lambda m, p, v: np.nan_to_num(m.respond(p, v)),
    "beyond_the_record": lambda m, p, v: 1.0 + m.respond(p, v),
    "level_of_the_kernel": lambda m, p, v: 2.0 * m.respond(p, v),
    "bounds": lambda m, p, v: m.respond(p, (6.0, 3.0)),
}
WRONG_LAWS = {
    "holds_while_op_is_missing": lambda m, op, b, x0: m.position(np.nan_to_num(op), b, x0),
    "symmetric": lambda m, op, b, x0: np.maximum(m.position(op, b, x0), 0.0),
    "shape_and_input": lambda m, op, b, x0: m.position(op, b, x0)[:-1],
    "repeatable": lambda m, op, b, x0: m.position(op, b, x0) + DRAWS.normal(),
}


def fails(family, name, member):
    (check,) = [each for each in checks_of(family) if each.name == name]
    with pytest.raises(ContractError) as raised:
        check(member)
    text = str(raised.value)
    assert text.startswith(f"{check.family} {member.name} (")
    assert check.demand in text
    assert "\n" not in text


@pytest.mark.parametrize(("wrong", "name"), WRONG_EFFECTS)
def test_a_wrong_effect_fails(wrong, name):
    fails("effects", name, wrong())


def test_the_right_one_passes_all():
    check_all("effects", Gain())
    assert faults_of("oscillation_detectors", AcfFiltered()) == ()


@pytest.mark.parametrize(("wrong", "name"), WRONG_DETECTORS)
def test_a_wrong_stiction_detector_fails(wrong, name):
    fails("stiction_detectors", name, wrong)


@pytest.mark.parametrize("name", WRONG_OSCILLATION)
def test_a_wrong_oscillation_detector_fails(name):
    member = next(each for each in [AcfFiltered()] if each.noise_proof)
    fails("oscillation_detectors", name, Changed(member, detect=WRONG_OSCILLATION[name]))


@pytest.mark.parametrize("name", WRONG_PROCESSES)
def test_a_wrong_process_fails(name):
    fails("processes", name, Changed(FOPDT, respond=WRONG_PROCESSES[name]))


@pytest.mark.parametrize("name", WRONG_LAWS)
def test_a_wrong_stiction_law_fails(name):
    fails("stiction_laws", name, Changed(HE, position=WRONG_LAWS[name]))


@pytest.mark.parametrize(
    "name", [check.name for check in checks_of("quantifiers") if check.name != "long_record"]
)
def test_a_quantifier_that_raises_fails_and_the_error_is_named(name):
    def quantify(member, *_):
        raise ZeroDivisionError(member.name)

    fails("quantifiers", name, Changed(quantifier("stenman2003"), quantify=quantify))


def test_every_check_of_effects_detectors_laws_and_processes_has_a_wrong_member_here():
    assert {name for _, name in WRONG_EFFECTS} == {check.name for check in checks_of("effects")}
    assert {each.values[1] for each in WRONG_DETECTORS} == {c.name for c in checks_of("stiction_detectors")}
    for family, wrong in (
        ("oscillation_detectors", WRONG_OSCILLATION),
        ("processes", WRONG_PROCESSES),
        ("stiction_laws", WRONG_LAWS),
    ):
        assert set(wrong) == {check.name for check in checks_of(family)}


@pytest.mark.parametrize("family", FAMILIES)
def test_each_check_has_a_name_of_its_own_and_says_what_it_does(family):
    checks = checks_of(family)
    assert len({check.name for check in checks}) == len(checks)
    assert all(check.demand.startswith("must ") and inspect.getdoc(check.run) for check in checks)


def test_a_family_that_is_not_there_is_refused_with_those_that_are():
    with pytest.raises(ValueError, match="no family 'pumps'; there are effects, processes"):
        checks_of("pumps")


def test_the_checks_need_neither_pytest_nor_hypothesis():
    words = (
        "import sys; sys.modules['pytest'] = sys.modules['hypothesis'] = None; "
        "from agent.checks import FAMILIES, checks_of; print(sum(len(checks_of(each)) for each in FAMILIES))"
    )
    done = subprocess.run([sys.executable, "-c", words], capture_output=True, text=True, check=True)
    assert int(done.stdout) == sum(len(checks_of(family)) for family in FAMILIES)
