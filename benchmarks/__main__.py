"""`python -m benchmarks [--full] [NAME...]`: run the benchmarks and print their tables."""

from __future__ import annotations

import argparse
import platform
from pathlib import Path

from agent.runtime.capabilities import cores
from benchmarks import (
    diagnosis,
    evidence_weights,
    fault_matrix,
    gallery,
    hidden_effects,
    hidden_in_bursts,
    kernels,
    last_digits,
    lee2008_map,
    limit_cycles,
    loaded_agent,
    long_recordings,
    looked_once,
    many_files,
    memory_rates,
    no_response,
    one_valve,
    oscillation,
    outside_waves,
    page_load,
    plant_scale,
    plant_together,
    plant_wide,
    quiet_records,
    real_recordings,
    record_length,
    rigs,
    s_errors,
    sampling_rate,
    scattered_slips,
    simulated,
    simulated_weeks,
    soak,
    start_up,
    surroundings,
    survey,
    table_one,
    valve_ranking,
    workbench_tick,
    wrong_cases,
)
from benchmarks.cases.options import Options
from benchmarks.peers import third_parties

BENCHMARKS = {
    "real_recordings": real_recordings.run,
    "simulated": simulated.run,
    "table_one": table_one.run,
    "kernels": kernels.run,
    "lee2008_map": lee2008_map.run,
    "record_length": record_length.run,
    "sampling_rate": sampling_rate.run,
    "start_up": start_up.run,
    "looked_once": looked_once.run,
    "loaded_agent": loaded_agent.run,
    "many_files": many_files.run,
    "survey": survey.run,
    "oscillation": oscillation.run,
    "diagnosis": diagnosis.run,
    "one_valve": one_valve.run,
    "long_recordings": long_recordings.run,
    "outside_waves": outside_waves.run,
    "scattered_slips": scattered_slips.run,
    "surroundings": surroundings.run,
    "no_response": no_response.run,
    "simulated_weeks": simulated_weeks.run,
    "valve_ranking": valve_ranking.run,
    "quiet_records": quiet_records.run,
    "plant_wide": plant_wide.run,
    "plant_scale": plant_scale.run,
    "plant_together": plant_together.run,
    "page_load": page_load.run,
    "workbench_tick": workbench_tick.run,
    "hidden_effects": hidden_effects.run,
    "hidden_in_bursts": hidden_in_bursts.run,
    "limit_cycles": limit_cycles.run,
    "last_digits": last_digits.run,
    "rigs": rigs.run,
    "fault_matrix": fault_matrix.run,
    "third_parties": third_parties.run,
    "soak": soak.run,
}
ONLY_NAMED = {
    "evidence_weights": evidence_weights.run,
    "gallery": gallery.run,
    "memory_rates": memory_rates.run,
    "s_errors": s_errors.run,
    "wrong_cases": wrong_cases.run,
}
"""Run only if named: they set something, or write into the docs."""


def main() -> None:
    """Run all benchmarks, or those that are named."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(BENCHMARKS | ONLY_NAMED))
    parser.add_argument(
        "--full", action="store_true", help="600 simulated sticking loops, not 200; more repeats"
    )
    parser.add_argument(
        "--loops", type=int, metavar="N", help="N simulated sticking loops, and N/4 of each other kind"
    )
    parser.add_argument(
        "--save",
        type=Path,
        metavar="FILE",
        help="CSV file of the simulated cases; a run continues from it",
    )
    parser.add_argument(
        "--seconds",
        type=float,
        metavar="S",
        help="of measuring, where time passes: plant_scale, plant_together",
    )
    given = parser.parse_args()
    unknown = set(given.names) - set(BENCHMARKS | ONLY_NAMED)
    if unknown:
        parser.error(
            f"no benchmark {', '.join(sorted(unknown))}; there are {', '.join(BENCHMARKS | ONLY_NAMED)}"
        )
    if given.loops is not None and given.loops < 1:
        parser.error("--loops: expected 1 or more")
    options = Options(full=given.full, loops=given.loops, save=given.save, seconds=given.seconds)
    print(f"{platform.platform()}, {cores()} cores, Python {platform.python_version()}\n")
    for name in given.names or BENCHMARKS:
        (BENCHMARKS | ONLY_NAMED)[name](options)


if __name__ == "__main__":
    main()
