"""Imported first by the process from which all workers come: it stops to look for garbage.

What is imported stays for ever. Searching it again and again, as it grows by a thousand modules, is a tenth
of the start. Each worker looks for garbage again from its first task (``process_pool``).
"""

from __future__ import annotations

import gc

gc.disable()
