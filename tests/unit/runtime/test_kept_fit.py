"""A fit is kept in some 30 kB: the page finds all of it, and its pictures, in what is kept."""

import asyncio
import pickle
from dataclasses import replace

import numpy as np
import pytest

from agent.analysis.diagnose import diagnose
from agent.analysis.record.recording import LoopWindow
from agent.analysis.routine import first_look, full_diagnosis, routine_diagnosis
from agent.analysis.seen import look
from agent.runtime.loop.kept_fit import KeptFit, without_curves
from agent.runtime.loop.packed import Packed
from agent.web.pictures.loop_pictures import method_picture
from simulators.draws.random_plants import random_plant
from simulators.plant import simulate
from tests.unit.runtime.agents import agent_of, stream, virtual
from tests.unit.runtime.fake_bus import FakeBus
from tests.unit.runtime.loops import cut_of

HOUR = 3600
MOST = 60_000
"""Bytes of a fit and its diagnosis, the window included; before, 250 to 450 kB."""
LEAST_BEFORE = 250_000


def hour(seed, kind):
    """An hour of a loop with a set point, as the rings have it: floats of 32 bits, and a gap."""
    scenario = random_plant(seed, kind)
    record = simulate(scenario)

    def column(values):
        held = np.resize(values, HOUR).astype(np.float32).astype(float)
        held[100:103] = np.nan
        return held

    set_point = np.full(HOUR, 50.0)
    return LoopWindow(scenario.loop, 1e9, scenario.ts, column(record.op), column(record.pv), sp=set_point)


@pytest.fixture(scope="module")
def fit():
    window = hour(60010, "stiction")
    return window, diagnose(window)


def kept_bytes(value):
    return len(pickle.dumps(value, pickle.HIGHEST_PROTOCOL))


def test_a_fit_of_an_hour_is_kept_in_60_kb_in_place_of_250(fit):
    window, whole = fit
    found = full_diagnosis(window, lambda _window, _seen=None: whole).diagnosis
    assert found.quantification is not None
    assert kept_bytes((KeptFit.of(window, found), without_curves(found))) <= MOST
    assert kept_bytes((window, whole)) >= LEAST_BEFORE  # what it was before


def test_what_is_kept_has_the_window_as_it_was_and_the_curves_of_the_model(fit):
    window, whole = fit
    again, found = KeptFit.of(window, whole).packed.open()
    for role in ("op", "pv", "sp"):
        assert np.array_equal(getattr(again, role), getattr(window, role), equal_nan=True)
        assert not getattr(again, role).flags.writeable
    assert (again.start, again.ts, again.wild, again.hints) == (
        window.start,
        window.ts,
        window.wild,
        window.hints,
    )
    np.testing.assert_allclose(found.quantification.model_pv, whole.quantification.model_pv, rtol=1e-6)
    np.testing.assert_allclose(found.quantification.model_mv, whole.quantification.model_mv, rtol=1e-6)
    np.testing.assert_allclose(found.quantification.profile.s, whole.quantification.profile.s, rtol=1e-6)
    assert without_curves(found) == without_curves(whole)


def test_lists_and_alarms_need_no_curve(fit):
    _, whole = fit
    bare = without_curves(whole).quantification
    assert bare.s == whole.quantification.s
    assert bare.process == whole.quantification.process
    assert (bare.model_pv, bare.model_mv, bare.profile, bare.sticking) == (None, None, None, None)


def test_the_picture_of_a_detector_is_made_of_the_window_again(fit):
    window, whole = fit
    kept = KeptFit.of(window, whole)
    drawn = [name for name in whole.methods if method_picture(name, kept) is not None]
    assert drawn == [name for name, each in look(window).methods.items() if each.seen is not None]
    assert method_picture("no such method", kept) is None


def test_what_detectors_saw_stays_in_the_worker(fit):
    window, whole = fit
    seen = first_look(window)
    full = full_diagnosis(window, lambda _window, _seen=None: whole)
    quiet = routine_diagnosis(replace(window, op=np.full(HOUR, 50.0)), diagnose)
    for methods in (seen.methods, full.diagnosis.methods, quiet.diagnosis.methods):
        assert all(each.seen is None for each in methods.values())


def test_a_window_on_its_way_to_a_worker_takes_four_bytes_a_sample(fit):
    window, _ = fit
    cut = pickle.loads(pickle.dumps(cut_of(window)))  # noqa: S301 - made here
    assert len(pickle.dumps(cut)) <= 4 * 3 * HOUR + 2000
    assert (cut.start, cut.last, cut.end) == (window.start, window.time[-1], window.start + HOUR * window.ts)
    assert np.array_equal(cut.open().pv, window.pv, equal_nan=True)
    assert cut.open().hints == window.hints


def test_other_values_go_through_as_they_are():
    value = {"words": ("a", "b"), "flags": np.array([True, False]), "whole": np.arange(3), "two": np.eye(2)}
    for squeezed in (False, True):
        again = Packed.of(value, squeezed=squeezed).open()
        assert again["words"] == value["words"]
        for name in ("flags", "whole", "two"):
            assert np.array_equal(again[name], value[name])
            assert again[name].dtype == value[name].dtype


def test_an_agent_keeps_the_window_of_its_newest_fit():
    async def scenario():
        agent = agent_of(FakeBus(stream(("FIC101",), 900)), quantify="always")
        task = asyncio.create_task(agent.run())
        await asyncio.sleep(850)
        task.cancel()
        await asyncio.wait({task})
        return agent.pipelines["FIC101"]

    pipeline = virtual(scenario())
    window, found = pipeline.fitted.packed.open()
    assert window.start == pipeline.fitted.start
    assert len(window) * window.ts == pipeline.fitted.seconds == 400.0
    assert found == pipeline.diagnosis
    assert np.isfinite(window.pv).all()
