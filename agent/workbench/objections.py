"""What may reject an effect although it lowers the held-out error, each in words for the user."""

from __future__ import annotations

NOT_LOWER = "it does not lower the error where it was fitted"
ANSWERS = "the innovations do not fall: it repeats what the controller does"
UNLIKELY = "the record is far more likely with another effect"
STANDS_FOR_ANOTHER = "with it the model still fails as before: it stands for another cause"
WAVE = "it leaves a wave from outside that is most of the residual"
SLOW_NOISE = "slow noise makes such a wave as well"
BY_CHANCE = "the innovations show no such event: one as large appears by chance"
OTHER_EVENT = "what happened was of another kind"
