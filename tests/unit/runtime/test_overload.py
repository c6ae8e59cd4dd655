"""Three times the fits that the worker can carry, for five minutes: fits are shed, nothing else is."""

import asyncio
from dataclasses import replace

from agent.analysis.routine import Routine, first_look
from agent.runtime.loop.turns import Turns
from tests.unit.runtime.agents import agent_of, judged, stream, virtual
from tests.unit.runtime.fake_bus import FakeBus

LOOPS = tuple(f"FIC{k:03d}" for k in range(20))
SICK, FALLS_SICK = LOOPS[0], LOOPS[1]
"""One sticks from the start, the other from the middle of the upset on."""
UPSET = range(200, 500)
"""When three quarters of the plant oscillate, s: three times the fits are due that can be made."""
LOOK, FIT = 0.04, 2.0
"""s of the worker."""


class Worker:
    """One, in virtual time; what it finds follows from the hour."""

    def __init__(self):
        self.turns = Turns(1)

    @property
    def queued(self):
        return self.turns.waiting

    async def run_in_turn(self, expected, work, worth=1.0):
        async with self.turns.turn(expected, worth):
            calculation = work()
            function, cut, *_ = calculation.args
            window, now = cut.open(), asyncio.get_running_loop().time()
            sick = window.loop == SICK or (window.loop == FALLS_SICK and now > 250)
            looks = function is first_look
            await asyncio.sleep(LOOK if looks else FIT)
            if looks and (sick or (UPSET.start <= now < UPSET.stop and LOOPS.index(window.loop) < 15)):
                return "seen"
            verdict = "stiction" if sick else "no_stiction"
            return Routine(replace(judged(verdict)(window), seconds=FIT), fitted=not looks)


class Plant:
    """Hears what became of windows and alarms."""

    def __init__(self):
        self.judged_windows, self.alarms = [], []

    def judged(self, judged):
        now = asyncio.get_running_loop().time()
        self.judged_windows.append((now, judged.diagnosis.loop, judged.fitted, judged.took))

    def announced(self, announcement):
        now = asyncio.get_running_loop().time()
        self.alarms.append((now, announcement.alarm.loop, announcement.alarm.state.active))


def test_fits_are_shed_and_marked_while_samples_looks_and_alarms_go_on_and_it_recovers():
    async def scenario():
        plant, worker = Plant(), Worker()
        agent = agent_of(FakeBus(stream(LOOPS, 800)), LOOPS, executor=worker, seconds=40.0, hop=0.25)
        agent.observe(plant)
        task = asyncio.create_task(agent.run())
        marks = {}
        for at in (UPSET.start, UPSET.stop, UPSET.stop + 60, 790):
            await asyncio.sleep(at + 0.5 - asyncio.get_running_loop().time())  # between two samples
            status = agent.status()
            marks[at] = (sum(each.superseded for each in status), sum(each.samples for each in status))
            marks[at] += (worker.queued,)
        task.cancel()
        await asyncio.wait({task})
        return plant, marks

    plant, marks = virtual(scenario())
    before, upset, after, end = marks.values()
    during = [each for each in plant.judged_windows if UPSET.start <= each[0] < UPSET.stop]
    fits = [each for each in during if each[2]]
    # Ingestion: every sample of every loop is there.
    assert [samples for _, samples, _ in marks.values()] == [2 * len(LOOPS) * (at + 1) for at in marks]
    # The worker never rests, and two thirds of the fits are skipped, each counted.
    assert 0.85 * 300 / FIT <= len(fits) <= 300 / FIT
    assert before[0] == 0
    assert 200 <= upset[0] <= 350
    # Who needs no fit waits for the one that is under way, and for looks.
    assert max(took for _, _, fitted, took in during if not fitted) <= FIT + len(LOOPS) * LOOK
    assert sum(not fitted for _, _, fitted, _ in during) in range(5 * 29, 5 * 30 + 1)
    # Alarms: the standing one stands, the new one comes.
    assert [active for _, loop, active in plant.alarms if loop == SICK] == [True]
    came = [at for at, loop, active in plant.alarms if loop == FALLS_SICK and active]
    assert len(came) == 1
    assert came[0] < UPSET.stop
    # It recovers by itself: a minute later nothing is skipped any more.
    assert after[0] == end[0]
    assert end[2] <= 2
