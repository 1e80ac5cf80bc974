"""Small results of analyses that need a compiler or too long, written from their tables."""

import numpy as np

from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables import (
    handling_table,
    identification_table,
    optimum_table,
    sensitivity_table,
    uncertainty_table,
)
from vehicledyn.results.tables.columns import Column

MASS, LENGTH = Quantity("mass", "kg", "Mass"), Quantity("length", "m", "Length")
ROLL = Quantity("max(roll)", "rad", "Largest roll")
ANGLE = Quantity("angle", "rad", "Angle")


def handling(path):
    speed = Column("m/s", "Forward speed", [10.0, 20.0, 30.0])
    angle = Column("rad", "Steering-wheel angle", [0.1, 0.2, 0.35])
    figure = handling_table.KeyFigure("turn", "gradient", 0.02, "rad*s^2/m", "Gradient")
    sheets = {"turn": {"speed": speed, "angle": angle}}
    table = handling_table.HandlingTable("A car", "car", sheets, [figure], ("a note",))
    handling_table.write_handling(path, table)


def sensitivity(path):
    time = np.linspace(0.0, 1.0, 5)
    table = sensitivity_table.SensitivityTable(
        "Slopes", "pendulum", (MASS, LENGTH), np.array([2.0, 1.0]), (ROLL,), np.array([0.3]),
        np.array([[0.1, -0.2]]), channels=(ANGLE,), time=time, channel_values=np.sin(time)[None],
        channel_slopes=np.stack([time, -time], axis=-1)[None], notes=("a note",),
    )  # fmt: skip
    sensitivity_table.write_sensitivity(path, table)


def optimum(path):
    point = optimum_table.FrontPoint(np.array([2.0, 1.0]), 0.2, 0.4, 1e-7, 0.0, 3)
    table = optimum_table.OptimumTable(
        "Best lengths", "converged", (MASS, LENGTH), np.array([1.0, 0.5]), np.array([3.0, 2.0]),
        np.array([1.5, 0.7]), np.array([2.0, 1.0]), (ROLL,), np.array([[0.4], [0.3]]),
        np.array([[0.1, -0.2]]), np.array([[1.5, 0.7], [2.0, 1.0]]), np.array([0.4, 0.3]),
        np.zeros(2), 1e-7, 2, ("a note",), (point, point), ROLL,
    )  # fmt: skip
    optimum_table.write_optimum(path, table)


def identification(path):
    value, samples = np.array([2.0, 1.0]), np.linspace(0.0, 1.0, 6)
    table = identification_table.IdentificationTable(
        "Found", "converged", 4, (MASS, LENGTH), value - 0.5, value, value - 0.1, value + 0.1,
        np.diag([0.01, 0.02]), 1.1, 0.4, (ANGLE,), np.zeros(6), samples, samples + 0.1, samples,
        np.full(6, 0.1), ("a note",),
    )  # fmt: skip
    identification_table.write_identification(path, table)


def uncertainty(path):
    one, table = np.array([0.1]), uncertainty_table.UncertaintyTable
    found = table(
        "Scatter", "sobol", 3, (MASS, LENGTH), (ROLL,), one, one, one, one,
        np.array([[0.6, 0.3]]), np.array([[0.7, 0.4]]), np.ones((3, 2)), np.ones((3, 1)),
        ("a risk",), ("a note",),
    )  # fmt: skip
    uncertainty_table.write_uncertainty(path, found)


WRITERS = {
    "handling.h5": handling,
    "sensitivity.h5": sensitivity,
    "optimum.h5": optimum,
    "identified.h5": identification,
    "uncertainty.h5": uncertainty,
}
