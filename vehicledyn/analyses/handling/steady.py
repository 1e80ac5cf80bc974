"""Steady cornering of a car as a whole: circles, modes, yaw moments and limits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.analyses.handling.acceleration_limits import (
    ENDS,
    AccelerationLimits,
    acceleration_limits,
)
from vehicledyn.analyses.handling.circle import (
    QUANTITIES,
    SteadyCurve,
    constant_radius,
    constant_speed,
    constant_steering,
)
from vehicledyn.analyses.handling.cornering_modes import CorneringModes
from vehicledyn.analyses.handling.equal_curvature import equal_curvature_figures
from vehicledyn.analyses.handling.steady_turn import (
    FULL_THROTTLE,
    POWER_SLIDE,
    WHEEL_SPIN,
    SteadyTurn,
    solver_for,
)
from vehicledyn.analyses.handling.test_run import DriveRecord
from vehicledyn.analyses.handling.tested_car import CONTROL, CarPoint, TestedCar
from vehicledyn.analyses.handling.yaw_moment import REASONS, YawMoments, yaw_moments
from vehicledyn.analyses.preparation.model_hash import model_facts
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.preparation.validity.unlike_tyres import unlike_tyres
from vehicledyn.base.step_memory import Memory
from vehicledyn.files.scenario.target import Target
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.results.tables.columns import Column
from vehicledyn.results.tables.handling_table import HandlingTable, KeyFigure, Sheet
from vehicledyn.road.manoeuvres.driving_test import DrivingTest

GRADIENT_FROM, GRADIENT_UP_TO = 2.0, 4.0
"""Lateral accelerations between which gradients are taken [m/s²].

