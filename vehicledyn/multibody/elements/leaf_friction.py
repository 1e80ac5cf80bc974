"""Friction between the leaves of leaf springs: bounded, with elastic presliding."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from vehicledyn.base.registry import register
from vehicledyn.base.shapes import Shape
from vehicledyn.multibody.elements.point_forces import Attachment, LineOfAction, coil_between
from vehicledyn.multibody.model.declaration import attachment, function, number, vector
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel, Variable
from vehicledyn.symbolic.ops import Scalar

SHARE = "share"


@register("element_type", "leaf_friction")
@dataclass(frozen=True, kw_only=True)
class LeafFriction(BasePart):
    """Friction of a leaf spring between two points, that nears its limit exponentially.

    With the length L between the points and the share z of the friction, a state,

        F = H z,    β ż = L̇ - |L̇| z

    F is positive in tension. After each reversal F nears the limit H, with the sign of L̇, over
    the length β: F = ±H + (F₀ ∓ H) exp(-|L - L₀|/β). It never exceeds H, keeps its value at rest,
    and adds the slope H/β to small motions. A motion of the amplitude A takes the energy
    4 H (A - β tanh(A/β)) a cycle. The limit may depend on the load, as it does where leaves are
    pressed together. The spring itself is an element of its own. The part of the spring's force
    that the source lets lag as well does not.

    References
    ----------
    Fancher, Ervin, MacAdam, Winkler (1980), Measurement and representation of the mechanical
    properties of truck leaf springs, SAE paper 800905.
    """

    a: Attachment = attachment("One end")
    b: Attachment = attachment("The other end")
    limit: Callable[[Situation], Scalar] = function("N", "Limit H, not negative", of="motion")
    transition: Scalar = number("m", "Length β over which the limit is neared", above=0.0)
    direction: Sequence[Scalar] | None = vector(
        "1",
        "Unit vector in the axes of body a; then the force acts along it and the length is "
        "measured along it from b to a",
        default=None,
    )

    def states(self) -> tuple[Variable, ...]:
        """Return the share of the friction that acts."""
        return (Variable(SHARE, "1", f"Share of the friction of {self.name} that acts"),)

    def loads(self, situation: Situation) -> Loads:
        """Return the pair of opposite forces and the rate of the share."""
        line = self._line(situation)
        rate, share = line.rate, situation.states[SHARE]
        return Loads(
            wrenches=line.pair(line.direction * self._force(situation)),
            rates={SHARE: (rate - ops.absolute(rate) * share) / self.transition},
        )

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return force and power."""
        force, name = self._force(situation), self.name
        power = force * self._line(situation).rate
        words = f"Friction force of {name}, positive in tension"
        return (
            Output(Channel(f"{name}.force", "N", words), force),
            Output(Channel(f"{name}.power", "W", f"Power that {name} takes"), power),
        )

    def shapes(self) -> tuple[Shape, ...]:
        """Return a spring between the points."""
        return (coil_between(self.name, self.a, self.b),)

    def _line(self, situation: Situation) -> LineOfAction:
        kinematics = situation.kinematics
        if self.direction is None:
            return LineOfAction.between(kinematics, self.a, self.b)
        return LineOfAction.along(kinematics, self.a, self.b, self.direction)

    def _force(self, situation: Situation) -> Scalar:
        limit = ops.maximum(self.limit(situation), 0.0)
        return limit * situation.states[SHARE]
