"""A small simulated plant on MQTT with agent and page: prints address and broker port, runs until ended."""

import asyncio
import sys
from pathlib import Path

from agent.cli.common.page import serve_page
from agent.cli.common.stage import on_stage
from agent.runtime.loop.workers import PoolExecutor
from agent.settings import HttpSettings
from simulators.scenario import load_scenario
from simulators.source import PlantSource

SCENARIOS = Path(__file__).parents[2] / "config" / "scenarios"
SPEED = 60
HOSTILE = "<script>alert(1)<script>"
LONG = 1e7


def say(line):
    print(line, flush=True)  # noqa: T201 - its output


async def main(port):
    sticking = load_scenario(SCENARIOS / "fic101_stick_slip.yaml").model_copy(update={"duration": LONG})
    healthy = load_scenario(SCENARIOS / "fic103_healthy.yaml").model_copy(update={"duration": LONG})
    loops = [
        PlantSource(sticking),
        PlantSource(healthy),
        PlantSource(healthy.model_copy(update={"loop": HOSTILE})),
    ]
    options = {
        "window": {"seconds": 600, "hop": 0.5},
        "alarm": {"on_delay": 1, "off_delay": 3, "priority": "high"},
        "acting": "reverse",
        "op_range": [0, 100],
    }
    async with PoolExecutor(1) as executor:

        def accompany(agent):
            serve_page(agent, HttpSettings(port=port), say, "Test plant")

        async with on_stage(
            {"mqtt": loops}, lambda _: options, SPEED, executor, lambda _: None, accompany
        ) as stage:
            say(f"broker: {stage.agent.settings.connections['mqtt'].options.port}")
            await asyncio.Event().wait()


if __name__ == "__main__":
    asyncio.run(main(int(sys.argv[1])))
