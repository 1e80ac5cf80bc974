"""Non-holonomic systems against closed forms: rolling disk, skate on a slope, toroidal wheel."""

from pathlib import Path

import numpy as np
import pytest
from ruamel.yaml import YAML
from scipy.optimize import brentq

from vehicledyn.analyse.linearise import linearise
from vehicledyn.base.registry import find
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, derive
from vehicledyn.multibody.elements.rolling import RollingWheel
from vehicledyn.multibody.model.constraints import RateConstraint

REFERENCE = YAML(typ="safe").load(
    (Path(__file__).parent / "data" / "rolling_disk.yaml").read_text(encoding="utf-8")
)
RADIUS, GRAVITY, MASS = REFERENCE["radius"]["value"], REFERENCE["gravity"]["value"], 1.3
# Root finding and eigenvalues in double precision.
RATE = 1e-9
# dop853 at 1e-12.
MOTION = 1e-9

pytestmark = pytest.mark.validation


def rolling(share, *, crown=0.0, lean=0.0, spins=True):
    """A wheel of axle inertia ``share`` m r² and half of that about a diameter."""
    axle = share * MASS * RADIUS**2
    kinds = (("T1", "x"), ("T2", "y"), ("T3", "z"), ("R3", "yaw"), ("R1", "lean"), ("R2", "spin"))
    starts = {"z": RADIUS, "lean": lean}
    free = ("yaw", "lean", "spin")
    joints = tuple(
        Joint(k, n, starts.get(n, 0.0), "independent" if n in free else "auto") for k, n in kinds
    )
    inertia = (0.5 * axle, axle, 0.5 * axle)
    more = {"spins_about": 2} if spins else {}
    wheel = Body("wheel", GROUND, joints=joints, mass=MASS, inertia=inertia, **more)
    contact = RollingWheel("contact", "wheel", 2, RADIUS - crown, crown)
    gravity = (0.0, 0.0, -GRAVITY)
    return System("disk", ParameterTable(), (wheel,), gravity=gravity, constraints=(contact,))


SHARES = {"disk": 0.5, "hoop": 1.0}


def squared_eigenvalue(equations, rate, value):
    """The one λ² that is not zero: half the trace of A² of lean and the three rates."""
    x = np.array([s.start for s in equations.states])
    names = [s.name for s in equations.states]
    x[names.index(rate)] = value
    z = [u.start for u in equations.unknowns]
    a = linearise(equations, [], 0.0, x, z).matrix
    keep = [names.index(n) for n in ("lean", "lean_rate", "yaw_rate", "spin_rate")]
    inner = a[np.ix_(keep, keep)]
    return 0.5 * np.trace(inner @ inner)


@pytest.mark.parametrize("kind", SHARES)
@pytest.mark.parametrize(("case", "rate"), [("straight", "spin_rate"), ("upright", "yaw_rate")])
def test_critical_rates(kind, case, rate):
    equations = derive(rolling(SHARES[kind]))
    assert equations.structure["degrees_of_freedom"] == 3
    found = brentq(lambda w: squared_eigenvalue(equations, rate, w), 1.0, 6.0, xtol=1e-14)
    assert found == pytest.approx(REFERENCE[kind][case], rel=RATE)


def start(equations, **values):
    return np.array([values.get(s.name, s.start) for s in equations.states])


def run(equations, state, duration):
    kernel = compile_kernel(equations, backend="interpreted")
    found = []
    simulate(
        kernel,
        find("solver", "dop853")(relative_tolerance=1e-12, absolute_tolerance=1e-12),
        start=0.0,
        stop=duration,
        state=state,
        unknowns=[u.start for u in equations.unknowns],
        interval=duration / 20.0,
        sink=lambda t, x, z, y: found.extend(y),
    )
    return dict(zip((c.name for c in equations.channels), np.array(found).T, strict=True))


@pytest.mark.parametrize(("crown", "spins"), [(0.0, True), (0.0, False), (0.08, True)])
def test_energy_of_a_wobbling_wheel(crown, spins):
    equations = derive(rolling(0.6, crown=crown, lean=0.3, spins=spins))
    found = run(equations, start(equations, spin_rate=4.0, yaw_rate=0.7, lean_rate=-0.4), 2.0)
    energy = found["energy.kinetic"] + found["energy.gravity"]
    assert np.ptp(found["lean"]) > 0.1
    assert energy == pytest.approx(energy[0], rel=1e-10)
    assert found["constraints.position_error"].max() < 1e-12
    assert found["constraints.velocity_error"].max() < 1e-10


def test_steady_turn():
    """A leaning disk runs round for ever: the moments about the contact point balance.

    With A and C the inertias about a diameter and the axle, w₃ = ψ̇ cos θ and w₂ = spin + ψ̇ sin θ:
    (C + m r²) w₂ w₃ + m g r sin θ - A tan θ w₃² = 0.
    """
    lean, yaw_rate = 0.25, -1.5
    equations = derive(rolling(0.5, lean=lean))
    big, small = (0.5 + 1.0) * MASS * RADIUS**2, 0.25 * MASS * RADIUS**2

    def lean_acceleration(spin):
        x = start(equations, yaw_rate=yaw_rate, spin_rate=spin)
        kernel = compile_kernel(equations, backend="interpreted")
        z = [u.start for u in equations.unknowns]
        rates = kernel.rates(0.0, x, z)
        return rates[[s.name for s in equations.states].index("lean_rate")]

    spin = brentq(lean_acceleration, -30.0, 30.0, xtol=1e-13)
    across, weight = yaw_rate * np.cos(lean), MASS * GRAVITY * RADIUS * np.sin(lean)
    along = (small * np.tan(lean) * across**2 - weight) / (big * across)
    assert spin + yaw_rate * np.sin(lean) == pytest.approx(along, rel=1e-9)


def sloping_skate(slope):
    """A knife edge on a slope that falls along x, its centre of mass above the edge."""
    joints = (Joint("T1", "x"), Joint("T2", "y"), Joint("R3", "heading", role="independent"))
    body = Body("skate", GROUND, joints=joints, mass=2.0, inertia=(0.05,) * 3)
    edge = RateConstraint("edge", lambda m: (m.rotation("skate").T @ m.velocity("skate"))[1])
    gravity = (GRAVITY * np.sin(slope), 0.0, -GRAVITY * np.cos(slope))
    return System("skate", ParameterTable(), (body,), gravity=gravity, constraints=(edge,))


def test_skate_on_a_slope():
    """A knife edge on a slope drifts across it and never down (Chaplygin's sleigh at its mass).

    With the heading ω t: x = a/(2 ω²) sin² ωt, y = a/(2 ω²) (ωt - sin 2ωt/2), a = g sin α.
    """
    slope, turning = 0.4, 1.3
    pull = GRAVITY * np.sin(slope)
    equations = derive(sloping_skate(slope))
    duration = 1.1  # before the heading is across, where ẋ determines nothing
    found = run(equations, start(equations, heading_rate=turning), duration)
    angle = turning * np.linspace(0.0, duration, 21)
    size = pull / (2.0 * turning**2)
    assert found["x"] == pytest.approx(size * np.sin(angle) ** 2, abs=MOTION)
    assert found["y"] == pytest.approx(size * (angle - 0.5 * np.sin(2 * angle)), abs=MOTION)
