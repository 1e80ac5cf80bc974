"""Bodies from finite elements in motion: against the beam of assumed modes, and left to itself."""

import casadi as ca
import numpy as np
import pytest
from finite_elements import assembled, straight
from scipy.integrate import solve_ivp

from vehicledyn.base.errors import InputError
from vehicledyn.multibody import (
    GROUND,
    Body,
    Joint,
    ParameterTable,
    System,
    TimeLaw,
    derive,
)
from vehicledyn.multibody.bodies.finite_elements.reading import write_archive
from vehicledyn.multibody.elements.flexible.beam import Beam, Modes, Stiffness
from vehicledyn.multibody.elements.flexible.flexible_body import FlexibleBody, Matrices

LENGTH, BENDING, MASS = 1.5, 300.0, 2.0
STIFF = {"axial": 1e8, "torsion": 1e4, "bending": (BENDING, 1e6), "mass": MASS, "polar": 1e-3}


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("beam") / "beam.npz"
    write_archive(straight(LENGTH, 16, STIFF), path)
    return str(path)


def clamped(file, **more):
    """The beam held at its start, whose only modes up to some frequency bend it along y."""
    return FlexibleBody(
        "beam", body="hub", file=file, interface={"start": 1}, reference="start",
        nodes={"tip": 17}, modes=3, **more,
    )  # fmt: skip


def moved(system, times, start=None, tolerance=1e-10):
    """Return channels by name at some times, and the equations."""
    e = derive(system)
    state = np.array([s.start for s in e.states]) if start is None else start
    rate = ca.Function("f", [e.time, e.state], [e.rate])
    found = solve_ivp(
        lambda t, x: np.array(rate(t, x))[:, 0], (times[0], times[-1]), state, "DOP853", times,
        rtol=tolerance, atol=1e-13,
    )  # fmt: skip
    out = ca.Function("y", [e.time, e.state], [e.output])
    values = np.array([np.array(out(t, x))[:, 0] for t, x in zip(times, found.y.T, strict=True)])
    return dict(zip([c.name for c in e.channels], values.T, strict=True)), found.y, e


def turning(part):
    """A hub that turns by two turns and stops, with a part on it."""
    hub = Body("hub", GROUND, joints=(Joint("R3", "turn", role="driven"),))

    def angle(t):
        return 4.0 * np.pi * t / 3.0 - 2.0 * ca.sin(2.0 * np.pi * t / 3.0)

    law = TimeLaw("spin", "turn", angle)
    return System("turn", ParameterTable(), (hub,), parts=(part, law), gravity=(0.0, 0.0, 0.0))


@pytest.mark.long
def test_turns_as_the_beam_of_assumed_modes_does(file):
    """Its end deflects as that of the beam while both turn by two turns, to 1e-3 of the peak."""
    stiffness = Stiffness(mass_per_length=MASS, y=BENDING)
    beam = Beam(
        "beam", body="hub", length=LENGTH, stiffness=stiffness, modes=Modes(y=4),
        stiffening="none",
    )  # fmt: skip
    times = np.linspace(0.0, 3.0, 61)
    wanted = moved(turning(beam), times)[0]["beam.tip_y"]
    found = moved(turning(clamped(file)), times)[0]["beam.tip_y"]
    peak = np.abs(wanted).max()
    assert peak > 0.03 * LENGTH
    assert np.abs(found - wanted).max() < 1e-3 * peak


