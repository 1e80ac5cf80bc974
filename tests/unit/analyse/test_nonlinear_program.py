"""Derivatives of the nonlinear program of an optimal manoeuvre."""

import casadi
import numpy as np
import pytest
from scipy.sparse import csc_matrix

import vehicledyn.analyse.optimal_control.point_derivatives as point_derivatives
import vehicledyn.catalogue  # noqa: F401 - registers models
from vehicledyn.analyse.optimal_control.point_function import PointFunction
from vehicledyn.analyse.optimal_control.transcription import MotionProgram, PointModel
from vehicledyn.studies.manoeuvre_optimisation.file import load_manoeuvre
from vehicledyn.studies.manoeuvre_optimisation.guess import first_guess, state_scales
from vehicledyn.studies.manoeuvre_optimisation.model import prepare_manoeuvre
from vehicledyn.symbolic.tables import CurveTable

CRANE = """\
title: A crane on a plane
bodies:
  trolley:
    joints: [{kind: T1, name: x}, {kind: T2, name: y}, {kind: T3, name: z, role: driven}]
    mass: 1 kg
  load: {parent: trolley, joints: [{kind: R2, name: angle}], mass: 1 kg, com: [0, 0, -1 m]}
"""
STUDY = """\
title: Along a bow
model: crane.yaml
controls:
  fx: {input: force:trolley.x, from: -12 N, to: 12 N}
  fy: {input: force:trolley.y, from: -12 N, to: 12 N, rate: 40 N/s}
  lift: {input: trolley.z, from: -1 m, to: 1 m, rate: 1 m/s, acceleration: 3 m/s^2}
minimise: {time: 1, effort: 0.1, smoothness: 0.1, energy: 0.3, final(load.angle): 2,
  integral(load.angle): 1, integral_of_square(trolley.x_rate): 1}
duration: {from: 1 s, to: 9 s}
limits: {"norm(fx, fy)": {to: 15 N}}
end: {path.distance: 8 m, load.angle: {from: -1 deg, to: 1 deg}}
path: {arc: {radius: 9 m, angle: 60 deg}, right: 1 m, left: 1 m, place: [trolley.x, trolley.y]}
intervals: 3
"""


def program(folder, text=STUDY):
    """Return the program of a study and variables near the first guess."""
    (folder / "crane.yaml").write_text(CRANE, encoding="utf-8")
    (folder / "study.yaml").write_text(text, encoding="utf-8")
    manoeuvre = prepare_manoeuvre(load_manoeuvre(folder / "study.yaml"), lambda *_: None)
    guess, _ = first_guess(manoeuvre)
    made = MotionProgram(PointModel(manoeuvre.problem), guess, state_scales(guess))
    variables = made.layout.of(guess)
    return made, variables + 0.1 * np.random.default_rng(1).normal(size=variables.size)


def differences(function, at, step=1e-5):
    """Return central differences of a function by its variables, a column for each."""
    moves = step * np.eye(at.size)
    return np.array([(function(at + m) - function(at - m)) / (2.0 * step) for m in moves]).T


@pytest.mark.parametrize(
    "more", ["", "periodic: {trolley.*: 0, load.*: 0}\n", "start: {trolley.y: free}\n"]
)
def test_derivatives_of_the_program_are_those_of_its_values(tmp_path, more):
    """All kinds of controls, terms, limits, ends and the path, against central differences.

    The mesh follows the path where the motion starts at a place, else intervals share time.
    """
    made, at = program(tmp_path, STUDY + more)
    assert bool(made.layout.places["lengths"].size) == (more == "")
    rows, n = made.rows, at.size
    slopes = csc_matrix(
        (rows.jacobian(at), rows.slopes.rows, rows.slopes.starts), (rows.count, n)
    ).toarray()
    assert slopes == pytest.approx(differences(rows.values, at), abs=1e-7 * np.abs(slopes).max())
    weights = np.random.default_rng(2).normal(size=rows.count)
    upper = csc_matrix((rows.hessian(at, weights), rows.bends.rows, rows.bends.starts), (n, n))
    whole = upper.toarray()
    whole += np.triu(whole, 1).T

    def gradient(x):
        return csc_matrix(
            (rows.jacobian(x), rows.slopes.rows, rows.slopes.starts), (rows.count, n)
        ).T.dot(weights)

    assert whole == pytest.approx(differences(gradient, at), abs=1e-7 * np.abs(whole).max())


def test_machine_code_gives_the_derivatives_that_are_interpreted(needs_compiler, monkeypatch):
    """A function with a table, of which one variable is not used and one enters straight."""
    table = CurveTable.through("hill", 0.0, 0.5, [0.0, 1.0, 0.5, 2.0, 1.0])
    v, c = casadi.SX.sym("v", 4), casadi.SX.sym("c", 2)
    outputs = casadi.vertcat(
        casadi.sin(v[0] * c[0]) * v[1], table.value(v[1]) * v[0], v[3] + c[1], 2.0 * v[1] ** 3
    )
    function = PointFunction(outputs, v, c, {}, (table,))
    given = np.random.default_rng(0).uniform(0.2, 1.8, size=(11, 10))
    point = given[:, :4], given[:, 4:6]
    found = []
    for least in (0, np.inf):
        monkeypatch.setattr(point_derivatives, "_WORTH_COMPILING", least)
        made = point_derivatives.PointDerivatives(function)
        assert made.is_compiled == (least == 0)
        found.append(
            [made.values(*point), made.jacobian(*point), made.hessian(*point, given[:, 6:])]
        )
    for machine, interpreted in zip(*found, strict=True):
        assert machine == pytest.approx(interpreted, rel=1e-13, abs=1e-13)
        assert np.abs(interpreted).max() > 1.0
