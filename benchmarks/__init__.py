"""What `make bench` runs: how often and how well slipjump is right, and how long it takes."""

from __future__ import annotations

import os

# Times are those of one core; set here, because NumPy reads it when it is imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
