"""How often others have their turn on the event loop while something is worked on."""

import asyncio
from contextlib import asynccontextmanager


class Turns:
    """Of a task that takes each turn that it gets."""

    def __init__(self):
        self.count = 0

    async def of(self, work):
        """Return the turns during ``work``, which is awaited."""
        self.count = 0
        await work
        return self.count


@asynccontextmanager
async def other_turns():
    turns = Turns()

    async def take():
        while True:
            turns.count += 1
            await asyncio.sleep(0)

    task = asyncio.create_task(take())
    try:
        yield turns
    finally:
        task.cancel()
