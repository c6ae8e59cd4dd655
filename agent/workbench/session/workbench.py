"""The workbench: compare, see where it fails, learn what is missing, add it, watch the error fall."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.workbench.session.automatic import add_all_confirmed
from agent.workbench.session.bench import Bench
from agent.workbench.session.compared import compared
from agent.workbench.session.restoring import add_saved

if TYPE_CHECKING:
    from agent.workbench.comparison import Comparison
    from agent.workbench.step import Step


class Workbench(Bench):
    """A bench that also works by itself, goes on from a saved model and sums up."""

    def auto(self) -> tuple[Step, ...]:
        """Add what is confirmed until nothing more is; after each, test the earlier effects again."""
        if self.reason is None:
            add_all_confirmed(self)
        return self.staircase()

    def load(self, mapping: object) -> tuple[Step, ...]:
        """Add the effects of a saved model one after the other, fitted from its values; return all steps.

        Raises:
            ValueError: It is no saved model, of another loop or on another base, or has unknown effects.
        """
        add_saved(self, mapping)
        return self.staircase()

    def comparison(self) -> Comparison:
        """Return all that is known: the staircase, and the verdict on its newest model."""
        return compared(self)
