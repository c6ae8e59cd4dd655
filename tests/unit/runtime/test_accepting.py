"""A crowd of connections does not fill the log."""

import asyncio

from agent.runtime.operate.accepting import AGAIN, NO_MORE, log_refused_accepts_seldom
from tests.unit.runtime.agents import virtual


def test_refused_accepts_are_logged_once_a_minute_and_other_faults_each_time(caplog):
    async def scenario():
        loop = asyncio.get_running_loop()
        log_refused_accepts_seldom(loop)
        for _ in range(2):
            for _ in range(1000):
                loop.call_exception_handler({"message": NO_MORE, "exception": OSError(24, "Too many")})
            await asyncio.sleep(AGAIN)
        for _ in range(3):
            loop.call_exception_handler({"message": "a fault"})

    virtual(scenario())
    assert [each.message.split(":")[0] for each in caplog.records] == [
        *2 * ["no more connections can be accepted for now"],
        *3 * ["a fault"],
    ]
