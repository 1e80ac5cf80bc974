"""The whole set of handling tests on one car: steady cornering, open-loop tests, lane changes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from vehicledyn.analyses.handling.lane_changes import run_lane_changes
from vehicledyn.analyses.handling.standard_tests import USUAL_RATIO, StandardTests
from vehicledyn.analyses.handling.steady import SteadyRequest, memory_of, steady_sheets
from vehicledyn.analyses.handling.steady_turn import solver_for
from vehicledyn.analyses.handling.tested_car import CONTROL, TestedCar
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.files.scenario.target import Target
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.results.tables.handling_table import HandlingTable, KeyFigure
from vehicledyn.road.manoeuvres.driving_test import DrivingTest


def handling_table(
    target: Target, *, backend: Backend, progress: Progress, kept: KeptWork | None = None
) -> HandlingTable:
    """Return the key figures and curves of all handling tests of a car.

    Parameters
    ----------
    target
        A scenario or model of a road vehicle; its own manoeuvre is left out.
    backend, progress
        As for a run.
    kept
        What is kept of it while it goes.

    Raises
    ------
    InputError
        If the model is no road vehicle on free wheels, or what is kept is another car's.
    NumericalError
        If the car does not run straight.
    """
    test = DrivingTest(speed_control=CONTROL)
    car = TestedCar(target, backend=backend, progress=progress, test=test)
    car.memory = memory_of(car, kept, "handling")
    progress("finding straight running", None)
    solver = solver_for(car)
    steady = steady_sheets(solver, SteadyRequest(limits=False), progress)
    tests = StandardTests(solver, progress)
    tests.run_all()
    tests.tried("lane changes", lambda: run_lane_changes(tests, backend=backend))
    notes = [*steady.notes, *tests.notes]
    if car.steering_ratio == 1.0:
        notes.append(
            "steering angles are those of the front wheels, and rates of the steering wheel are "
            f"divided by {USUAL_RATIO:g}: it has no steering_ratio"
        )
    return replace(
        steady,
        title="Handling tests",
        sheets={**steady.sheets, **tests.sheets},
        figures=[*_conditions(car), *steady.figures, *tests.figures],
        notes=tuple(notes),
    )


def _conditions(car: TestedCar) -> Iterator[KeyFigure]:
    """Yield the car as it is tested, which reports give by ISO 15037-1."""
    name = "conditions"
    words = "Mass on the wheels, as loaded in the model (ISO 15037-1, loading conditions)"
    yield KeyFigure(name, "mass", car.mass, "kg", words)
    yield KeyFigure(name, "front_share", car.front_share, "1", "Part of it on the front wheels")
    wheelbase = car.worth(car.vehicle.wheelbase)
    yield KeyFigure(name, "wheelbase", wheelbase, "m", "Wheelbase")
    words = "Steering-wheel angle over that of the front wheels"
    yield KeyFigure(name, "steering_ratio", car.steering_ratio, "1", words)
