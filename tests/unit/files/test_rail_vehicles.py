"""Rail vehicles that come with the program: weights on their wheels, and compiled Jacobians."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyse import equilibrium
from vehicledyn.analyses.preparation.prepare import equilibrium_point, prepare
from vehicledyn.files.building.construct import build_system
from vehicledyn.files.scenario import load_model
from vehicledyn.files.system.read import read_system
from vehicledyn.kernel import derivatives
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import derive

pytestmark = pytest.mark.long

SYSTEMS = Path(__file__).parents[3] / "systems"


def equations_of(name):
    model, problems = read_system(SYSTEMS / f"{name}.yaml")
    assert not problems
    return derive(build_system(model))


def lifted_rates(name):
    """Return the rates of all states where every body is lifted off the rails alike."""
    equations = equations_of(name)
    kernel = compile_kernel(equations, backend="interpreted")
    names = [s.name for s in equations.states]
    state = np.array([s.start for s in equations.states])
    state[[n.endswith(".z") for n in names]] += 0.05
    return dict(zip(names, kernel.rates(0.0, state, np.zeros(0)), strict=True))


def test_preloads_of_the_manchester_vehicle_carry_its_weight():
    """Off the rails springs hold car and frames, and all the weight pulls the wheelsets."""
    rates = lifted_rates("manchester_vehicle_1")
    for body in ("car", "frame_1", "frame_2"):
        assert rates[f"{body}.z_rate"] == pytest.approx(0.0, abs=1e-9)
    load = 9.81 * (32000.0 / 4.0 + 2615.0 / 2.0)
    for number in (1, 2, 3, 4):
        assert rates[f"wheelset_{number}.z_rate"] == pytest.approx(-9.81 - load / 1813.0, rel=1e-9)


def test_preloads_of_the_tram_carry_its_weight():
    """Off the rails bodies on springs stay, and all the weight pulls the axle bridges."""
    rates = lifted_rates("tram2000")
    for body in ("centre", "truck", "front_beam_left", "rear_beam_left"):
        assert rates[f"{body}.z_rate"] == pytest.approx(0.0, abs=1e-9)
    falling = [v for n, v in rates.items() if "bridge" in n and n.endswith(".z_rate")]
    masses = 6 * 300.0 + 8 * 250.0 + 4 * 120.0
    own = [300.0 + 2 * (250.0 if "small" not in n else 120.0) for n in rates if "bridge" in n
           and n.endswith(".z_rate")]  # fmt: skip
    total = 2 * 8000.0 + 7000.0 + 2 * 250.0 + 4 * 350.0 + 900.0 + masses
    assert -np.dot(falling, own) == pytest.approx(9.81 * total, rel=1e-9)


def test_compiled_jacobian_is_that_of_casadi(needs_compiler, monkeypatch):
    equations = equations_of("rail_wheelset")
    state = np.array([s.start for s in equations.states])
    state[[s.name for s in equations.states].index("wheelset.vertical")] = -2e-4
    point = (0.0, state, np.zeros(0), np.array([p.value for p in equations.parameters]))
    plain = derivatives.Derivatives(equations, ["speed"]).total(*point)
    monkeypatch.setattr(derivatives, "_WORTH_COMPILING", 0)
    compiled = derivatives.Derivatives(equations, ["speed"], often=True).total(*point)
    for item in ("rates", "outputs", "rates_by_parameter", "outputs_by_parameter"):
        one, two = getattr(plain, item), getattr(compiled, item)
        assert two == pytest.approx(one, rel=1e-8, abs=1e-8 * np.abs(one).max())


@pytest.mark.parametrize("waiting", [0, 20])
def test_a_jacobian_is_compiled_once_the_compiler_pays(needs_compiler, monkeypatch, waiting):
    """The first evaluations of few columns do not wait for a compiler."""
    equations, made = equations_of("rail_wheelset"), []
    monkeypatch.setattr(derivatives, "_WORTH_WAITING", waiting)
    monkeypatch.setattr(derivatives, "_compiled", lambda *_: made.append(1))
    state = np.array([s.start for s in equations.states])
    values = np.array([p.value for p in equations.parameters])
    slopes = derivatives.Derivatives(equations, outputs=False)
    counts = []
    for _ in range(3):
        slopes.total(0.0, state, np.zeros(0), values)
        counts.append(len(made))
    assert counts == ([1, 1, 1] if waiting == 0 else [0, 0, 1])


def test_differences_find_the_equilibrium_of_exact_derivatives(needs_compiler, monkeypatch):
    def found(costly):
        monkeypatch.setattr(equilibrium, "_COSTLY", costly)
        taken = []
        exact = derivatives.Derivatives.total
        monkeypatch.setattr(
            derivatives.Derivatives, "total", lambda *point: taken.append(1) or exact(*point)
        )
        prepared = prepare(
            load_model("rail_wheelset"), backend="compiled", progress=lambda *_: None
        )
        return equilibrium_point(prepared, 0.0, "static"), len(taken)

    plain, often = found(np.inf)
    rough, never = found(0)
    assert often > 2 and never == 0
    assert rough.residual < 1e-9
    assert rough.state == pytest.approx(plain.state, rel=1e-9, abs=1e-13)
