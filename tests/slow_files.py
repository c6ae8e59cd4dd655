"""The slowest files of tests, in the order in which they start; all others follow as they were collected.

The run ends with short ones, so that no worker is left with a long one while the others have nothing. One in
three waits for a peer (sockets, a browser, a child process) and leaves its core to the others. A file that is
missing here, or out of place, costs time only.
"""

from __future__ import annotations

SLOW_FILES = (
    "integration/test_replay.py",
    "unit/workbench/test_valves_shared.py",
    "docs/test_pages.py",
    "unit/workbench/test_several.py",
    "contracts/test_quantifiers.py",
    "browser/test_workbench_page.py",
    "unit/simulators/test_loops_that_hide_an_effect.py",
    "unit/workbench/test_checks_lower.py",
    "unit/workbench/test_without_noise.py",
    "browser/test_page.py",
    "unit/quantify/test_free_run.py",
    "unit/workbench/test_pairs.py",
    "unit/workbench/test_harmonics.py",
    "faults/test_matrix.py",
    "unit/workbench/test_session.py",
    "unit/workbench/test_other_event.py",
    "unit/workbench/test_adequate.py",
    "contracts/test_connector_kinds.py",
    "integration/test_cli_diagnose.py",
    "unit/analysis/test_recording_diagnosis.py",
    "integration/test_demo.py",
    "unit/physics/test_oscillatory.py",
    "unit/workbench/test_own_effect.py",
    "unit/workbench/test_inputs.py",
    "unit/web/test_workbench_sessions.py",
    "unit/workbench/test_order_three.py",
    "unit/workbench/test_hidden_rival.py",
    "unit/cli/test_run_as_a_service.py",
    "unit/workbench/test_wave_lines.py",
    "accuracy/test_real_valves_in_the_workbench.py",
    "integration/test_serve.py",
    "unit/quantify/test_free_run_gaps.py",
    "unit/workbench/test_guided.py",
    "unit/cli/test_run_and_check.py",
    "unit/workbench/test_shown.py",
    "unit/workbench/test_confirmed_on_every_path.py",
    "unit/runtime/test_workers.py",
    "integration/test_cli_compare.py",
    "faults/test_soak.py",
    "unit/workbench/test_validation_in_motion.py",
    "unit/workbench/test_same_numbers_of_a_comparison.py",
    "contracts/test_sources.py",
    "unit/analysis/test_controller_action.py",
    "unit/simulators/test_random_plants.py",
    "integration/test_opcua.py",
)


def place(file: str) -> int:
    """Return where a file, from the folder of the tests, comes: those that are not slow last, and alike."""
    return SLOW_FILES.index(file) if file in SLOW_FILES else len(SLOW_FILES)
