"""What scenarios, studies and analyses ask of a model, whatever parts it has."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.ports import Ports
from vehicledyn.multibody.model.system import System
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.symbolic.equations import Channel, Equations

if TYPE_CHECKING:
    from vehicledyn.base.shapes import Shape
    from vehicledyn.results.store.layout import SceneItem, SummaryEntry
    from vehicledyn.road.manoeuvres.manoeuvre import RoadManoeuvre

Vector = NDArray[np.float64]


class Subject(Protocol):
    """A system with all that a run asks about it: how it starts, what is drawn and summed up."""

    @property
    def system(self) -> System:
        """The complete system."""

    @property
    def ports(self) -> Ports:
        """Where it is steered, driven and watched."""

    def with_system(self, system: System) -> Self:
        """Return the same with another system, such as one with more parts."""

    def in_manoeuvre(self, manoeuvre: RoadManoeuvre) -> Self:
        """Return the same with key figures of another manoeuvre, if it drives any."""

    @property
    def usual_start(self) -> str:
        """How a scenario starts that does not say it: "nominal", "static" or "steady".

        Only models with "steady" can start so: they run straight ahead at a speed.
        """

    @property
    def balance_time(self) -> float:
        """Time at which a start is balanced [s]."""

    @property
    def settling(self) -> float | None:
        """How far a state may move in a step towards an equilibrium before contacts carry.

        None where no contact is open at the start [m or rad].
        """

    @property
    def given_rates(self) -> dict[str, float]:
        """Rates that the start must have, by coordinate, where it matters, in SI."""

    def parameters_at(self, speed: float) -> dict[str, float]:
        """Return the parameters that depend on the speed [m/s], by name, in SI."""

    def start_state(self, equations: Equations, speed: float) -> Vector:
        """Return the states to start from, at a speed [m/s], shape (n_states,)."""

    def still_state(self, equations: Equations) -> Vector:
        """Return the same states at rest."""

    def balance_pairs(self, equations: Equations, speed: float) -> tuple[list[int], list[int]]:
        """Return the states to move and the rates to balance for an equilibrium at a speed."""

    def scene(self) -> dict[str, SceneItem]:
        """Return static things to show in pictures."""

    def shapes(self) -> tuple[Shape, ...]:
        """Return shapes that no part of the system offers."""

    def plots(self, channels: Sequence[Channel]) -> list[dict[str, Any]]:
        """Return descriptions of the standard figures of a system with these channels."""

    def channels(self, equations: Equations) -> list[str]:
        """Return the channels that the summary is made from."""

    def summarise(self, recording: Recording) -> list[SummaryEntry]:
        """Return the key figures of a run."""


def start_values(equations: Equations) -> Vector:
    """Return the states as the system itself gives them, shape (n_states,)."""
    return np.array([s.start for s in equations.states])


def index_of(equations: Equations, state: str) -> int:
    """Return the index of a state by name."""
    return next(k for k, s in enumerate(equations.states) if s.name == state)
