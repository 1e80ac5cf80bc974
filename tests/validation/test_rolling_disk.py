"""The rolling disk of the system file: critical rates from the command line, long motions."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from reference_cases.motions import quiet
from reference_cases.rolling_disk import STRAIGHT, UPRIGHT, Disk, G, critical_rate
from reference_cases.system_files import ROOT, TIGHT, motion, ready
from ruamel.yaml import YAML

from vehicledyn.analyses import find_modes
from vehicledyn.files.scenario import load_scenario

pytestmark = pytest.mark.validation

REFERENCE = YAML(typ="safe").load(
    (Path(__file__).parent / "data" / "rolling_disk.yaml").read_text(encoding="utf-8")
)
SHARES = {"disk": 0.5, "hoop": 1.0}
SCENARIO = ROOT / "scenarios" / "systems" / "rolling_disk.yaml"
RATE = 1e-6
STEEP = np.deg2rad(78.0)
REST = ("initial.disk.lean=0", "initial.disk.yaw_rate=0", "initial.disk.spin_rate=0")


def changes(share, *overrides):
    """Overrides of the scenario: an upright disk at rest, but for what is given."""
    return [f"parameters.axle_share={share}", *REST, *overrides]


def eigenvalues(share, *overrides):
    """Eigenvalues that ``vehicledyn eig`` finds for the scenario of the disk."""
    loaded = load_scenario(SCENARIO, changes(share, *overrides))
    report = find_modes(loaded, speeds=[], backend="interpreted", progress=quiet)
    (entry,) = report.as_dict()["speeds"]
    return np.array([complex(m["real"], m["imaginary"]) for m in entry["modes"]])


def test_command_line_tells_these_eigenvalues():
    # A key that is set twice would be two cases.
    overrides = dict(change.split("=", 1) for change in changes(0.5, f"{STRAIGHT}=2 rad/s"))
    command = [Path(sys.executable).parent / "vehicledyn", "eig", SCENARIO, "--json"]
    command += [word for item in overrides.items() for word in ("--set", "=".join(item))]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    (entry,) = json.loads(done.stdout)["speeds"]
    told = np.sort_complex([complex(m["real"], m["imaginary"]) for m in entry["modes"]])
    assert told == pytest.approx(np.sort_complex(eigenvalues(0.5, f"{STRAIGHT}=2 rad/s")), abs=1e-9)


@pytest.mark.parametrize("kind", SHARES)
@pytest.mark.parametrize(("case", "rate"), [("straight", STRAIGHT), ("upright", UPRIGHT)])
def test_critical_rates(kind, case, rate):
    """λ² of the one motion that is not free is linear in ω², so two rates tell where it is zero."""
    squares = {}
    for value in (2.0, 4.5):
        found = eigenvalues(SHARES[kind], f"{rate}={value} rad/s")
        assert np.sum(np.abs(found) < 1e-6) == 6
        largest = (found[np.argmax(np.abs(found))] ** 2).real
        squares[value] = largest
    assert squares[2.0] > 0.0 > squares[4.5]
    assert critical_rate(squares) == pytest.approx(REFERENCE[kind][case], rel=RATE)
    # The verdict changes there.
    for side, stable in ((-1.0, False), (1.0, True)):
        value = REFERENCE[kind][case] * (1.0 + side * RATE)
        real = eigenvalues(SHARES[kind], f"{rate}={value} rad/s").real
        assert (real.max() < 1e-6) == stable


@pytest.mark.parametrize("seed", range(6))
def test_accelerations_are_those_written_by_hand(seed):
    """At any lean, up to the near-flat disk."""
    random = np.random.default_rng(seed)
    share = (0.5, 1.0, 0.8)[seed % 3]
    prepared = ready("rolling_disk", f"axle_share={share}")
    lean = STEEP * (2.0 * random.uniform() - 1.0)
    rates = random.normal(scale=3.0, size=3)
    names = ("disk.lean", "disk.yaw", "disk.spin")
    given = {"disk.lean": lean, "disk.yaw": random.normal()}
    given |= {f"{n}_rate": v for n, v in zip(names, rates, strict=True)}
    e, kernel = prepared.equations, prepared.kernel
    state = np.array([given.get(s.name, s.start) for s in e.states])
    unknowns = kernel.solve_unknowns(0.0, state, np.array([u.start for u in e.unknowns]))
    found = dict(zip((s.name for s in e.states), kernel.rates(0.0, state, unknowns), strict=True))
    disk = Disk(1.0, 0.5, share)
    wanted = disk.accelerations(lean, rates)
    size = np.abs(wanted).max()
    for name, value in zip(names, wanted, strict=True):
        assert found[f"{name}_rate"] == pytest.approx(value, rel=1e-10, abs=1e-11 * size)
    outputs = kernel.outputs(0.0, state, unknowns)
    channels = dict(zip((c.name for c in e.channels), outputs, strict=True))
    normal = disk.normal_force(lean, rates)
    assert channels["contact.normal_force"] == pytest.approx(normal, rel=1e-10, abs=1e-10)
    assert channels["disk.z"] == pytest.approx(0.5 * np.cos(lean), rel=1e-12)


def steady(disk, lean, yaw_rate):
    """Spin rate of a steady turn: r m (w3 w2 r + g sin θ) - A tan θ w3² + C w2 w3 = 0."""
    w3, inertia = yaw_rate * np.cos(lean), disk.mass * disk.radius**2
    pull = disk.mass * G * disk.radius * np.sin(lean)
    w2 = (disk.diameter * np.tan(lean) * w3**2 - pull) / ((disk.axle + inertia) * w3)
    return w2 - yaw_rate * np.sin(lean)


@pytest.mark.parametrize(("lean", "yaw_rate"), [(0.3, -1.5), (0.9, -3.0), (-1.2, 5.0)])
def test_steady_turn_keeps_its_circle(lean, yaw_rate):
    disk = Disk(1.0, 0.5, 0.5)
    spin = float(steady(disk, lean, yaw_rate))
    run = motion(
        "rolling_disk",
        "duration=2 s",
        f"initial.disk.lean={lean} rad",
        f"initial.disk.yaw_rate={yaw_rate} rad/s",
        f"initial.disk.spin_rate={spin} rad/s",
        *TIGHT,
    )
    # Where the turn is unstable, rounding errors grow.
    assert run["disk.lean"] == pytest.approx(np.full(len(run.time), lean), abs=1e-8)
    radius = disk.radius * spin / yaw_rate
    x, y = run["contact_x"], run["contact_y"]
    middle = (x[0] - radius * np.sin(0.0), y[0] + radius * np.cos(0.0))
    assert np.hypot(x - middle[0], y - middle[1]) == pytest.approx(abs(radius), rel=1e-7)


MOTIONS = {
    "wave": (0.35, 1.0, 4.0, 0.0),
    "steep": (1.25, 0.4, 2.0, 0.0),
    "coin": (0.6, 6.0, -0.5, 0.3),
}


@pytest.mark.parametrize("name", MOTIONS)
def test_motion_is_that_of_the_equations_written_by_hand(name):
    """Lean, yaw, spin and the path of the contact over ten seconds, integrated twice."""
    lean, yaw_rate, spin, lean_rate = MOTIONS[name]
    run = motion(
        "rolling_disk",
        "duration=10 s",
        "output.interval=20 ms",
        f"initial.disk.lean={lean} rad",
        f"initial.disk.lean_rate={lean_rate} rad/s",
        f"initial.disk.yaw_rate={yaw_rate} rad/s",
        f"initial.disk.spin_rate={spin} rad/s",
        *TIGHT,
    )
    disk = Disk(1.0, 0.5, 0.5)
    start = [lean, 0.0, 0.0, lean_rate, yaw_rate, spin]
    start += [run["contact_x"][0], run["contact_y"][0]]
    wanted = disk.motion(start, run.time)
    names = ("disk.lean", "disk.yaw", "disk.spin", "disk.lean_rate", "disk.yaw_rate")
    names = (*names, "disk.spin_rate", "contact_x", "contact_y")
    for row, channel in zip(wanted, names, strict=True):
        size = max(1.0, np.abs(row).max())
        assert np.abs(run[channel] - row).max() < 1e-7 * size, channel


def test_long_motion_keeps_energy_and_constraints():
    """A minute of a leaning disk: as good as the integrator."""
    run = motion("rolling_disk", "duration=60 s", "output.interval=50 ms", *TIGHT)
    energy = run["energy.kinetic"] + run["energy.gravity"]
    assert np.ptp(run["disk.lean"]) > 0.5
    assert energy == pytest.approx(energy[0], rel=1e-9)
    assert run["constraints.position_error"].max() < 1e-12
    assert run["constraints.velocity_error"].max() < 1e-12
