"""Weights of the evidence: log odds that a method adds when it says stiction, and takes when no stiction.

Fitted by ``python -m benchmarks evidence_weights`` on 346 simulated loops of fourteen kinds, seeds 3000 to
3013 and for six hard kinds 3040 to 3064 as well (``simulators.draws.random_plants``, ``random_moves``,
``random_flows``, ``random_cascades``), never on recordings, with the code of decision 155. 0.00: worthless
there beside the others.
"""

from __future__ import annotations

BIAS = -2.80
"""Log odds before anybody has spoken; six of the fourteen kinds stick."""
FREE_RUN = 0.15
"""Of its evidence over the turns of the valve, which goes from 0 to 1."""
FREE_RUN_QUICK = 0.79
"""Of its quick evidence, likewise."""
INNOVATIONS_OVER_TURNS = 3.01
"""Of the log likelihood ratio, likewise."""
INNOVATIONS = 5.02
"""Of the log likelihood ratio as it is."""
DETECTORS = {
    "horch_ccf": 0.11,
    "horch_histogram": 0.00,
    "singhal_salsbury": 0.00,
    "kano_a": 0.00,
    "kano_b": 0.00,
    "yamashita": 0.29,
    "he_curve_fit": 0.00,
    "rossi_scali": 0.35,
    "hagglund_shape": 0.02,
    "hagglund_backlash": 0.00,
    "damarla": 0.76,
    "srinivasan_dtw": 0.00,
    "bicoherence": 0.05,
    "choudhury_ellipse": 0.06,
    "choudhury_cmeans": 0.06,
    "thornhill_surrogates": 0.60,
}
WITH_STEM = {
    "kano_a": 2.82,
    "kano_b": 0.31,
    "yamashita": 0.76,
    "damarla": 0.97,
}
"""Where MV is measured; takes the place of the former."""
