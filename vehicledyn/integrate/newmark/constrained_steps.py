"""Steps of Newmark's family on residuals with multipliers: index 3, and stabilised index 2.

With acceleration-like a, q̇ = v and residuals F(q, v, v̇, λ) = 0, h(q) = 0 a step solves

    (1 - αm) a₁ + αm a₀ = (1 - αf) v̇₁ + αf v̇₀,        v₁ = v₀ + Δt ((1 - γ) a₀ + γ a₁),
    q₁ = q₀ + Δt v₀ + Δt² ((½ - β) a₀ + β a₁) - ½ Δt W (J₀ + J₁)ᵀ η₁,

where η is zero in index 3, and found from J v₁ + h_t = 0 in stabilised index 2 (Gear, Gupta,
Leimkuhler). The unknowns are a₁, λ₁ and η₁; gaps are divided by β Δt² and openings by γ Δt, so that
the iteration matrix keeps its condition as Δt → 0. W, the inverse of the diagonal of the masses
where the model starts, makes η free of units.

Both ends of a step share alike in the correction, so undamped steps taken backwards lead back: that
keeps the energy of swinging mechanisms within a band (Hairer, Lubich, Wanner (2006), Geometric
Numerical Integration, section XI.3). With the Jacobian of one end alone it drifts.

Where a motion starts at v, the steps begin with v₀ = v + Δt² C b, C = 1/6 - (αm - αf)/2 - β, and
a₀ = v̇ + Δt (αm - αf) b, b being the third derivative of q that the constraints demand: steps of
index 3 keep such velocities, and others swing about them. So velocities and multipliers are of
order two from the first step on. Stabilised steps begin with v. Where the size of steps changes,
a - v̇ changes as the size, and the part of v₀ that misses the constraints as its square.

Arnold, Brüls (2007), Multibody System Dynamics 18, 185-202; Bottasso, Bauchau, Cardona (2007),
SIAM Journal on Scientific Computing 29, 397-414 (scaling); Arnold, Brüls, Cardona (2015),
Numerische Mathematik 129, 149-179 (starts, stabilised index 2).
"""

from __future__ import annotations

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.course import MethodState
from vehicledyn.integrate.events import ConsistentPoint
from vehicledyn.integrate.newmark.constrained_place import (
    ConstrainedPlace,
    KnownOfStep,
    resumed_place,
    slope_of_lift,
)
from vehicledyn.integrate.newmark.iteration_matrix import (
    IterationMatrix,
    StepFactors,
    Unknowns,
    pushed,
)
from vehicledyn.integrate.newmark.residual_functions import (
    Instant,
    Partials,
    Residuals,
    Sparse,
    lightness_of,
    residual_functions,
)
from vehicledyn.integrate.newmark.weights import Constraints, Velocities, Weights
from vehicledyn.integrate.task import Task
from vehicledyn.kernel.engine import Count, Vector

_MOST_ITERATIONS = 12
_CLOSE, _COARSEST = 1e-14, 1e-6
"""Error of Newton's iteration allowed in each state, for one plus its size; without multipliers
a part of the local error of positions, within these bounds."""
_CLOSE_FORCES = 1e-9
"""Error of Newton's iteration allowed in the multipliers, as a part of the largest."""
_FEW, _CLOSEST, _CLOSEST_FORCES = 12, 1e-16, 1e-13
"""States up to which both are solved to rounding, which costs little there, and what is allowed."""
_LEVER = 1e-2
"""Weight of the relative error of the multipliers beside that of the states."""
_SLOW = 0.3
"""Contraction above which the Jacobian is found anew at the next step."""
_ROUNDING = 1e-8
"""Change that is taken for rounding where it no longer falls; with a Jacobian of an earlier step it
may fall slowly above the rounding of gaps, so it is found anew."""
_SAME = 1e-9
"""Part of a step by which steps of one size may differ."""
_COARSE = 1e-3
"""Rounding of multipliers, as a part of the largest; it grows by 1 / (β Δt²) and at dead points."""


