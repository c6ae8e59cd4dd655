"""Weights of the evidence: log odds that a method adds when it says stiction, and takes when no stiction.

Fitted by ``python -m benchmarks evidence_weights`` on 346 simulated loops of fourteen kinds, seeds 3000 to
3013 and for six hard kinds 3040 to 3064 as well (``simulators.draws.random_plants``, ``random_moves``,
``random_flows``, ``random_cascades``), never on recordings, with the code of decision 121. 0.00: worthless
there beside the others.
"""

from __future__ import annotations

BIAS = -2.54
"""Log odds before anybody has spoken; six of the fourteen kinds stick."""
FREE_RUN = 0.60
"""Of its evidence over the turns of the valve, which goes from 0 to 1."""
FREE_RUN_QUICK = 1.10
"""Of its quick evidence, likewise."""
INNOVATIONS_OVER_TURNS = 2.89
"""Of the log likelihood ratio, likewise."""
INNOVATIONS = 4.46
"""Of the log likelihood ratio as it is."""
DETECTORS = {
    "horch_ccf": 0.00,
    "horch_histogram": 0.00,
    "singhal_salsbury": 0.00,
    "kano_a": 0.00,
    "kano_b": 0.00,
    "yamashita": 0.37,
    "he_curve_fit": 0.73,
    "rossi_scali": 0.27,
    "hagglund_shape": 0.02,
    "hagglund_backlash": 0.00,
    "damarla": 0.89,
    "srinivasan_dtw": 0.00,
    "bicoherence": 0.04,
    "choudhury_ellipse": 0.05,
    "choudhury_cmeans": 0.05,
    "thornhill_surrogates": 0.45,
}
WITH_STEM = {
    "kano_a": 3.23,
    "kano_b": 0.60,
    "yamashita": 0.48,
    "damarla": 0.87,
}
"""Where MV is measured; takes the place of the former."""
