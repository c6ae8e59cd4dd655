"""Weights of the evidence: log odds that a method adds when it says stiction, and takes when no stiction.

Fitted by ``python -m benchmarks evidence_weights`` on 400 simulated loops, seeds 3000 to 3049 of each of
eight kinds (``simulators.random_plants``, ``random_moves``), never on recordings. The search of ``free_run``
was that of commit 047c414. 0.00: worthless there beside the others. Kano B and
Yamashita earn their weight only where the stem is measured.
"""

from __future__ import annotations

BIAS = -2.50
"""Log odds before anybody has spoken; three of the eight kinds stick."""
FREE_RUN = 4.72
"""Of its evidence over the turns of the valve, which goes from 0 to 1."""
FREE_RUN_QUICK = 3.27
"""Of its quick evidence, likewise."""
DETECTORS = {
    "horch_ccf": 0.00,
    "horch_histogram": 0.00,
    "singhal_salsbury": 0.00,
    "kano_a": 0.00,
    "kano_b": 0.00,
    "yamashita": 0.00,
    "he_curve_fit": 0.72,
    "rossi_scali": 0.09,
    "hagglund_shape": 1.88,
    "hagglund_backlash": 0.00,
    "damarla": 0.78,
    "srinivasan_dtw": 0.00,
    "bicoherence": 0.05,
    "choudhury_ellipse": 0.76,
    "choudhury_cmeans": 0.76,
    "thornhill_surrogates": 0.77,
}
WITH_STEM = {
    "kano_a": 2.25,
    "kano_b": 0.45,
    "yamashita": 1.11,
    "damarla": 0.63,
}
"""Where MV is measured; takes the place of the former."""
