"""Shared functions that carry several places of one case side by side, in units of their own."""

from __future__ import annotations

from dataclasses import dataclass, field

from vehicledyn.codegen.passes.loop_rolling import is_deep
from vehicledyn.codegen.passes.lowering import Lowered
from vehicledyn.codegen.passes.scheduling import Pack
from vehicledyn.codegen.printers.function_body import SHARED_ARRAYS


@dataclass
class WideFunctions:
    """Shared functions of a kernel of one lane that carry several places side by side.

    The places of one call, such as the wheels of a train, fill the lanes that the cases of a
    sweep fill otherwise. These functions are units of their own, as they see other reals;
    ``units`` holds their text by number of lanes, ``lanes`` is what the processor carries.
    """

    lanes: int
    units: dict[int, list[str]] = field(default_factory=dict)

    def lanes_for(self, lowered: Lowered) -> dict[int, int]:
        """Return the lanes of each shared function that is called at several places at once.

        Where functions wait for one another they are called in loops instead.
        """
        if is_deep(lowered):
            return {}
        most: dict[int, int] = {}
        for step in lowered.steps:
            if isinstance(step, Pack) and step.shared is not None:
                most[step.shared] = max(most.get(step.shared, 0), len(step.operands))
        return {
            number: min(self.lanes, 4 if count <= 4 else 8)
            for number, count in most.items()
            if count > 1 and self.lanes > 1
        }

    def take(self, lanes: int, name: str, text: str) -> None:
        """Keep the text of a shared function, and what other units call it by."""
        entry = f"void {name}_wide({SHARED_ARRAYS}) {{\n  {name}(a, rows, r0);\n}}\n"
        self.units.setdefault(lanes, []).append(text + entry)