class ConstrainedSteps:
    """Takes steps of any size, keeping Jacobian and factors while Newton's method converges.

    constrained.c holds the same algorithm; change both together.
    """

    def __init__(
        self,
        task: Task,
        weights: Weights,
        constraints: Constraints,
        velocities: Velocities = "own",
    ) -> None:
        """Take the residuals of the task's equations.

        Raises
        ------
        InputError
            If the equations have none, see :func:`~vehicledyn.multibody.derive`.
        """
        self._task, self._weights = task, weights
        self._functions = residual_functions(task.kernel)
        self.is_stabilised = constraints == "stabilised_index2"
        self.shows_own = velocities == "own" and self._functions.shows_own
        is_small = len(task.kernel.equations.states) <= _FEW
        self.close, self.close_forces = (
            (_CLOSEST, _CLOSEST_FORCES) if is_small else (_CLOSE, _CLOSE_FORCES)
        )
        self._lightness = lightness_of(task.kernel) if self.is_stabilised else None
        self._matrix = IterationMatrix(self._functions.sizes, self._lightness)
        self._factors: StepFactors | None = None
        self._is_stale = True
        self._mean: Sparse | None = None
        self._back: tuple[ConstrainedPlace, Vector] | None = None

    @property
    def lightness(self) -> Vector | None:
        """W, None where η is not needed."""
        return self._lightness

    def _pushed(self, jacobian: Sparse | None, eta: Vector) -> Vector | float:
        """Return how fast η moves the coordinates, nothing where it is not needed."""
        if jacobian is None or self._lightness is None:
            return 0.0
        return pushed(jacobian, self._lightness, eta)

    def _mean_jacobian(self, begin: Instant, end: Instant) -> Sparse | None:
        """Return the mean Jacobian of the constraints, None where η is not needed."""
        if self._lightness is None:
            return None
        one, other = (self._functions.jacobian(at, self._parameters) for at in (begin, end))
        return one._replace(values=0.5 * (one.values + other.values))

    @property
    def factors(self) -> StepFactors | None:
        """Factors of the latest step."""
        return self._factors

    @property
    def _parameters(self) -> Vector:
        return self._task.kernel.parameters

    def start(self, point: ConsistentPoint) -> ConstrainedPlace:
        """Return the place from which the motion starts, or starts anew.

        Velocities are put onto the constraints; accelerations and multipliers are those of the
        constrained motion there.
        """
        n, _, m = self._functions.sizes
        e = self._functions.equations
        state = point.state.copy()
        q, v, s = (state[list(k)] for k in (e.positions, e.velocities, e.others))
        still = Instant(point.time, q, v, np.zeros(n), np.zeros(m), s)
        at = self._evaluated(still)
        partials = self._functions.partials(still, self._parameters)
        if m:
            v = v + self._matrix.accelerations(partials, np.zeros(n), at.opening)[0]
            state[list(e.velocities)], still = v, still._replace(velocity=v)
            at = self._evaluated(still)
        lift = self._functions.lift(still, self._parameters)
        a, multiplier = self._matrix.accelerations(partials, at.force, lift)
        self._is_stale = True
        instant = still._replace(acceleration=a, multiplier=multiplier)
        kept = ConsistentPoint(point.time, state, point.unknowns.copy())
        auxiliary = a, at.other_rate
        bend = self._bend(instant, partials) if m else None
        correction = np.zeros(m if self.is_stabilised else 0)
        return ConstrainedPlace(kept, instant, auxiliary, at.other_rate, correction, 0.0, bend=bend)

    def _bend(self, at: Instant, partials: Partials) -> Vector:
        """Return the third derivative of the coordinates that the constraints demand."""
        slope = slope_of_lift(self._functions, at, self._parameters)
        return self._matrix.accelerations(partials, np.zeros_like(at.position), slope)[0]

    def resumed(self, point: ConsistentPoint, numbers: Vector) -> ConstrainedPlace:
        """Return the place from which steps go on that end a piece of a run with these numbers."""
        return resumed_place(self._functions, point, numbers, is_stabilised=self.is_stabilised)

    def carried(self, place: ConstrainedPlace) -> MethodState:
        """Return what a run goes on with behind a place; nothing where the motion starts anew."""
        return MethodState(place.numbers, holds_constraints=True)

    def step(self, place: ConstrainedPlace, end: float) -> ConstrainedPlace | None:
        """Return the end of a step, or None where Newton's method does not converge."""
        was_stale = self._is_stale or self._factors is None
        found = self._iterate(place, end, is_fresh=was_stale)
        if found is None and not was_stale:
            self._is_stale = True
            found = self._iterate(place, end, is_fresh=True)
        return found

    def outputs(self, place: ConstrainedPlace) -> Vector | None:
        """Return the channels of a place as the steps have it, None where they are the usual."""
        if not self.shows_own:
            return None
        return self._functions.outputs(place.instant, self._parameters)

    def _iterate(
        self, place: ConstrainedPlace, end: float, *, is_fresh: bool
    ) -> ConstrainedPlace | None:
        factors = self._prepared(place, end - place.instant.time)
        known = self._known(place, end)
        mean = self._mean_jacobian(place.instant, place.instant)
        a, r = self._guessed(place, known), known.old[1]
        multiplier, eta = place.instant.multiplier.copy(), place.correction.copy()
        before, w = np.inf, self._weights
        for iteration in range(_MOST_ITERATIONS):
            instant = self._instant(known, Unknowns(a, r, multiplier, eta), mean)
            if self.is_stabilised:
                mean = self._mean_jacobian(place.instant, instant)
                instant = self._instant(known, Unknowns(a, r, multiplier, eta), mean)
            try:
                at = self._evaluated(instant)
            except NumericalError:
                return None
            self._task.ledger.counts[Count.ITERATIONS] += 1
            change = factors.solve(self._right(known, at, r))
            if not np.isfinite(change.a).all():
                return None
            a, r = a - change.a, r - change.r
            multiplier, eta = multiplier - change.multiplier, eta - change.eta
            moved, forced = self._sizes_of(known, instant, change, mean)
            size = max(moved, _LEVER * forced)
            is_rounding = moved < _ROUNDING and forced < _COARSE
            contraction = size / before if iteration else 0.0
            if contraction > _SLOW and not is_rounding:
                self._is_stale = True
            left = contraction / max(1.0 - contraction, 1e-3)
            allowed = self.close if len(multiplier) else self._allowed(known, a, instant)
            settled = iteration and moved * left < allowed and forced * left < self.close_forces
            stays = contraction > 0.5 and is_rounding
            if stays and not is_fresh and moved > _CLOSE * (1.0 + w.gamma / (w.beta * known.size)):
                return None
            if settled or stays or size == 0.0:
                return self._accepted(known, Unknowns(a, r, multiplier, eta), mean, place)
            if contraction > 0.9 and iteration > 1:
                return None
            before = size
        return None

    def _allowed(self, known: KnownOfStep, a: Vector, at: Instant) -> float:
        """Return the error that may be left where no multipliers need their digits."""
        missed = self._weights.error_of_positions(known.size, a - known.old[0])
        largest = np.abs(missed / (1.0 + np.abs(at.position))).max(initial=0.0)
        return float(min(max(self._weights.share * largest, _CLOSE), _COARSEST))

    def _accepted(
        self, known: KnownOfStep, found: Unknowns, mean: Sparse | None, place: ConstrainedPlace
    ) -> ConstrainedPlace:
        a, r, _, eta = found
        instant = self._instant(known, found, mean)
        e, w = self._functions.equations, self._weights
        state = place.point.state.copy()
        state[list(e.positions)] = instant.position
        state[list(e.velocities)] = instant.velocity
        state[list(e.others)] = instant.other
        rate = (w.first_order_mass * r + known.lag) / (1.0 - w.alpha_f)
        point = ConsistentPoint(known.time, state, place.point.unknowns.copy())
        change = a - known.old[0]
        return ConstrainedPlace(point, instant, (a, r), rate, eta, known.size, change)

    def _known(self, place: ConstrainedPlace, end: float) -> KnownOfStep:
        """Return what is known of a step: all that its unknowns do not change."""
        w, at = self._weights, place.instant
        h = end - at.time
        a, r = self._carried(place, h)
        v = at.velocity
        if place.bend is not None:
            a = a + h * w.shift * place.bend
            v = v if self.is_stabilised else v + w.error_of_positions(h, place.bend)
        elif self.is_resized(place, h):
            v = v + (1.0 - (h / place.size) ** 2) * self.way_back(place)
        mass = w.first_order_mass
        return KnownOfStep(
            end,
            h,
            at.position + h * (v + h * (0.5 - w.beta) * a),
            v + h * (1.0 - w.gamma) * a,
            (w.alpha_m * a - w.alpha_f * at.acceleration) / (1.0 - w.alpha_f),
            at.other + h * (1.0 - w.first_order_gamma) * r,
            (1.0 - mass) * r - w.alpha_f * place.other_rate,
            (a, r),
        )

    def is_resized(self, place: ConstrainedPlace, h: float) -> bool:
        """Return whether a step of size h [s] begins with other velocities than the last has left.

        Velocities of index 3 miss the constraints by a part that grows with the square of the size.
        """
        if self.is_stabilised or not place.size or not self._functions.sizes[2]:
            return False
        return abs(h - place.size) > _SAME * place.size

    def way_back(self, place: ConstrainedPlace) -> Vector:
        """Return what puts the velocities of a place onto the constraints."""
        if self._back is None or self._back[0] is not place:
            at, parameters = place.instant, self._parameters
            opening = self._evaluated(at).opening
            partials, nothing = self._functions.partials(at, parameters), np.zeros_like(at.velocity)
            self._back = place, self._matrix.accelerations(partials, nothing, opening)[0]
        return self._back[1]

    @staticmethod
    def _guessed(place: ConstrainedPlace, known: KnownOfStep) -> Vector:
        """Return a at the end of a step if it changes as it did in the step before."""
        if place.change is None:
            return known.old[0]
        return known.old[0] + known.size / place.size * place.change

    @staticmethod
    def _carried(place: ConstrainedPlace, h: float) -> tuple[Vector, Vector]:
        """Return a and its like for a step of size h: they lead or lag by a part of the step."""
        a, r = place.auxiliary
        if not place.size or h == place.size:
            return a, r
        ratio, at = h / place.size, place.instant.acceleration
        return at + ratio * (a - at), place.other_rate + ratio * (r - place.other_rate)

    def error(self, before: ConstrainedPlace, after: ConstrainedPlace) -> float:
        """Return the largest local error of a step about, for one plus the size of each state.

        Further states are not looked at.
        """
        if after.change is None:
            return 0.0
        w, h, at = self._weights, after.size, after.instant
        bend = w.error_of_rates(h, after.change, before.size, before.change)
        pairs = [(w.error_of_positions(h, after.change), at.position), (bend, at.velocity)]
        return float(max(np.abs(e / (1.0 + np.abs(x))).max(initial=0.0) for e, x in pairs))

    def _instant(
        self, known: KnownOfStep, unknowns: Unknowns, mean: Sparse | None = None
    ) -> Instant:
        w, h = self._weights, known.size
        a, r, multiplier, eta = unknowns
        position = known.position + h**2 * w.beta * a - h * self._pushed(mean, eta)
        return Instant(
            known.time,
            position,
            known.velocity + h * w.gamma * a,
            known.acceleration + (1.0 - w.alpha_m) / (1.0 - w.alpha_f) * a,
            multiplier,
            known.other + h * w.first_order_gamma * r,
        )

    def _right(self, known: KnownOfStep, at: Residuals, r: Vector) -> Vector:
        """Return the scaled residuals of a step."""
        w, h = self._weights, known.size
        lag = w.first_order_mass * r + known.lag - (1.0 - w.alpha_f) * at.other_rate
        parts = [at.force, lag, at.gap / (w.beta * h**2)]
        if self.is_stabilised:
            parts.append(at.opening / (w.gamma * h))
        return np.concatenate(parts)

    def _sizes_of(
        self, known: KnownOfStep, instant: Instant, change: Unknowns, mean: Sparse | None
    ) -> tuple[float, float]:
        """Return the sizes of a change: of the states, and of the multipliers."""
        w, h = self._weights, known.size
        slid = h * np.abs(self._pushed(mean, change.eta))
        moves = [
            (h**2 * w.beta * np.abs(change.a) + slid) / (1.0 + np.abs(instant.position)),
            h * w.gamma * np.abs(change.a) / (1.0 + np.abs(instant.velocity)),
            h * w.first_order_gamma * np.abs(change.r) / (1.0 + np.abs(instant.other)),
        ]
        largest = 1.0 + np.abs(instant.multiplier).max(initial=0.0)
        forced = np.abs(change.multiplier).max(initial=0.0) / largest
        return float(max(item.max(initial=0.0) for item in moves)), float(forced)

    def _evaluated(self, instant: Instant) -> Residuals:
        self._task.ledger.counts[Count.EVALUATIONS] += 1
        found = self._functions.residuals(instant, self._parameters)
        if not all(np.isfinite(part).all() for part in found):
            raise NumericalError("a residual is not a finite number")
        return found

    def _foreseen(self, place: ConstrainedPlace, size: float) -> Instant:
        """Return about where a step leads; Jacobians there serve it and its followers best."""
        known = self._known(place, place.instant.time + size)
        a, r = self._guessed(place, known), known.old[1]
        return self._instant(known, Unknowns(a, r, place.instant.multiplier, place.correction))

    def _prepared(self, place: ConstrainedPlace, size: float) -> StepFactors:
        """Return factors, found anew where they are stale or of another step size."""
        kept = self._factors
        if kept is not None and not self._is_stale and kept.is_for(size):
            return kept
        return self.factors_for(place, size, is_new=self._is_stale)

    def factors_for(self, place: ConstrainedPlace, size: float, *, is_new: bool) -> StepFactors:
        """Return factors for a step of some size [s], of a new Jacobian or of the one before."""
        partials = None if is_new or self._factors is None else self._factors.partials
        if partials is None:
            foreseen = self._foreseen(place, size)
            partials = self._functions.partials(foreseen, self._parameters)
            self._mean = self._mean_jacobian(place.instant, foreseen)
            self._is_stale = False
        self._factors = self._matrix.factorised(partials, self._weights, size, self._mean)
        return self._factors