@pytest.mark.long
def test_a_free_frame_keeps_momentum_and_energy_as_it_tumbles(tmp_path):
    """A frame that tumbles and vibrates for a second keeps them to 1e-9."""
    given = {"axial": 5e3, "torsion": 200.0, "bending": (500.0, 300.0), "mass": 2.0, "polar": 0.1}
    places = [(0, 0, 0), (0.5, 0, 0.1), (1, 0.1, 0), (1.5, 0, 0), (1, 0.6, 0)]
    members = [(0, 1), (1, 2), (2, 3), (2, 4)]
    write_archive(assembled(places, members, given), tmp_path / "frame.npz")
    joints = tuple(Joint(kind, f"hub.{kind}") for kind in ("T1", "T2", "T3", "R1", "R2", "R3"))
    frame = FlexibleBody(
        "frame", body="hub", file=str(tmp_path / "frame.npz"), interface={"a": 1, "b": 4},
        modes=1, highest_frequency=20.0,
    )  # fmt: skip
    none = (0.0, 0.0, 0.0)
    system = System(
        "free",
        ParameterTable(),
        (Body("hub", GROUND, joints=joints),),
        parts=(frame,),
        gravity=none,
    )
    start = np.random.default_rng(4).normal(size=2 * (6 + len(frame.flexibility.coordinates)))
    names = [s.name for s in derive(system).states]
    start[[k for k, name in enumerate(names) if ".mode_" in name]] *= 0.05
    times = np.linspace(0.0, 1.0, 5)
    seen, states, e = moved(system, times, start, 1e-12)
    total = seen["energy.kinetic"] + seen["frame.strain_energy"]
    assert total == pytest.approx(total[0], rel=1e-9)
    assert np.ptp(seen["frame.strain_energy"]) > 1e-2 * total[0]
    rates = e.state[len(names) // 2 :]
    kinetic = e.output[[c.name for c in e.channels].index("energy.kinetic")]
    push = ca.Function("p", [e.state], [ca.gradient(kinetic, rates)[:3]])
    momenta = np.array([np.array(push(x))[:, 0] for x in states.T])
    assert momenta == pytest.approx(np.tile(momenta[0], (5, 1)), rel=1e-9)


def test_two_halves_are_the_whole(tmp_path):
    """Two bodies from finite elements, the second on the tip of the first, have its frequencies."""
    write_archive(straight(LENGTH, 6, STIFF), tmp_path / "whole.npz")
    write_archive(straight(0.5 * LENGTH, 3, STIFF), tmp_path / "half.npz")
    ends = {"start": 1, "tip": 4}
    first, second = (
        FlexibleBody(
            name,
            body=body,
            file=str(tmp_path / "half.npz"),
            interface=ends,
            reference="start",
            modes=0,
            nodes={"next": 2, "last": 3},
        )
        for name, body in (("first", GROUND), ("second", "first.tip"))
    )
    e = derive(System("halves", ParameterTable(), (), parts=(first, second), gravity=(0.0,) * 3))
    n = len(e.states) // 2
    matrix = ca.Function("a", [e.state], [ca.jacobian(e.rate, e.state)])(np.zeros(2 * n))
    found = np.sort(np.sqrt(-np.linalg.eigvals(np.array(matrix)[n:, :n]).real))
    whole = FlexibleBody(
        "whole", body=GROUND, file=str(tmp_path / "whole.npz"),
        interface={"start": 1, "middle": 4, "tip": 7}, reference="start", modes=0,
    )  # fmt: skip
    assert found == pytest.approx(whole.component_modes.frequencies, rel=1e-7)


def test_modes_are_damped_as_said(file):
    """Each mode loses what its damping ratio says: 2 ζ ω q̇ over its mass."""
    e = derive(turning(clamped(file, damping_ratio=0.02, damping_ratios=(0.01,))))
    n = len(e.states) // 2
    matrix = ca.Function("a", [e.time, e.state], [ca.jacobian(e.rate, e.state)])(
        0.0, np.zeros(2 * n)
    )
    frequencies = clamped(file).component_modes.frequencies
    wanted = -2.0 * np.array([0.01, 0.02, 0.02]) * frequencies
    assert np.diag(np.array(matrix)[n:, n:]) == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"file": None}, "file: give an archive or matrices, not neither"),
        ({"matrices": Matrices(nodes="n", mass="m", stiffness="k")}, "not both"),
        ({"interface": {}}, "interface: names no node"),
        ({"damping_ratios": (-0.1,)}, "damping_ratios: a ratio is negative"),
        ({"damping_ratios": (0.1,) * 9}, "damping_ratios: are 9, the body has 3 modes; give at"),
        ({"file": "none.npz"}, "none.npz: there is no such file"),
        ({"nodes": {"tip": 99}}, "nodes.tip: .*beam.npz has no node 99; the nearest number is 17"),
        ({"nodes": {"start": 2}}, "nodes.start: is also the name of an interface; take another"),
        ({"modes": -1}, "modes: there are no -1 of them; give 0 or more"),
        ({"highest_frequency": 1e-3}, "highest_frequency: is below the lowest of the body"),
    ],
)
def test_what_is_no_body_is_refused(file, change, words):
    settings = {"file": file, "interface": {"start": 1}, "modes": 3, "reference": "start"}
    with pytest.raises(InputError, match=words):
        derive(turning(FlexibleBody("beam", body="hub", **{**settings, **change})))


def test_it_is_taken_hold_of_at_frames_only(file):
    """A body cannot hang on a node that is neither interface nor kept; messages list those."""
    bodies = Body("hub", GROUND, joints=(Joint("R3", "turn"),)), Body("load", "beam.end", mass=1.0)
    with pytest.raises(InputError, match=r"'beam' has no frame 'end'; it has start, tip"):
        derive(System("x", ParameterTable(), bodies, parts=(clamped(file),)))
    with pytest.raises(InputError, match="'end' is neither interface nor kept node of 'beam'"):
        clamped(file).flexibility.place_of("end")
