"""What `make bench` runs: how often and how well slipjump is right, and how long it takes."""

from __future__ import annotations

import os

# Times are told for one core; set here, since NumPy reads it as it is imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
