"""Weights of the evidence: log odds that a method adds when it says stiction, and takes when no stiction.

Fitted by ``python -m benchmarks evidence_weights`` on 290 simulated loops of ten kinds, seeds 3000 to 3013
and for the six hard kinds 3040 to 3064 as well (``simulators.random_plants``, ``random_moves``,
``random_flows``), never on recordings. The search of ``free_run`` was that of commit fe2d33c. 0.00: worthless
there beside the others.
"""

from __future__ import annotations

BIAS = -2.46
"""Log odds before anybody has spoken; four of the ten kinds stick."""
FREE_RUN = 1.96
"""Of its evidence over the turns of the valve, which goes from 0 to 1."""
FREE_RUN_QUICK = 0.75
"""Of its quick evidence, likewise."""
INNOVATIONS_OVER_TURNS = 3.44
"""Of the log likelihood ratio, likewise."""
INNOVATIONS = 3.26
"""Of the log likelihood ratio as it is."""
DETECTORS = {
    "horch_ccf": 0.00,
    "horch_histogram": 0.00,
    "singhal_salsbury": 0.00,
    "kano_a": 0.00,
    "kano_b": 0.38,
    "yamashita": 0.52,
    "he_curve_fit": 1.15,
    "rossi_scali": 0.98,
    "hagglund_shape": 1.40,
    "hagglund_backlash": 0.00,
    "damarla": 1.39,
    "srinivasan_dtw": 0.00,
    "bicoherence": 0.00,
    "choudhury_ellipse": 0.00,
    "choudhury_cmeans": 0.00,
    "thornhill_surrogates": 0.16,
}
WITH_STEM = {
    "kano_a": 2.92,
    "kano_b": 1.16,
    "yamashita": 0.79,
    "damarla": 0.22,
}
"""Where MV is measured; takes the place of the former."""
