"""What is hidden in a scenario: each fault of valve, loop and load in words with its numbers.

``python -m simulators.hidden_faults > config/scenarios/truth.yaml`` writes it for those that ship.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import yaml

from simulators.scenario import TIGHT, Scenario, load_scenario

FOLDER = Path(__file__).parents[1] / "config" / "scenarios"
TRUTH = "truth.yaml"
"""Beside the scenarios; no scenario itself."""
ORDINARY_LAG = 0.2
"""Lag of a positioner that is no fault, s."""
Fault = dict[str, float | str | list[Any]]


def hidden_faults(scenario: Scenario) -> dict[str, Fault]:
    """Return fault -> its numbers, in the units of the scenario; empty for a loop in order."""
    found = {name: of(scenario) for name, of in FAULTS.items()}
    return {name: fault for name, fault in found.items() if fault}


def _stiction(scenario: Scenario) -> Fault:
    valve = scenario.valve
    if not valve.f_s:
        return {}
    truth = scenario.truth
    fault: Fault = {
        "law": valve.law,
        "s": _rounded(truth.f_s + truth.f_d),
        "j": _rounded(truth.f_s - truth.f_d),
    }
    return fault if valve.closing == 1 else fault | {"closing_over_opening": valve.closing}


def _slack(scenario: Scenario) -> Fault:
    return {"dead_band": scenario.valve.backlash} if scenario.valve.backlash else {}


def _rate(scenario: Scenario) -> Fault:
    return {} if scenario.valve.rate is None else {"op_per_s": scenario.valve.rate}


def _stops(scenario: Scenario) -> Fault:
    return (
        {}
        if scenario.valve.stops is None
        else {"low": scenario.valve.stops[0], "high": scenario.valve.stops[1]}
    )


def _trim(scenario: Scenario) -> Fault:
    return {} if scenario.valve.rangeability == 1 else {"rangeability": scenario.valve.rangeability}


def _positioner(scenario: Scenario) -> Fault:
    return {"lag_s": scenario.valve.tau_ip} if scenario.valve.tau_ip > ORDINARY_LAG else {}


def _sensor(scenario: Scenario) -> Fault:
    return {"lag_s": scenario.sensor_tau} if scenario.sensor_tau else {}


def _second_lag(scenario: Scenario) -> Fault:
    return {} if scenario.process.tau2 is None else {"lag_s": scenario.process.tau2}


def _inverse(scenario: Scenario) -> Fault:
    return {"lead_s": scenario.process.lead} if scenario.process.lead else {}


def _integrating(scenario: Scenario) -> Fault:
    return {"gain": scenario.process.gain} if scenario.process.kind == "integrating" else {}


def _wave(scenario: Scenario) -> Fault:
    wave = scenario.disturbance
    return {"amplitude": wave.amplitude, "period_s": wave.period} if wave.amplitude else {}


def _loads(scenario: Scenario) -> Fault:
    steps = [{"time_s": step.time, "load": step.load} for step in scenario.load_steps]
    return {"steps": steps} if steps else {}


def _gains(scenario: Scenario) -> Fault:
    steps = [{"time_s": step.time, "factor": step.factor} for step in scenario.gain_steps]
    return {"steps": steps} if steps else {}


def _tuning(scenario: Scenario) -> Fault:
    peak = scenario.peak_sensitivity
    return {"peak_sensitivity": _rounded(peak) if peak < 1e6 else "unstable"} if peak > TIGHT else {}


FAULTS: Mapping[str, Callable[[Scenario], Fault]] = {
    "stiction": _stiction,
    "slack": _slack,
    "rate_limit": _rate,
    "stops": _stops,
    "trim": _trim,
    "slow_positioner": _positioner,
    "slow_transmitter": _sensor,
    "second_lag": _second_lag,
    "inverse_response": _inverse,
    "integrating": _integrating,
    "load_wave": _wave,
    "load_steps": _loads,
    "gain_changes": _gains,
    "tight_tuning": _tuning,
}
"""Fault -> what of a scenario shows it."""


def shipped(folder: Path = FOLDER) -> dict[str, Path]:
    """Return the scenarios of a folder, those in its folders too: name -> file."""
    files = sorted(each for each in folder.rglob("*.yaml") if each.name != TRUTH)
    return {file.relative_to(folder).with_suffix("").as_posix(): file for file in files}


def scenario_path(name: str, folder: Path = FOLDER) -> Path:
    """Return the file of a scenario that ships in a folder, by its name; else the name as a path."""
    own = Path(name)
    return own if own.exists() else shipped(folder).get(name.removesuffix(".yaml"), own)


def truth_of(folder: Path = FOLDER) -> dict[str, dict[str, Any]]:
    """Return name -> loop, verdict that is right, and what is hidden, of all scenarios of a folder."""
    found = {}
    for name, file in shipped(folder).items():
        scenario = load_scenario(file)
        truth = scenario.truth
        found[name] = {
            "loop": scenario.loop,
            "verdict": truth.verdict,
            "cause": truth.cause,
            "faults": hidden_faults(scenario),
        }
    return found


def _rounded(value: float) -> float:
    return float(f"{value:.4g}")


def main() -> None:
    """Print the truth of the scenarios that ship."""
    sys.stdout.write(
        "# Every hidden fault of the scenarios beside. Written by: python -m simulators.hidden_faults\n"
    )
    yaml.safe_dump(truth_of(), sys.stdout, sort_keys=False, default_flow_style=None, width=110)


if __name__ == "__main__":
    main()
