"""The benchmark bicycle from its file alone: published eigenvalues, round tyres, turning."""

import contextlib
import io
import json
import sys
from pathlib import Path
from unittest import mock

import numpy as np
import pytest
from ruamel.yaml import YAML
from scipy.optimize import brentq

from vehicledyn.analyse.equilibrium import assemble
from vehicledyn.analyses.preparation.start_rates import start_rates
from vehicledyn.base.registry import find
from vehicledyn.cli import main
from vehicledyn.files.building.construct import build_system
from vehicledyn.files.system.read import read_system
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import derive

pytestmark = pytest.mark.validation

FILE = Path(__file__).parents[2] / "systems" / "bicycle.yaml"
REFERENCE = YAML(typ="safe").load(
    (Path(__file__).parent / "data" / "benchmark_bicycle.yaml").read_text(encoding="utf-8")
)
GRAVITY = 9.81
# The printed digits end at 5e-15; rounding in the linearised equations is some hundred times that.
DIGITS = 1e-11


def eigenvalues(*settings, file=FILE):
    """What ``vehicledyn eig`` finds, zeros of the free motions left out."""
    words = [word for setting in settings for word in ("--set", setting)]
    command = ["vehicledyn", "eig", str(file), *words, "--backend", "interpreted", "--json"]
    told = io.StringIO()
    with (
        mock.patch.object(sys, "argv", command),
        contextlib.redirect_stdout(told),
        pytest.raises(SystemExit) as end,
    ):
        main()
    assert end.value.code == 0
    modes = json.loads(told.getvalue())["speeds"][0]["modes"]
    found = np.array([complex(m["real"], m["imaginary"]) for m in modes])
    return found[np.abs(found) > 1e-4]


def test_a_speed_that_means_nothing_is_refused(capsys):
    command = ["vehicledyn", "eig", str(FILE), "--speed", "7 m/s"]
    with mock.patch.object(sys, "argv", command), pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 2
    assert "nothing in 'bicycle' depends on a speed" in capsys.readouterr().err


@pytest.mark.parametrize("speed", REFERENCE["speeds"])
def test_published_eigenvalues(speed):
    wanted = REFERENCE["speeds"][speed]
    found = eigenvalues(f"forward_speed={speed} m/s")
    values = [complex(*wanted["weave"])] if "weave" in wanted else []
    for value in [*values, *wanted["real"]]:
        assert np.abs(found - value).min() < DIGITS * (1.0 + abs(value)), value


def locked(folder, start=0.0):
    """The bicycle with its steer locked at an angle."""
    text = FILE.read_text(encoding="utf-8")
    assert "- R3 steer" in text
    path = folder / "locked.yaml"
    held = f"- {{kind: R3, name: steer, role: driven, start: {start} rad}}"
    path.write_text(text.replace("- R3 steer", held), encoding="utf-8")
    return path


@pytest.mark.parametrize("crown", [0.0, 0.02, 0.15])
def test_round_tyres_help_a_standing_bicycle(crown, tmp_path):
    """With the steer locked it falls as a rocker: T_xx λ² = g Σ m (h - crown).

    It turns about the line of the contacts; its height is crown + (h - crown) cos(lean).
    """
    found = eigenvalues(
        "forward_speed=0 m/s",
        f"rear.crown={crown} m",
        f"front.crown={crown} m",
        file=locked(tmp_path),
    )
    parts = ((85.0, 0.9, 9.2), (2.0, 0.3, 0.0603), (4.0, 0.7, 0.05892), (3.0, 0.35, 0.1405))
    inertia = sum(m * h * h + own for m, h, own in parts)
    pull = GRAVITY * sum(m * (h - crown) for m, h, _ in parts)
    assert np.abs(found - np.sqrt(pull / inertia)).min() < 1e-9


def test_wide_tyres_make_the_weave_stable_later():
    """A crown changes the modes smoothly: half of it, about half of the change."""
    sharp, thin, wide = (
        next(v for v in eigenvalues(f"rear.crown={c} m", f"front.crown={c} m") if v.imag > 0.0)
        for c in (0.0, 1e-3, 2e-3)
    )
    assert abs(thin - sharp) > 1e-3
    assert (wide - sharp) / (thin - sharp) == pytest.approx(2.0, abs=0.01)


TOTAL_MASS = 94.0


@pytest.mark.parametrize("crown", [0.0, 0.03])
def test_steady_turn_with_the_steer_held(crown, tmp_path):
    """At one lean the bicycle runs round for ever; the ground carries weight and turning."""
    path, speed = locked(tmp_path, start=0.1), 4.0
    given = {"rear": {"crown": crown}, "front": {"crown": crown}}
    model, problems = read_system(path, {"parameters": given})
    assert not problems
    equations = derive(build_system(model))
    kernel = compile_kernel(equations, backend="interpreted")
    names = [s.name for s in equations.states]
    rates = {"rear_wheel.spin": speed / 0.3, "frame.roll": 0.0}

    def at(lean):
        x = np.array([s.start for s in equations.states])
        x[names.index("frame.roll")] = lean
        x[list(equations.velocities)] = 0.0
        for name, rate in rates.items():
            if f"{name}_rate" in names:
                x[names.index(f"{name}_rate")] = rate
        z = assemble(kernel, 0.0, x, np.array([u.start for u in equations.unknowns]))
        return start_rates(kernel, rates, 0.0, x, z), z

    def falling(lean):
        x, z = at(lean)
        return kernel.rates(0.0, x, z)[names.index("frame.roll_rate")]

    lean = brentq(falling, -0.4, 0.0, xtol=1e-15)
    assert -0.25 < lean < -0.1
    found = []
    x, z = at(lean)
    simulate(
        kernel,
        find("solver", "dop853")(relative_tolerance=1e-12, absolute_tolerance=1e-12),
        start=0.0,
        stop=1.0,
        state=x,
        unknowns=z,
        interval=0.1,
        sink=lambda t, x, z, y: found.extend(y),
    )
    seen = dict(zip((c.name for c in equations.channels), np.array(found).T, strict=True))
    assert seen["frame.roll"] == pytest.approx(lean, abs=1e-10)
    turning = seen["frame.yaw_rate"]
    assert turning == pytest.approx(turning[0], rel=1e-10)
    assert turning[0] == pytest.approx(speed * 0.1 * np.cos(np.pi / 10.0) / 1.02, rel=0.1)
    normal = seen["rear_contact.normal_force"] + seen["front_contact.normal_force"]
    assert normal == pytest.approx(TOTAL_MASS * GRAVITY, rel=1e-9)
    # Acceleration of the centre of mass from its speed across: ω² R, about v ω.
    across = seen["rear_contact.lateral_force"] + seen["front_contact.lateral_force"]
    assert across == pytest.approx(TOTAL_MASS * speed * turning[0], rel=0.1)
