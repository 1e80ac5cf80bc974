"""Forces of prescribed motions: they bring about the motion, along laws and tables."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.mechanism.inverse_report import find_forces
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import load_model, load_scenario
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import derive
from vehicledyn.results.store.reader import open_result

CRANK = """\
title: A crank lifts a slider
parameters: {radius: 0.2 m, rod: 0.9 m, mass: 2 kg, torque: 0 N*m}
bodies:
  crank:
    joints: [{kind: R2, name: angle, role: independent}]
    mass: 1 kg
    inertia: [0, 0.02 kg*m^2, 0.02 kg*m^2]
  slider: {joints: [{kind: T3, name: height, start: 0.8 m}], mass: mass}
cuts:
  rod: {kind: rod, a: {body: crank, point: [radius, 0, 0]}, b: slider, length: rod}
forces:
  drive: {coordinate: crank.angle, force: torque}
  friction: {coordinate: slider.height, force: -3 N*s/m * rate}
"""
RUN = """\
title: It turns
model: crank.yaml
duration: 0.5 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 5 ms}
"""
LAW = "motion: {crank.angle: 0.3 rad - 2 rad * sin(4 rad/s * time)}\n"


def quiet(*_):
    """Show no progress."""


def found(folder, motion="", *, table=None, run=RUN):
    """The report and the channels of inverse dynamics."""
    (folder / "crank.yaml").write_text(CRANK, encoding="utf-8")
    (folder / "run.yaml").write_text(run + motion, encoding="utf-8")
    path = folder / "inverse.h5"
    report = find_forces(
        load_scenario(folder / "run.yaml"), table=table, output=path, backend="interpreted",
        progress=quiet,
    )  # fmt: skip
    with open_result(path) as result:
        values = {name: result.channel(name).values for name in result.channels}
        return report, result.time, values


def test_the_forces_bring_about_the_motion(tmp_path):
    """A simulation with the torque as an outer force, between samples as a spline."""
    from scipy.interpolate import make_interp_spline

    report, times, values = found(tmp_path, LAW)
    assert report.status == "ok"
    torque = make_interp_spline(times, values["crank.angle_force"], k=5)
    system = build_subject(load_model(str(tmp_path / "crank.yaml"))).system
    kernel = compile_kernel(derive(system), backend="interpreted")
    index = [p.name for p in kernel.equations.parameters].index("torque")
    guess = [np.array([u.start for u in kernel.equations.unknowns])]

    def rates(time, state):
        numbers = kernel.parameters
        numbers[index] = torque(time)
        kernel.set_parameters(numbers)
        guess[0] = kernel.solve_unknowns(time, state, guess[0])
        return kernel.rates(time, state, guess[0])

    motion = solve_ivp(
        rates, (0.0, 0.5), [0.3, -8.0], t_eval=times, rtol=1e-10, atol=1e-10, method="DOP853"
    )
    assert motion.y[0] == pytest.approx(values["crank.angle"], abs=1e-7)
    assert motion.y[0] == pytest.approx(0.3 - 2.0 * np.sin(4.0 * times), abs=1e-7)


def test_power_feeds_energy_and_friction(tmp_path):
    """The work of the drive is the energy gained and what friction takes."""
    _, times, values = found(tmp_path, LAW)
    energy = values["energy.kinetic"] + values["energy.gravity"]
    power = values["crank.angle_power"] - 3.0 * values["slider.height_rate"] ** 2
    assert np.trapezoid(power, times) == pytest.approx(energy[-1] - energy[0], abs=2e-3)
    product = values["crank.angle_force"] * values["crank.angle_rate"]
    assert values["crank.angle_power"] == pytest.approx(product, rel=1e-14)


def test_a_table_gives_what_its_law_gives(tmp_path):
    _, _, wanted = found(tmp_path, LAW)
    moments = np.linspace(0.0, 0.5, 51)
    degrees = np.degrees(0.3 - 2.0 * np.sin(4.0 * moments))
    rows = [f"{t!r},{a!r}" for t, a in zip(moments.tolist(), degrees.tolist(), strict=True)]
    table = tmp_path / "motion.csv"
    table.write_text("# made by a test\ntime [s],crank.angle [deg]\n" + "\n".join(rows))
    _, _, given = found(tmp_path, "motion: motion.csv\n")
    force = wanted["crank.angle_force"]
    assert given["crank.angle_force"] == pytest.approx(force, abs=2e-4 * np.abs(force).max())
    _, _, again = found(tmp_path, table=table)
    assert (again["crank.angle_force"] == given["crank.angle_force"]).all()


def test_the_motion_of_another_coordinate_will_do(tmp_path):
    """The slider's motion instead of the crank's: the same power at the same place."""
    _, _, crank = found(tmp_path, LAW)
    height = "motion: {slider.height: 0.8 m + 0.05 m * sin(3 rad/s * time)}\n"
    _, _, slider = found(tmp_path, height)
    assert slider["slider.height"][0] == pytest.approx(0.8)
    assert set(slider) - set(crank) == {"slider.height_force", "slider.height_power"}


def test_what_was_found_before_a_dead_centre_is_kept(tmp_path):
    report, times, values = found(tmp_path, "motion: {slider.height: 0.8 m + 1 m/s * time}\n")
    assert report.status == "failed"
    assert 0 < len(times) < 101
    assert values["slider.height"].max() < 1.1
    assert "partial result is kept" in report.messages[0]


@pytest.mark.parametrize(
    ("motion", "words"),
    [
        ("", "motion: missing: say how crank.angle move"),
        ("motion: {crank.angel: 1 rad}\n", r"run.yaml:6:23: motion.crank.angel: no coordinate"),
        ("motion: {crank.angle: 1 m}\n", "this is in m, a quantity in rad is needed"),
        ("motion: {crank.angle: open('x')}\n", "motion.crank.angle: "),
        ("motion: {crank.angle: {kind: ramp}}\n", "motion.crank.angle.last: missing"),
        ("motion: nothing.csv\n", "nothing.csv: there is no such file"),
        (
            "motion: {crank.angle: 1 rad, slider.height: 1 m}\n",
            r"has 1 independent coordinate\(s\), the motion of 2 is prescribed",
        ),
    ],
)
def test_motions_that_cannot_be(motion, words, tmp_path):
    with pytest.raises(InputError, match=words):
        found(tmp_path, motion)


STEP_IN_FEW_POINTS = "time,crank.angle\n" + "".join(
    f"{time},{float(time > 0.3)}\n" for time in (0.0, 0.2, 0.3, 0.301, 0.4, 0.5, 0.6)
)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "the table is empty"),
        ("time,crank.angel\n0,1\n", ":1: no coordinate named 'crank.angel'"),
        ("time,crank.angle [mm]\n0,1\n", ":1: crank.angle: the unit must be one of rad"),
        ("crank.angle\n1\n", "one 'time' and each coordinate once"),
        ("time,crank.angle\n0,1\n1,two\n", ":3: crank.angle: 'two' is no number"),
        ("time,crank.angle\n0,1\n1\n", ":3: 1 values for 2 columns"),
        ("time,crank.angle\n0,1\n1,2\n", "2 rows; a smooth curve needs 6"),
        ("time,crank.angle\n" + "0,1\n" * 7, "the times do not grow"),
        ("time,crank.angle\n" + "".join(f"{k}e-2,1\n" for k in range(7)), "from 0 s to 0.06 s"),
        (STEP_IN_FEW_POINTS, "crank.angle: the smooth curve through the points swings out to .* s"),
    ],
)
def test_tables_that_cannot_be(text, words, tmp_path):
    table = tmp_path / "table.csv"
    table.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=words):
        found(tmp_path, table=table)
