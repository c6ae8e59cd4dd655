import asyncio

import async_solipsism
import pytest

from simulators.clock import SLACK, Clock


def in_virtual_time(coroutine):
    with asyncio.Runner(loop_factory=async_solipsism.EventLoop) as runner:
        return runner.run(coroutine)


def now():
    return asyncio.get_running_loop().time()


def test_first_wait_is_the_anchor():
    async def run():
        clock, began = Clock(10.0), now()
        await clock.wait_until(1_767_225_600.0)
        assert now() == began
        await clock.wait_until(1_767_225_600.0 + 50.0)
        assert now() - began == pytest.approx(5.0, abs=1e-6)

    in_virtual_time(run())


def test_another_factor_counts_from_the_next_wait():
    async def run():
        clock = Clock(40.0)
        await clock.wait_until(0.0)
        await clock.wait_until(400.0)
        clock.change(1.0)
        await clock.wait_until(401.0)
        began = now()
        await clock.wait_until(411.0)
        assert now() - began == pytest.approx(10.0, abs=1e-6)

    in_virtual_time(run())


def test_little_lateness_is_caught_up():
    async def run():
        clock, began = Clock(1.0), now()
        await clock.wait_until(0.0)
        await asyncio.sleep(1.0 + SLACK / 2)
        await clock.wait_until(1.0)
        await clock.wait_until(2.0)
        assert now() - began == pytest.approx(2.0)

    in_virtual_time(run())


def test_much_lateness_shifts_what_follows():
    async def run():
        clock, began = Clock(1.0), now()
        await clock.wait_until(0.0)
        await asyncio.sleep(31.0)  # somebody held us up for 30 s
        times = []
        for time in (1.0, 2.0, 3.0, 4.0):
            await clock.wait_until(time)
            times.append(now() - began)
        assert times == pytest.approx([31.0, 32.0 - SLACK, 33.0 - SLACK, 34.0 - SLACK])

    in_virtual_time(run())


def test_flat_out_takes_no_time_but_gives_others_a_turn():
    async def run():
        clock, began = Clock(None), now()
        turns = []

        async def other():
            turns.append(now())

        task = asyncio.create_task(other())
        for time in range(1000):
            await clock.wait_until(float(time))
        await task
        assert now() == began
        assert turns == [began]

    in_virtual_time(run())


@pytest.mark.parametrize("factor", [0.0, -1.0])
def test_factor_must_be_positive(factor):
    with pytest.raises(ValueError, match="factor must be > 0"):
        Clock(factor)