Below, a differential with friction sticks, which makes another car of it.
"""

_SIDESLIPS = np.radians(np.linspace(-8.0, 8.0, 9))
GRADIENTS = (
    ("understeer_angle", "understeer_gradient", "Understeer gradient at the front wheels"),
    ("sideslip_angle", "sideslip_gradient", "Side-slip gradient"),
    ("roll_angle", "roll_gradient", "Roll gradient"),
)
"""Gradients of a curve: quantity, name, meaning."""


@dataclass(frozen=True)
class SteadyRequest:
    """What of steady cornering is wanted: speed [m/s], radius [m], and which analyses."""

    speed: float = 100.0 / 3.6
    radius: float = 100.0
    moments: bool = True
    limits: bool = True


def steady_table(
    target: Target,
    wish: SteadyRequest,
    *,
    backend: Backend,
    progress: Progress,
    kept: KeptWork | None = None,
) -> HandlingTable:
    """Return curves and key figures of a car in steady cornering, ``kept`` while they are found.

    Raises
    ------
    InputError
        If the model is no road vehicle on free wheels.
    NumericalError
        If the car does not run straight.
    """
    test = DrivingTest(speed_control=CONTROL)
    car = TestedCar(target, backend=backend, progress=progress, test=test)
    car.memory = memory_of(car, kept, "steady", wish)
    progress("finding straight running", None)
    return steady_sheets(solver_for(car), wish, progress)


def memory_of(car: TestedCar, kept: KeptWork | None, *wishes: Any) -> Memory:
    """Return the memory of the turns and drives of a car, for a computation that is wished."""
    facts = model_facts(car.equations, car.kernel.parameters)
    given = wishes, facts, car.kernel.backend
    return (kept or KeptWork()).memory(*given, kinds=(CarPoint, DriveRecord))


def steady_sheets(solver: SteadyTurn, wish: SteadyRequest, progress: Progress) -> HandlingTable:
    """Return the curves and key figures that are wanted of a car, see :func:`steady_table`."""
    sheets: dict[str, Sheet] = {}
    progress("cornering at constant speed", None)
    speed = constant_speed(solver, wish.speed)
    progress("cornering at constant radius", None)
    radius = constant_radius(solver, wish.radius)
    lateral, angles = speed.values["lateral_acceleration"], speed.values["steering_angle"]
    angle = float(np.interp(GRADIENT_UP_TO, lateral, angles))
    progress("cornering at constant steering-wheel angle", None)
    steering = constant_steering(solver, angle)
    curves = {
        "constant_speed": speed,
        "constant_radius": radius,
        "constant_steering": steering,
    }
    sheets |= {name: _sheet(curve) for name, curve in curves.items() if curve.points}
    figures = [f for name, c in curves.items() for f in _circle_figures(name, c)]
    notes = [*unlike_tyres(solver.car.prepared.subject.system)]
    notes += [
        f"{c.method}: no turn was found beyond {c.values['lateral_acceleration'][-1]:.3g} m/s^2, "
        "which is not shown to be the limit"
        for c in curves.values()
        if c.is_lost
    ]
    notes += [
        f"{c.method}: ends at {c.values['lateral_acceleration'][-1]:.3g} m/s^2, {_NOTED[c.reason]}"
        for c in curves.values()
        if c.reason
    ]
    progress("comparing the methods at one curvature", None)
    figures += equal_curvature_figures(
        solver, radius, wish.radius, first=GRADIENT_FROM, last=GRADIENT_UP_TO
    )
    notes += _unlike_methods(figures)
    progress("finding modes along lateral acceleration", None)
    sheets["modes"], found = _modes(solver, speed)
    figures += found
    if wish.moments:
        progress("finding yaw moments", None)
        found_moments = _moments(solver, wish.speed, 2.0 * abs(angle))
        sheets["yaw_moments"] = _moment_sheet(found_moments)
        notes += [f"yaw moments, {words}" for words in found_moments.notes()]
    if wish.limits:
        progress("finding limits of acceleration", None)
        limits = acceleration_limits(solver, wish.speed)
        along, across = "Acceleration along the path", "Largest lateral acceleration"
        sheets["limits"] = {
            "longitudinal": Column("m/s^2", along, limits.longitudinal),
            "lateral": Column("m/s^2", across, limits.lateral),
            **_ends(limits),
        }
        figures.append(_limit_figure("braking", -float(limits.longitudinal.min())))
        figures.append(_limit_figure("driving", float(limits.longitudinal.max())))
        notes += [f"limits, {words}" for words in (*limits.lost, *limits.notes())]
    title = f"Steady cornering at {wish.speed * 3.6:.4g} km/h and {wish.radius:.4g} m"
    return HandlingTable(title, solver.car.title, sheets, figures, tuple(notes))


def _limit_figure(name: str, value: float) -> KeyFigure:
    words = f"Largest acceleration along the path, {name}"
    return KeyFigure("limits", name, value, "m/s^2", words)


def _sheet(curve: SteadyCurve) -> Sheet:
    return {name: Column(*QUANTITIES[name], values) for name, values in curve.values.items()}


def _circle_figures(test: str, curve: SteadyCurve) -> Iterator[KeyFigure]:
    """Yield gradients between 2 and 4 m/s², the circles they are of, and the limit."""
    lateral = curve.values["lateral_acceleration"]
    if test != "constant_radius":
        yield from _radii(test, curve)
    for name, title, text in GRADIENTS:
        if len(lateral) and lateral[0] <= GRADIENT_FROM < GRADIENT_UP_TO <= lateral[-1]:
            slope = curve.gradient(name, GRADIENT_UP_TO, first=GRADIENT_FROM)
            words = f"{text}, of a line from {GRADIENT_FROM:g} to {GRADIENT_UP_TO:g} m/s^2"
            yield KeyFigure(test, title, slope, "rad*s^2/m", words)
    if np.isfinite(curve.limit):
        words = "Largest lateral acceleration of a steady turn"
        yield KeyFigure(test, "limit", curve.limit, "m/s^2", words)


def _radii(test: str, curve: SteadyCurve) -> Iterator[KeyFigure]:
    """Yield the radii between which a test changes its circle while the gradient is taken."""
    lateral = curve.values["lateral_acceleration"]
    for at in (GRADIENT_FROM, GRADIENT_UP_TO):
        if len(lateral) and lateral[0] <= at <= lateral[-1]:
            radius = 1.0 / float(np.interp(at, lateral, curve.values["curvature"]))
            words = f"Radius of the circle at {at:g} m/s^2"
            yield KeyFigure(test, f"radius_at_{at:g}", radius, "m", words)


def _unlike_methods(figures: list[KeyFigure]) -> Iterator[str]:
    """Yield why the gradients of the three tests differ, and which ones compare."""
    known = {(f.test, f.name): f.value for f in figures}
    apart = known.get(("equal_curvature", "difference"))
    tests = ("constant_speed", "constant_radius", "constant_steering")
    slopes = [known.get((test, "understeer_gradient"), np.nan) for test in tests]
    if apart is None or not np.isfinite(slopes).all():
        return
    own = float(np.ptp(slopes) / np.abs(slopes).max())
    yield (
        f"understeer gradients of the three methods differ by {100.0 * own:.2g} %, since tests at "
        "constant speed and with the wheel held change their circle on the way and gradients "
        "depend on curvature; side-slip angles change with the circle itself, too; under equal "
        f"curvature the methods compare, there they differ by {100.0 * apart:.2g} %"
    )


def _modes(solver: SteadyTurn, curve: SteadyCurve) -> tuple[Sheet, list[KeyFigure]]:
    """Return eigenvalues along a curve, and where the car loses stability."""
    modes = CorneringModes(solver)
    rows: list[tuple[float, float, float]] = []
    growth: list[tuple[float, float]] = []
    lateral = curve.values["lateral_acceleration"]
    for at, point in list(zip(lateral, curve.points, strict=True))[::2]:
        found = modes.about(point, held_speed=True).eigenvalues
        rows += [(float(at), float(v.real), float(v.imag)) for v in found]
        growth.append((float(at), float(found.real.max())))
    across, real, imaginary = np.array(rows).T
    unstable = [at for at, value in growth if value > _UNSTABLE]
    words = "Lateral acceleration from which on steady cornering is unstable"
    figures = [KeyFigure("modes", "unstable_from", unstable[0], "m/s^2", words)] if unstable else []
    sheet = {
        "lateral_acceleration": Column(*QUANTITIES["lateral_acceleration"], across),
        "real": Column("1/s", "Real part of an eigenvalue", real),
        "imaginary": Column("1/s", "Imaginary part of an eigenvalue", imaginary),
    }
    return sheet, figures


def _ends(limits: AccelerationLimits) -> Sheet:
    """Return a column for each reason that ends turns, and the number of locked wheels."""
    locked = np.array([float(len(wheels)) for wheels in limits.locked])
    return {
        **{
            name.replace(" ", "_"): Column(
                "1",
                f"Whether {words} there (1)",
                np.array([float(end == name) for end in limits.ends]),
            )
            for name, words in ENDS.items()
        },
        "locked_wheels": Column("1", "Wheels that are locked there", locked),
    }


_NOTED = {
    POWER_SLIDE: "where a power slide with opposite lock begins",
    WHEEL_SPIN: "where a driven wheel turns twice as fast as the ground",
    FULL_THROTTLE: "at full throttle",
}

_UNSTABLE = 1e-3
"""Growth rate that counts as unstable; slow states of the drive have smaller ones [1/s]."""


def _moments(solver: SteadyTurn, speed: float, largest: float) -> YawMoments:
    steering = np.linspace(-largest, largest, 9)
    return yaw_moments(solver, speed, sideslip=_SIDESLIPS, steering=steering)


def _moment_sheet(found: YawMoments) -> Sheet:
    slips, angles = np.meshgrid(found.sideslip, found.steering, indexing="ij")
    missing = {
        reason.replace(" ", "_"): Column(
            "1",
            f"Whether there is no balance: {ENDS.get(reason, 'nothing shows why')} (1)",
            (found.reasons == reason).astype(float).ravel(),
        )
        for reason in REASONS
    }
    return {
        "sideslip_angle": Column("rad", "Side-slip angle that is held", slips.ravel()),
        "steering_angle": Column("rad", "Steering-wheel angle", angles.ravel()),
        "lateral_acceleration": Column(
            "m/s^2", "Lateral acceleration", found.lateral_acceleration.ravel()
        ),
        "yaw_acceleration": Column(
            "rad/s^2", "Yaw acceleration if it were let go", found.yaw_acceleration.ravel()
        ),
        **missing,
    }
