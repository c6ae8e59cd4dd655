"""A database that is killed under load, again and again, for as long as a test says."""

import asyncio

DEADLINE = 60.0
PAUSE = 0.005
"""s between two bursts."""
SENT_BETWEEN = 60
"""What the database takes before it is killed again."""
LENGTHS = (0.0, 5.0)
"""s of each outage; at least so long that it was noticed and more came than a batch holds."""
A_MINUTE = (60.0,)


def all_sent(forwarder):
    """Send all that waits, by a forwarder that knows nothing yet; return it, at its end."""
    try:
        while forwarder.send():
            pass
    finally:
        forwarder._let_go()
        forwarder._thread.shutdown()
    return forwarder


class Load:
    """Puts numbered pieces in bursts, from 0 on."""

    def __init__(self, put, burst):
        self._put, self._burst, self.count = put, burst, 0

    async def until(self, condition, longest=DEADLINE):
        """Put bursts until the condition holds."""
        clock = asyncio.get_running_loop().time
        end = clock() + longest
        while not condition():
            assert clock() < end
            for _ in range(self._burst):
                self._put(self.count)
                self.count += 1
            await asyncio.sleep(PAUSE)


async def outages(postgres, forwarder, load, lengths, meanwhile):
    """Kill the database and start it again, once for each length (s); at least ``meanwhile`` pieces come."""
    clock = asyncio.get_running_loop().time
    for length in lengths:
        before = forwarder.sent
        await load.until(lambda before=before: forwarder.sent > before + SENT_BETWEEN)
        postgres.kill()
        least, end = load.count + meanwhile, clock() + length
        await load.until(
            lambda least=least, end=end: forwarder._problem and load.count > least and clock() >= end,
            length + DEADLINE,
        )
        starting = asyncio.create_task(asyncio.to_thread(postgres.start))
        await load.until(starting.done)
        await starting
        await load.until(lambda: not forwarder._problem)
