"""Nets of rods: regular constraints that no partition serves for long, and multipliers do."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from nets import LENGTH, MASS, name, net, places
from scipy.integrate import solve_ivp
from test_closed_forms import four_bars

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.linear.eigenmodes import find_modes
from vehicledyn.analyses.preparation.prepare import equilibrium_point, prepare
from vehicledyn.analyses.preparation.start_rates import start_rates
from vehicledyn.analyses.simulation.partitions import partition_changes, rederived
from vehicledyn.analyses.simulation.partitions.repartitioning import simulate_monitored
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.registry import find
from vehicledyn.files.scenario import load_model
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import derive

pytestmark = pytest.mark.validation
GRAVITY = 9.81
SYSTEMS = Path(__file__).parents[2] / "systems"


@cache
def kernel_of(make, backend="interpreted"):
    system = make()
    return system, compile_kernel(derive(system), backend=backend)


class Run:
    """Samples of a run by channel, and the events of its constraint method."""

    def __init__(self, make, duration, interval, step=1e-3, *, backend="interpreted"):
        system, kernel = kernel_of(make, backend)
        e = kernel.equations
        found, self.happened = [], []
        self.method = e.structure["constraint_method"]
        self.statistics = simulate_monitored(
            system,
            kernel,
            find("solver", "rk4")(step=step),
            start=0.0,
            stop=duration,
            state=np.array([s.start for s in e.states]),
            unknowns=np.array([u.start for u in e.unknowns]),
            interval=interval,
            sink=lambda *parts: found.append(parts),
            progress=lambda what, part: None,
            happened=lambda what, time: self.happened.append(what),
        )
        self.time = np.concatenate([part[0] for part in found])
        outputs = np.concatenate([part[3] for part in found])
        names = [c.name for c in e.channels]
        self.channel = dict(zip(names, outputs.T, strict=True))
        self.names = names

    @property
    def energy(self):
        return self.channel["energy.kinetic"] + self.channel["energy.gravity"]

    def place(self, key):
        """Return where a point is; pinned ones have no channels."""
        if f"{name(key)}.x" not in self.channel:
            return np.outer(places(3, 3, 0.05)[key], np.ones(len(self.time)))
        return np.array([self.channel[f"{name(key)}.{axis}"] for axis in "xyz"])

    def velocity(self, key):
        return np.array([self.channel[f"{name(key)}.{axis}_rate"] for axis in "xyz"])


def pinned_3():
    return net(3, 3, pinned=((0, 0), (0, 2)))


def hanging_6():
    return net(3, 2, pinned=((0, 0),))


def hanging_3():
    return net(3, 3, pinned=((0, 0),))


def pinned_6():
    return net(6, 6, pinned=((0, 0), (0, 5)))


def spin(place):
    return np.cross([0.3, 1.0, 0.5], place)


def free_4():
    return net(4, 4, rates=spin)


def pinned_2():
    return net(2, 2, pinned=((0, 0),))


def pinned_2_by_multipliers():
    return net(2, 2, pinned=((0, 0),), method="multipliers")


@pytest.mark.parametrize("make", [pinned_3, hanging_3])
@pytest.mark.parametrize("interval", [1e-3, 1e-2, 0.1])
def test_nine_points_and_twelve_rods_swing(make, interval):
    """The energy stays, whatever the output interval."""
    run = Run(make, 0.8, interval)
    assert run.method == "multipliers"
    assert run.time == pytest.approx(np.arange(len(run.time)) * interval, abs=1e-12)
    assert np.abs(run.energy - run.energy[0]).max() < 1e-5 * run.channel["energy.kinetic"].max()
    assert run.channel["constraints.position_error"].max() < 1e-12
    assert run.channel["constraints.velocity_error"].max() < 1e-12
    assert run.channel["constraints.position_drift"].max() < 1e-7


def test_energy_error_falls_with_the_order_of_the_method():
    errors = [np.ptp(Run(pinned_3, 0.8, 0.1, step).energy) for step in (4e-3, 2e-3)]
    assert errors[0] > 12.0 * errors[1]


def test_a_net_of_six_by_six_points():
    run = Run(pinned_6, 0.3, 0.01)
    assert np.abs(run.energy - run.energy[0]).max() < 1e-6 * run.channel["energy.kinetic"].max()
    length = np.linalg.norm(run.place((2, 3)) - run.place((2, 4)), axis=0)
    assert np.ptp(length) < 1e-11


def test_a_free_net_keeps_its_momenta():
    """It falls as one mass; angular momentum about the centre of mass and energy stay."""
    run = Run(free_4, 0.5, 0.01)
    keys = [(i, j) for i in range(4) for j in range(4)]
    places = np.array([run.place(key) for key in keys])
    speeds = np.array([run.velocity(key) for key in keys])
    centre, drift = places.mean(axis=0), speeds.mean(axis=0)
    fall = centre[2, 0] + drift[2, 0] * run.time - 0.5 * GRAVITY * run.time**2
    assert centre[2] == pytest.approx(fall, abs=1e-11)
    assert centre[0] == pytest.approx(centre[0, 0] + drift[0, 0] * run.time, abs=1e-11)
    about = np.cross(places - centre, MASS * (speeds - drift), axis=1).sum(axis=0)
    assert np.abs(about - about[:, :1]).max() < 1e-10 * np.abs(about).max()
    assert np.abs(run.energy - run.energy[0]).max() < 1e-9 * run.energy[0]


def test_rod_forces_balance_the_points():
    """Each point accelerates as gravity and the axial forces of its rods make it."""
    run = Run(pinned_3, 0.4, 0.1)
    system, kernel = kernel_of(pinned_3)
    e = kernel.equations
    sums = {(i, j): np.zeros(3) for i in range(3) for j in range(3)}
    for cut in system.cuts:
        a, b = (tuple(map(int, body[1:].split("_"))) for body in (cut.body_a, cut.body_b))
        along = run.place(b)[:, -1] - run.place(a)[:, -1]
        pull = run.channel[f"{cut.name}.axial_force"][-1] * along / np.linalg.norm(along)
        sums[a] += pull
        sums[b] -= pull
    state = np.array([run.channel[s.name][-1] for s in e.states])
    rates = dict(zip((s.name for s in e.states), kernel.rates(0.4, state, []), strict=True))
    for key, force in sums.items():
        if key in ((0, 0), (0, 2)):
            continue
        found = [rates[f"{name(key)}.{axis}_rate"] for axis in "xyz"]
        assert MASS * np.array(found) == pytest.approx(force - [0, 0, MASS * GRAVITY], abs=1e-8)


@pytest.mark.parametrize("interval", [1e-3, 1e-2])
def test_four_points_by_both_methods(interval):
    """The partition changes as the net swings; both ways lead to the same place."""
    partitioned, projected = (
        Run(make, 0.5, interval) for make in (pinned_2, pinned_2_by_multipliers)
    )
    assert (partitioned.method, projected.method) == ("partitioning", "multipliers")
    end = partitioned.place((1, 1))[:, -1]
    assert end == pytest.approx(projected.place((1, 1))[:, -1], abs=2e-5)


def one_rod():
    return net(2, 1, pinned=((0, 0),), bend=0.0, method="multipliers")


def test_a_pendulum_of_one_rod_is_the_mathematical_one():
    run = Run(one_rod, 1.0, 0.1)
    exact = solve_ivp(
        lambda t, x: [x[1], -GRAVITY / LENGTH * np.sin(x[0])],
        (0, 1),
        [np.pi / 2, 0],
        method="DOP853",
        rtol=1e-12,
        atol=1e-12,
    ).y[0, -1]
    assert run.place((1, 0))[:, -1] == pytest.approx(
        [LENGTH * np.sin(exact), 0.0, -LENGTH * np.cos(exact)], abs=1e-7
    )


def parallelogram():
    return replace(four_bars(1), constraint_method="multipliers")


def test_a_true_singularity_is_named():
    """Bars in one line: the constraints lose their rank, and the run says where."""
    with pytest.raises(NumericalError, match="lose their rank"):
        Run(parallelogram, 3.0, 0.1)


def test_a_given_rate_is_kept():
    """The rate of one bar is given; those of the others follow, as with partitioning."""
    found = []
    for method in ("multipliers", "partitioning"):
        kernel = compile_kernel(
            derive(replace(four_bars(1), constraint_method=method)), backend="interpreted"
        )
        e = kernel.equations
        state = np.array([s.start for s in e.states])
        unknowns = np.array([u.start for u in e.unknowns])
        state[list(e.velocities)] = 0.0
        given = {"upright_1.angle": 2.0}
        moving = start_rates(kernel, given, 0.0, state, unknowns)
        outputs = kernel.outputs(0.0, moving, unknowns)
        names = [c.name for c in e.channels]
        kept = [outputs[names.index(e.states[k].name)] for k in e.velocities]
        assert moving[list(e.velocities)] == pytest.approx(np.array(kept), abs=1e-12)
        wanted = ("upright_0.angle_rate", "coupler_0.angle_rate", "upright_1.angle_rate")
        found.append([outputs[names.index(name)] for name in wanted])
    assert found[0] == pytest.approx(found[1], abs=1e-12)
    assert found[0][2] == pytest.approx(2.0, abs=1e-12)


def test_an_equilibrium_is_that_of_partitioning(tmp_path):
    """Both give the same point; a run with multipliers starts there and stays."""
    written = (SYSTEMS / "four_bar.yaml").read_text(encoding="utf-8")
    found = {}
    for method in ("multipliers", "partitioning"):
        path = tmp_path / f"{method}.yaml"
        path.write_text(f"constraint_method: {method}\n{written}", encoding="utf-8")
        prepared = prepare(
            load_model(str(path)), backend="interpreted", progress=lambda what, part: None
        )
        assert prepared.equations.structure["constraint_method"] == method
        point = equilibrium_point(prepared, 0.0, "static")
        outputs = prepared.kernel.outputs(0.0, point.state, point.unknowns)
        found[method] = dict(
            zip((c.name for c in prepared.equations.channels), outputs, strict=True)
        )
        still = point.state.copy()
        still[list(prepared.equations.velocities)] = 0.0
        assert np.abs(prepared.kernel.rates(0.0, still, point.unknowns)).max() < 1e-8
    coordinates = [c for c in found["partitioning"] if c.endswith(".angle")]
    assert coordinates
    for angle in coordinates:
        assert found["multipliers"][angle] == pytest.approx(found["partitioning"][angle], abs=1e-10)


SPRING, REST = 150.0, 0.3


def sprung_net_file(path):
    """Write a net of 3 by 3 points, pinned at two, each held by three springs to the ground."""
    at = places(3, 3, 0.05)
    lines = ["title: A net of rods on springs", "bodies:"]
    for key, place in at.items():
        if key in ((0, 0), (0, 2)):
            continue
        starts = ", ".join(
            f"{{kind: T{k + 1}, name: {'xyz'[k]}, start: {float(place[k])!r} m}}" for k in range(3)
        )
        lines += [f"  {name(key)}:", f"    joints: [{starts}]", f"    mass: {MASS} kg"]
    lines.append("springs:")
    for key in at:
        if key in ((0, 0), (0, 2)):
            continue
        for axis, place in zip("xyz", at[key], strict=True):
            law = f"{{kind: spring_damper, stiffness: {SPRING} N/m, damping: 2 N*s/m"
            law += f", free_length: {float(place) - 0.02!r} m}}"
            lines += [
                f"  hold_{name(key)}_{axis}:",
                f"    coordinate: {name(key)}.{axis}",
                f"    law: {law}",
            ]
    lines.append("cuts:")
    for a, b in rods():
        length = float(np.linalg.norm(at[a] - at[b]))
        ends = [
            f"{{body: {name(key)}}}"
            if key not in ((0, 0), (0, 2))
            else f"{{body: ground, point: [{', '.join(f'{float(x)!r} m' for x in at[key])}]}}"
            for key in (a, b)
        ]
        lines += [
            f"  rod_{a[0]}{a[1]}_{b[0]}{b[1]}:",
            "    kind: rod",
            f"    a: {ends[0]}",
            f"    b: {ends[1]}",
            f"    length: {length!r} m",
        ]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def rods():
    found = [((i, j), (i + 1, j)) for i in range(2) for j in range(3)]
    return found + [((i, j), (i, j + 1)) for i in range(3) for j in range(2)]


def independent_eigenvalues(at):
    """Eigenvalues by projection of masses, stiffness and damping on the null space of the rods."""
    free = [key for key in at if key not in ((0, 0), (0, 2))]
    column = {key: slice(3 * k, 3 * k + 3) for k, key in enumerate(free)}
    n, nominal = 3 * len(free), places(3, 3, 0.05)
    jacobian, along = np.zeros((12, n)), []
    for row, (a, b) in enumerate(rods()):
        apart = at[b] - at[a]
        along.append(apart / np.linalg.norm(apart))
        for key, sign in ((a, -1.0), (b, 1.0)):
            if key in column:
                jacobian[row, column[key]] = sign * along[-1]
    pull = np.concatenate(
        [-SPRING * (at[key] - nominal[key] + 0.02) - [0.0, 0.0, MASS * GRAVITY] for key in free]
    )
    tensions = np.linalg.lstsq(jacobian.T, pull, rcond=None)[0]
    assert np.abs(jacobian.T @ tensions - pull).max() < 1e-6
    stiffness = SPRING * np.eye(n)
    for (a, b), unit, tension in zip(rods(), along, tensions, strict=True):
        length = np.linalg.norm(at[b] - at[a])
        # Jᵀ T balances the pull, so the potential of the constraints is T (length - constant).
        block = tension / length * (np.eye(3) - np.outer(unit, unit))
        for first, sign in ((a, -1.0), (b, 1.0)):
            for second, other in ((a, -1.0), (b, 1.0)):
                if first in column and second in column:
                    stiffness[column[first], column[second]] += sign * other * block
    basis = np.linalg.svd(jacobian)[2][12:].T
    mass, damping = MASS * basis.T @ basis, 2.0 * basis.T @ basis
    reduced = basis.T @ stiffness @ basis
    size = len(mass)
    whole = np.block(
        [
            [np.zeros((size, size)), np.eye(size)],
            [-np.linalg.solve(mass, reduced), -np.linalg.solve(mass, damping)],
        ]
    )
    return np.linalg.eigvals(whole)


def test_eigenvalues_of_a_net_on_springs(tmp_path):
    """A net that runs with multipliers is linearised in coordinates of its own choice."""
    path = tmp_path / "sprung_net.yaml"
    sprung_net_file(path)
    target = load_model(str(path))
    quiet = {"backend": "interpreted", "progress": lambda what, part: None}
    assert prepare(target, **quiet).has_multipliers
    prepared = prepare(target, **quiet, varies_states=True)
    point = equilibrium_point(prepared, 0.0, "static")
    outputs = prepared.kernel.outputs(0.0, point.state, point.unknowns)
    values = dict(zip((c.name for c in prepared.equations.channels), outputs, strict=True))
    at = {
        key: np.array([values.get(f"{name(key)}.{axis}", place[k]) for k, axis in enumerate("xyz")])
        for key, place in places(3, 3, 0.05).items()
    }
    expected = independent_eigenvalues(at)
    found = [mode.eigenvalue for mode in find_modes(target, speeds=(), **quiet).speeds[0].modes]
    everything = np.concatenate([found, np.conj([value for value in found if value.imag != 0.0])])
    assert by_frequency(everything) == pytest.approx(by_frequency(expected), abs=1e-6)


def by_frequency(values):
    return np.array(sorted(values, key=lambda value: value.imag))


@cache
def partitioned(make):
    """Return the maker of a net that partitioning is forced on."""
    return cache(lambda: replace(make(), constraint_method="partitioning"))


@pytest.mark.parametrize("make", [pinned_3, hanging_3])
@pytest.mark.parametrize("interval", [1e-3, 1e-2, 0.1])
def test_partitioning_forced_on_a_net_is_accurate_or_fails(make, interval):
    """The partition changes at the step at which it degrades, before steps become inaccurate."""
    try:
        run = Run(partitioned(make), 0.8, interval)
    except NumericalError as error:
        assert "constraint_method: multipliers" in str(error)
        return
    assert run.method == "partitioning"
    assert "partition.changed" in run.happened
    assert np.abs(run.energy - run.energy[0]).max() < 1e-4 * run.channel["energy.kinetic"].max()


@pytest.mark.parametrize("interval", [1e-3, 1e-2, 0.1])
def test_four_points_keep_their_energy_through_changes_of_partition(interval):
    run = Run(pinned_2, 0.8, interval)
    assert run.happened.count("partition.changed") >= 2
    assert np.abs(run.energy - run.energy[0]).max() < 5e-7


def test_partitions_that_never_last_are_left_for_multipliers():
    """Six points, seven rods: the energy stays, and every sample is there once."""
    run = Run(hanging_6, 2.0, 0.01)
    assert run.method == "partitioning"
    assert run.happened.count("partition.changed") >= 6
    assert run.happened.count("constraint_method.changed") == 1
    assert run.time == pytest.approx(np.arange(201) * 0.01, abs=1e-12)
    assert np.abs(run.energy - run.energy[0]).max() < 1e-5 * run.channel["energy.kinetic"].max()
    assert np.isfinite(run.place((2, 1))).all()


def test_brief_partitions_are_interpreted_and_lasting_ones_compiled(monkeypatch):
    """Both give the same motion; a partition is compiled once it has lasted."""
    forced, made = partitioned(hanging_6), []
    usual = Run(forced, 0.5, 0.01, backend="compiled")

    def compiled(equations, **options):
        made.append(options.get("backend", "auto"))
        return compile_kernel(equations, **options)

    for module in (rederived, partition_changes):
        monkeypatch.setattr(module, "compile_kernel", compiled)
    monkeypatch.setattr(partition_changes, "_BRIEF", 50)
    monkeypatch.setattr(partition_changes.PartitionChanges, "_is_brief", lambda self, time: True)
    short = Run(forced, 0.5, 0.01, backend="compiled")
    assert short.happened == usual.happened
    assert made[:2] == ["interpreted", "auto"]
    assert made.count("interpreted") == usual.happened.count("partition.changed")
    assert short.energy == pytest.approx(usual.energy, abs=1e-9)
