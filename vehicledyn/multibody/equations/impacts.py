"""Impacts: rates that jump by impulses while all constraints hold before and after.

With impulses P along some directions E of the rates v, and Λ of the constraints J v + b = 0,

    M (v⁺ - v⁻) = Jᵀ Λ + Eᵀ P,    J v⁺ + b = 0,    E v⁺ as demanded,

and the positions stay. In independent rates w, where v = T w + ..., the Λ drop out:
Tᵀ M T (w⁺ - w⁻) = (E T)ᵀ P (Pfeiffer, Glocker (1996), Multibody Dynamics with Unilateral Contacts,
Wiley).

Where a constraint goes over to another solution of its dependent coordinates, as a contact that
jumps, the old constraint comes free and the new one holds from then on, T becoming T̂: an inelastic
impact, M (v⁺ - v⁻) = Ĵᵀ Λ and Ĵ v⁺ + b̂ = 0. With v̂ the rates that w⁻ has there,
T̂ᵀ M T̂ (w⁺ - w⁻) = T̂ᵀ M (v⁻ - v̂).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.multibody.equations.outputs import Solved
from vehicledyn.multibody.loops.loop_closure import Loops
from vehicledyn.multibody.model.parts import PartEvent
from vehicledyn.multibody.model.symbols import Symbols
from vehicledyn.multibody.recursion.mass_matrix import mass_matrix
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.elimination import Rows, solve_symmetric
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.sparse_rows import rows_of


@dataclass(frozen=True)
class Demand:
    """What an impulse must achieve: the change of Σ gradient · rate, over all coordinates."""

    gradient: dict[int, Scalar]
    change: Scalar


class Impacts:
    """The jumps of the independent rates of a solved system."""

    def __init__(
        self,
        symbols: Symbols,
        loops: Loops,
        solved: Solved,
        independent: Sequence[int],
        respond: Callable[[dict[int, Scalar]], list[Scalar]] | None = None,
    ) -> None:
        """Keep what is needed; ``independent`` are indices of coordinates.

        ``respond`` gives the jumps of the independent rates by a unit impulse along a gradient,
        where constraints hold them together. Nothing is derived before the first impact.
        """
        self._respond = respond
        self._symbols, self._loops, self._solved = symbols, loops, solved
        self._independent = list(independent)
        self._rows: tuple[Rows, dict[int, dict[int, Scalar]]] | None = None

    def rates_after(self, name: str, event: PartEvent) -> dict[str, Scalar]:
        """Return the rates of all independent coordinates after an event, by state.

        Raises
        ------
        InputError
            If the event demands a rate that no impulse can give.
        """
        demands = [*self._rates(name, event), *self._rebound(name, event)]
        joints = self._symbols.joints
        before = [self._solved.rates[joints[k].name] for k in self._independent]
        jumps = self._jumps(demands)
        return {
            joints[k].rate_name: rate + jump
            for k, rate, jump in zip(self._independent, before, jumps, strict=True)
        }

    def rates_after_landing(self, places: dict[str, Scalar]) -> dict[str, Scalar]:
        """Return the rates of all independent coordinates when dependent ones go to other places.

        Parameters
        ----------
        places
            New values of dependent coordinates, by name.
        """
        spread = self._reduced()[1]
        mass = self._mass_of(spread)
        joints, rates = self._symbols.joints, self._solved.rates
        moving = [k for k in spread if k in mass]
        entries = [(k, i) for k in moving for i in spread[k]]
        now = [*(spread[k][i] for k, i in entries), *(rates[joints[k].name] for k in moving)]
        there = ops.flat(
            ops.substitute(
                ops.column(now),
                ops.column([self._symbols.coordinates[name] for name in places]),
                ops.column(list(places.values())),
            )
        )
        landed: dict[int, dict[int, Scalar]] = {k: {} for k in moving}
        for number, (k, i) in enumerate(entries):
            landed[k][i] = there[number]
        lost = {
            k: rates[joints[k].name] - there[len(entries) + number]
            for number, k in enumerate(moving)
        }
        whole: Rows = [{} for _ in self._independent]
        taken = [ops.scalar(0.0) for _ in self._independent]
        for a in moving:
            for b, value in mass[a].items():
                for i, left in landed[a].items():
                    taken[i] = taken[i] + left * value * lost[b]
                    for j, right in landed[b].items():
                        whole[i][j] = whole[i].get(j, 0.0) + left * (value * right)
        jumps = solve_symmetric(whole, taken)
        return {
            joints[k].rate_name: rates[joints[k].name] + jump
            for k, jump in zip(self._independent, jumps, strict=True)
        }

    def _rates(self, name: str, event: PartEvent) -> list[Demand]:
        index = {j.name: k for k, j in enumerate(self._symbols.joints)}
        demands = []
        for coordinate, wanted in event.impulses.items():
            if coordinate not in index:
                raise InputError(
                    f"event '{name}' resets the rate of "
                    f"{unknown_name('coordinate', coordinate, index)}"
                )
            k = index[coordinate]
            if self._symbols.joints[k].role == "driven":
                raise InputError(
                    f"event '{name}' resets the rate of '{coordinate}', which is driven"
                )
            change = wanted - self._solved.rates[coordinate]
            demands.append(Demand({k: ops.scalar(1.0)}, change))
        return demands

    def _rebound(self, name: str, event: PartEvent) -> list[Demand]:
        """Return the demand that the function of the event goes back as it came."""
        if event.restitution is None:
            return []
        s = self._symbols
        function = ops.scalar(event.expression)
        slopes = s.by_speeds(ops.jacobian(function, s.coordinate_column))
        (gradient,) = rows_of(slopes) or ({},)
        if not gradient or ops.depends_on(function, s.rate_column):
            raise InputError(
                f"event '{name}' has a restitution, so its function must be one of coordinates "
                "and positions, not of rates"
            )
        speed = ops.derivative(function, s.time, 1.0)
        for k, slope in gradient.items():
            speed = speed + slope * self._solved.rates[s.joints[k].name]
        return [Demand(gradient, -(1.0 + event.restitution) * speed)]

    def _jumps(self, demands: Sequence[Demand]) -> list[Scalar]:
        """Return w⁺ - w⁻ of the independent rates."""
        count = len(self._independent)
        reach, answers = self._answers(demands)
        size = range(len(demands))
        yielding: Rows = [
            {
                j: sum((v * answers[j][k] for k, v in reach[i].items()), start=ops.scalar(0.0))
                for j in size
            }
            for i in size
        ]
        impulses = solve_symmetric(yielding, [ops.scalar(d.change) for d in demands])
        return [
            sum((answers[i][k] * impulses[i] for i in size), start=ops.scalar(0.0))
            for k in range(count)
        ]

    def _answers(
        self, demands: Sequence[Demand]
    ) -> tuple[list[dict[int, Scalar]], list[list[Scalar]]]:
        """Return the demands over the independent rates, and the jumps by their unit impulses."""
        if self._respond is not None:
            place = {k: i for i, k in enumerate(self._independent)}
            gradients = [{k: v for k, v in d.gradient.items() if k in place} for d in demands]
            reach = [{place[k]: v for k, v in row.items()} for row in gradients]
            return reach, [self._respond(row) for row in gradients]
        mass, spread = self._reduced()
        reach = [self._along(demand.gradient, spread) for demand in demands]
        sides = [[row.get(k, ops.scalar(0.0)) for k in range(len(mass))] for row in reach]
        return reach, [solve_symmetric(mass, side) for side in sides]

    def _along(
        self, gradient: dict[int, Scalar], spread: dict[int, dict[int, Scalar]]
    ) -> dict[int, Scalar]:
        """Return a gradient over the independent rates."""
        found: dict[int, Scalar] = {}
        for coordinate, slope in gradient.items():
            for k, entry in spread.get(coordinate, {}).items():
                found[k] = found.get(k, 0.0) + slope * entry
        return found

    def _reduced(self) -> tuple[Rows, dict[int, dict[int, Scalar]]]:
        """Return Tᵀ M T and the rows of T by coordinate."""
        if self._rows is not None:
            return self._rows
        place = {k: i for i, k in enumerate(self._independent)}
        spread = {k: {i: ops.scalar(1.0)} for k, i in place.items()}
        for k, row in self._loops.closure.influence(self._independent).items():
            spread[k] = {place[v]: entry for v, entry in row.items()}
        rows: Rows = [{} for _ in self._independent]
        for a, others in self._mass_of(spread).items():
            for b, value in others.items():
                for i, left in spread[a].items():
                    for j, right in spread[b].items():
                        rows[i][j] = rows[i].get(j, 0.0) + left * (value * right)
        self._rows = rows, spread
        return self._rows

    def _mass_of(self, coordinates: Iterable[int]) -> dict[int, dict[int, Scalar]]:
        """Return the entries of M by coordinates, both halves."""
        names = [j.name for j in self._symbols.joints]
        index = {name: k for k, name in enumerate(names)}
        found: dict[int, dict[int, Scalar]] = {}
        entries = mass_matrix(self._solved.kinematics, {names[k] for k in coordinates})
        for (a, b), value in entries.items():
            found.setdefault(index[a], {})[index[b]] = value
        return found
