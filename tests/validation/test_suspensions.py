"""The suspensions in motion and at rest against the principle of virtual work."""

import numpy as np
import pytest
from reference_cases.motions import SCENARIOS, quiet
from reference_cases.suspensions import NAMES, SYSTEMS, swept

from vehicledyn.analyses import find_equilibrium
from vehicledyn.analyses.preparation.prepare import prepare, start_point
from vehicledyn.files.scenario import load_model, load_scenario
from vehicledyn.integrate.simulate import simulate

G = 9.81
LINK = {"five_link": 3.0}  # kg, the lower rear link

pytestmark = pytest.mark.validation


def at_rest(name):
    """Forces and coordinates in equilibrium."""
    model = load_model(str(SYSTEMS / f"{name}_suspension.yaml"))
    report = find_equilibrium(model, speed=None, backend="auto", progress=quiet)
    return {row.name: row.equilibrium for row in (*report.forces, *report.coordinates)}


@pytest.mark.parametrize("name", NAMES)
def test_wheel_load_is_the_weight(name):
    total = 350.0 + 40.0 + LINK.get(name, 0.0)
    assert at_rest(name)["tyre.force"] == pytest.approx(-total * G, rel=1e-9)


@pytest.mark.parametrize("name", NAMES)
def test_the_strut_carries_by_its_motion_ratio(name):
    """Virtual work with the chassis held: tyre, strut and the weights that move with the wheel.

    The velocity ratio of the sweep knows nothing of forces, the equilibrium nothing of ratios.
    """
    rest = at_rest(name)
    length = _strut_length(name, rest)
    place = swept(name, {"strut.length": f"{length!r} m", "rack.displacement": "0 mm"})
    (leverage,) = 1.0 / place["ratio.strut.length.wheel.z"]
    # The corner's centre of mass is the wheel centre; the link's goes half its outer end's way.
    carried = 40.0 * G
    if name == "five_link":
        carried += 3.0 * G * _share(place) * leverage
    lifted = -rest["tyre.force"] - carried
    # Positive in tension, while the strut shortens as the wheel rises.
    assert rest["strut.force"] * leverage == pytest.approx(lifted, rel=1e-6)


def _strut_length(name, rest):
    """The length at which the spring of the file gives the force in equilibrium."""
    springs = {
        "five_link": (45e3, 0.543),
        "double_wishbone": (60e3, 0.58),
        "macpherson": (22e3, 0.605),
    }
    stiffness, free = springs[name]
    return float(free + rest["strut.force"] / stiffness)


def _share(place):
    """Rise of the link's centre of mass a unit of the strut's length: half of its end's rise."""
    roll = place["link.roll"][0]
    yaw = place["link.yaw"][0]
    along = np.array([57.0, 350.5, -3.5]) * 1e-3
    by_roll = (
        np.cos(roll) * (np.sin(yaw) * along[0] + np.cos(yaw) * along[1]) - np.sin(roll) * along[2]
    )
    by_yaw = np.sin(roll) * (np.cos(yaw) * along[0] - np.sin(yaw) * along[1])
    turn, swing = (place[f"ratio.strut.length.link.{n}"][0] for n in ("roll", "yaw"))
    return 0.5 * (by_roll * turn + by_yaw * swing)


@pytest.mark.parametrize("name", NAMES)
def test_wheels_follow_the_sweep_while_they_ride(name):
    """Steer angles and camber of the run are those of the kinematics at the same places."""
    loaded = load_scenario(SCENARIOS / "systems" / f"{name}_suspension.yaml")
    prepared = prepare(loaded, backend="auto", progress=quiet)
    start = start_point(prepared, 0.0, "static")
    names = [c.name for c in prepared.equations.channels]
    rows = []
    simulate(
        prepared.kernel, loaded.scenario.solver, start=0.0, stop=0.45, state=start.state,
        unknowns=start.unknowns, interval=0.15,
        sink=lambda t, x, z, y: rows.extend(y.copy()), progress=quiet, happened=lambda *_: None,
    )  # fmt: skip
    seen = [dict(zip(names, row, strict=True)) for row in rows]
    for row in seen[1:]:
        drives = {
            "wheel.z": f"{float(row['wheel.z'])!r} m",
            "rack.displacement": f"{float(row['rack.displacement'])!r} m",
        }
        place = swept(name, drives)
        for channel in ("wheel.steer_angle", "wheel.camber", "wheel.half_track"):
            assert place[channel][0] == pytest.approx(row[channel], abs=1e-10), channel
    assert abs(seen[-1]["wheel.steer_angle"]) > 0.03
