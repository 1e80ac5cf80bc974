"""Stability of equilibria, modes about any start, and what ``models show`` prints."""

import json
from pathlib import Path

import numpy as np
import pytest
from programs import call

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import describe_model, find_equilibrium, find_modes
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import load_model

SYSTEMS = Path(__file__).parents[3] / "systems"


def quiet(*_):
    """Show no progress."""


def balanced(name, *overrides):
    target = load_model(str(SYSTEMS / f"{name}.yaml"), overrides)
    return find_equilibrium(target, speed=None, backend="interpreted", progress=quiet)


def test_a_bicycle_at_rest_falls_over():
    """Meijaard et al. (2007), table 2: at v = 0 the eigenvalues are ±3.1316 and ±5.5309 /s."""
    found = balanced("bicycle").stability
    assert found.verdict == "unstable"
    rates = [mode.eigenvalue.real for mode in found.growing]
    assert rates == pytest.approx([5.5309, 3.1316], abs=2e-4)
    assert found.decaying == 2
    text = balanced("bicycle").as_text().splitlines()[1]
    assert text.startswith("unstable: 2 modes grow, 2 modes decay, 6 modes neither grow nor decay")
    assert "fastest +5.53" in text


@pytest.mark.parametrize(
    ("name", "verdict", "decaying", "neutral"),
    [("quarter_car", "stable", 2, 0), ("double_pendulum", "neutral", 0, 2)],
)
def test_damped_systems_are_stable_and_undamped_ones_neutral(name, verdict, decaying, neutral):
    report = balanced(name)
    found = report.stability
    assert (found.verdict, found.decaying, found.neutral) == (verdict, decaying, neutral)
    assert report.as_dict()["stability"]["verdict"] == verdict


@pytest.mark.parametrize(("start", "verdict"), [(0.0, "neutral"), (np.pi, "unstable")])
def test_a_pendulum_above_and_below(tmp_path, start, verdict):
    """Upside down it falls at √(g/l) of a point mass, whichever of the two balances is near."""
    file = tmp_path / "pendulum.yaml"
    file.write_text(
        f"title: A pendulum\nbodies:\n  bob:\n    parent: ground\n"
        f"    joints: [{{kind: R2, name: angle, start: {start} rad}}]\n    mass: 2 kg\n"
        "    com: [0, 0, -0.5 m]\n    inertia: [0.01 kg*m^2, 0.01 kg*m^2, 0.01 kg*m^2, 0, 0, 0]\n"
    )
    found = find_equilibrium(
        load_model(str(file)), speed=None, backend="interpreted", progress=quiet
    ).stability
    assert found.verdict == verdict
    if verdict == "unstable":
        (mode,) = found.growing
        rate = np.sqrt(2.0 * 9.81 * 0.5 / (0.01 + 2.0 * 0.25))
        assert mode.eigenvalue.real == pytest.approx(rate, rel=1e-9)


def test_modes_about_a_start_that_is_asked_for():
    """A quarter car as it is drawn and as it rests differ, and the first is not steady."""
    target = load_model(str(SYSTEMS / "quarter_car.yaml"), ())
    static, nominal = (
        find_modes(target, speeds=[], start=s, backend="interpreted", progress=quiet)
        for s in ("static", "nominal")
    )
    assert static.speeds[0].remark == ""
    assert "the reference motion is not steady" in nominal.speeds[0].remark
    with pytest.raises(InputError, match="start='steady': is for vehicles"):
        find_modes(target, speeds=[], start="steady", backend="interpreted", progress=quiet)


@pytest.mark.long
def test_modes_of_a_vehicle_about_its_static_point():
    """It is balanced at rest and then moves: at speed that point is not quite steady."""
    target = load_model("iltis", ())
    options = {"speeds": [20.0], "backend": "interpreted", "progress": quiet}
    usual, static, steady = (
        find_modes(target, start=start, **options).speeds[0] for start in (None, "static", "steady")
    )
    assert "not steady" in static.remark
    assert usual.remark == steady.remark == ""
    values = [np.array([m.eigenvalue for m in case.modes]) for case in (usual, static, steady)]
    assert values[2] == pytest.approx(values[0], abs=1e-9)
    assert np.abs(values[1] - values[0]).max() > 1e-4


def test_a_model_shows_parameters_with_values_and_channels():
    target = load_model(str(SYSTEMS / "quarter_car.yaml"), ("body.mass=250 kg",))
    report = describe_model(target, backend="interpreted", progress=quiet)
    lines = report.as_text().splitlines()
    assert "  body.mass         250 kg      Mass" in lines
    assert "  wheel.stiffness   180000 N/m  Stiffness" in lines
    begin = lines.index("channels")
    shown = lines[begin + 1 : begin + 1 + len(report.equations.channels)]
    for line, channel in zip(shown, report.equations.channels, strict=True):
        assert line.split()[0] == channel.name
        assert channel.description in line


def test_changes_of_all_cases_are_checked_at_once(tmp_path):
    changes = [word for text in ("trail=1 kg", "trail=2 s", "foo=1", "foo=2")
               for word in ("--set", text)]  # fmt: skip
    done = call(["vehicledyn", "eig", SYSTEMS / "bicycle.yaml", *changes], tmp_path)
    assert done.returncode == 2
    assert "this is in kg" in done.stderr
    assert "this is in s" in done.stderr
    assert "--set foo: " in done.stderr
    assert done.stderr.rstrip().endswith(f"3 problems in {SYSTEMS / 'bicycle.yaml'}")


def test_the_report_of_an_equilibrium_is_json(tmp_path):
    options = ["--backend", "interpreted", "--json"]
    done = call(["vehicledyn", "equilibrium", SYSTEMS / "quarter_car.yaml", *options], tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["stability"]["verdict"] == "stable"
