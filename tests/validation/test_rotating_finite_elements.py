"""A blade from finite elements that rotates has the published frequencies, by its stiffening.

Uniform cantilever, hub ratio 0: frequencies over sqrt(EI/(ρA L⁴)) by the rotation over the same, of
Wright et al. (1982), J. Appl. Mech. 49, 197-202 (flap), and flap² - η² without the coupling of
Coriolis' forces (chord).
"""

import casadi as ca
import numpy as np
import pytest
from finite_elements import straight

from vehicledyn.base.errors import InputError
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, derive
from vehicledyn.multibody.bodies.finite_elements.beam_frames import (
    BeamElement,
    Member,
    stiffened,
)
from vehicledyn.multibody.bodies.finite_elements.reading import write_archive
from vehicledyn.multibody.bodies.finite_elements.standard_input_writer import write_standard_input
from vehicledyn.multibody.elements.flexible.flexible_body import FlexibleBody

GIVEN = {"axial": 1e6, "torsion": 1e6, "bending": (1.0, 1.0), "mass": 1.0, "polar": 1e-3}
FLAP = {
    0: (3.516015, 22.034492, 61.697214),
    4: (5.585001, 24.273349, 63.966760),
    8: (9.256838, 29.995382, 70.292962),
    12: (13.170150, 37.603112, 79.614478),
}
COUNT = 32
ROOT = {"interface": {"root": 1}, "reference": "root", "modes": 14, "nodes": {"tip": COUNT + 1}}


@pytest.fixture(scope="module")
def blades(tmp_path_factory):
    folder = tmp_path_factory.mktemp("blades")
    model = straight(1.0, COUNT, GIVEN)
    element = BeamElement(**GIVEN)
    members = [Member(k, k + 1, element) for k in range(1, COUNT + 1)]
    write_archive(model, folder / "plain.npz")
    write_archive(stiffened(model, members, 1, [COUNT + 1]), folder / "stiffened.npz")
    return folder


def rotating(part):
    """Return the frequencies of a blade on a hub too heavy to be moved, as a function of η."""
    hub = Body("hub", GROUND, joints=(Joint("R3", "turn"),), mass=1.0, inertia=(1e9, 1e9, 1e9))
    e = derive(System("turn", ParameterTable(), (hub,), parts=(part,), gravity=(0.0, 0.0, 0.0)))
    matrix = ca.Function("a", [e.state], [ca.jacobian(e.rate, e.state)])
    names = [s.name for s in e.states]
    n = len(names) // 2

    def found(eta):
        state = np.zeros(2 * n)
        state[n + names.index("turn")] = eta
        keep = np.delete(np.arange(2 * n), [names.index("turn"), n + names.index("turn")])
        own = np.linalg.eigvals(np.array(matrix(state))[np.ix_(keep, keep)])
        return np.sort(own.imag[own.imag > 0.0])

    return found


@pytest.mark.long
def test_rotating_cantilever(blades):
    """Flap within 0.1 %, chord within 0.5 %; read back from standard input data equal to 1e-9."""
    blade = FlexibleBody("blade", body="hub", file=str(blades / "stiffened.npz"), **ROOT)
    frequencies = rotating(blade)
    for eta, flap in FLAP.items():
        found = frequencies(float(eta))
        for value in flap:
            assert np.abs(found / value - 1.0).min() < 1e-3
            chord = np.sqrt(value**2 - eta**2)
            assert np.abs(found / chord - 1.0).min() < 5e-3
    write_standard_input(blade.component_modes, blades / "blade.sid", {"root": 1, "tip": 33})
    again = FlexibleBody(
        "blade", body="hub", file=str(blades / "blade.sid"), interface={"root": 1, "tip": 33}
    )
    assert rotating(again)(8.0) == pytest.approx(frequencies(8.0), rel=1e-9)
    plain = rotating(FlexibleBody("blade", body="hub", file=str(blades / "plain.npz"), **ROOT))
    assert np.abs(plain(12.0) / FLAP[12][0] - 1.0).min() > 0.05


def test_stiffening_of_another_reference_is_refused(blades):
    other = {**ROOT, "interface": {"root": COUNT + 1}, "nodes": None}
    blade = FlexibleBody("blade", body="hub", file=str(blades / "stiffened.npz"), **other)
    with pytest.raises(InputError, match="held at node 1, the body is held at node 33; compute"):
        _ = blade.component_modes
    nodes = {**ROOT, "nodes": {"middle": 5}}
    blade = FlexibleBody("blade", body="hub", file=str(blades / "stiffened.npz"), **nodes)
    with pytest.raises(InputError, match="lacks the load 'force_5_x'; give those of the three"):
        _ = blade.component_modes


def zeros(n, **sizes):
    """Return a constant and a linear part of matrices by name."""
    return {name: [np.zeros(s), np.zeros((s[0], n, s[1]))] for name, s in sizes.items()}


def hand_written(bend):
    """Return standard input data of the blade with polynomials x²P_k, after Wallrapp's formulas.

    ``bend`` is the number of shapes in each plane. Order: those along y, then those along z.
    Stiffening is by the axial force of the centrifugal load, unit acceleration and tip force.
    """
    x, w = np.polynomial.legendre.leggauss(40)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    shapes = [np.polynomial.Polynomial([0, 0, 1]) * np.polynomial.Legendre.basis(
        k, domain=[0, 1]).convert(kind=np.polynomial.Polynomial) for k in range(bend)]  # fmt: skip
    phi = np.array([s(x) for s in shapes])
    slope, second = (np.array([s.deriv(d)(x) for s in shapes]) for d in (1, 2))
    over, moment, stiff = (phi * w) @ phi.T, (phi * w) @ x, (second * w) @ second.T
    first = phi @ w
    pulled, centrifugal, drawn = (
        (slope * (w * n)) @ slope.T for n in (1.0 - x, 0.5 * (1.0 - x**2), 1.0)
    )
    n, y, z = 2 * bend, slice(0, bend), slice(bend, 2 * bend)
    m = zeros(n, mdCM=(3, 1), J=(6, 1), Ct=(n, 3), Cr=(n, 3), Me=(n, n), Gr=(3, 3 * n),
              Ge=(n, 3 * n), Oe=(n, 6), ksigma=(n, 1), Ke=(n, n), De=(n, n))  # fmt: skip
    m["mdCM"][0][0], m["J"][0][1:3] = 0.5, 1.0 / 3.0
    m["mdCM"][1][1, y, 0] = m["mdCM"][1][2, z, 0] = first
    m["Ct"][0][y, 1] = m["Ct"][0][z, 2] = first
    m["Cr"][0][y, 2], m["Cr"][0][z, 1] = moment, -moment
    m["J"][1][3, y, 0] = m["J"][1][4, z, 0] = -moment
    for own in (y, z):
        m["Me"][0][own, own], m["Ke"][0][own, own] = over, stiff
        m["Ct"][1][own, own, 0] = -pulled
        m["Oe"][1][own, own, 1] = m["Oe"][1][own, own, 2] = centrifugal
    m["Oe"][1][y, y, 0] -= over
    m["Oe"][1][y, y, 2] -= over
    m["Oe"][1][z, z, 0] -= over
    m["Oe"][1][z, z, 1] -= over
    m["Oe"][1][y, z, 4] = m["Oe"][1][z, y, 4] = over
    m["Oe"][0][y, 3] = m["Oe"][0][z, 5] = moment
    m["Cr"][1][y, z, 0], m["Cr"][1][z, y, 0] = -over, over
    for k in range(bend):
        m["Gr"][0][1, 3 * k] = -2.0 * moment[k]
        m["Gr"][0][2, 3 * (bend + k)] = -2.0 * moment[k]
        m["Ge"][0][z, 3 * k] = 2.0 * over[:, k]
        m["Ge"][0][y, 3 * (bend + k)] = -2.0 * over[:, k]
    tip = zeros(n, origin=(3, 1), phi=(3, n), psi=(3, n), AP=(3, 3))
    tip["origin"][0][0] = 1.0
    tip["phi"][0][1, y] = tip["phi"][0][2, z] = [s(1.0) for s in shapes]
    tip["psi"][0][2, y] = [s.deriv()(1.0) for s in shapes]
    tip["psi"][0][1, z] = -tip["psi"][0][2, y]
    tip["AP"][0][:] = np.eye(3)
    tip["phi"][1][0, y, y] = tip["phi"][1][0, z, z] = -drawn
    return text_of(n, m, tip)


def text_of(n, matrices, tip):
    """Return the text of the file, as a preprocessor may lay it out."""

    def written(name, constant, linear):
        rows = constant.shape
        heads = {"order": 1, "nrow": rows[0], "ncol": rows[1], "nq": n, "nqn": 0, "structure": 3}
        yield name
        yield from (f"  {key:30} = {value}" for key, value in heads.items())
        for i, j in np.argwhere(constant):
            yield f"  m0({i + 1:3d},{j + 1:3d})  ={constant[i, j]:.14E}".replace("E", "D")
        for i, k, j in np.argwhere(linear):
            yield f"  m1({i + 1:3d},{k + 1:3d},{j + 1:3d})  ={linear[i, k, j]:.14E}"
        yield f"end {name}"

    lines = [f" 1 {n} :No. nodes, No. modes", "part", "new modal =", "refmod", "mass = 1.0D+00"]
    lines += [f"nelastq = {n}", "end refmod", "frame", "new node = 7", "rframe = body ref"]
    lines += [line for name, own in tip.items() for line in written(name, *own)]
    lines += ["end node", "end frame"]
    lines += [line for name, own in matrices.items() for line in written(name, *own)]
    return "\n".join([*lines, "end modal", "end part", ""])


@pytest.mark.long
def test_standard_input_written_by_hand(tmp_path):
    """Data of quadratures give the frequencies, deflection and shortening of the closed forms."""
    (tmp_path / "blade.SID_FEM").write_text(hand_written(6))
    blade = FlexibleBody(
        "blade", body="hub", file=str(tmp_path / "blade.SID_FEM"), interface={"tip": 7}
    )
    frequencies = rotating(blade)
    for eta, flap in FLAP.items():
        found = frequencies(float(eta))
        for value in flap[:2]:
            assert np.abs(found / value - 1.0).min() < 2e-4
            assert np.abs(found / np.sqrt(value**2 - eta**2) - 1.0).min() < 2e-4
    made = blade.component_modes
    _, linear, turned = made.frames["tip"]
    soft = 1.0 / (made.mass * made.frequencies**2)
    assert (linear * soft) @ linear.T == pytest.approx(np.diag([0.0, 1.0, 1.0]) / 3.0, abs=1e-9)
    assert (turned * soft)[2] @ linear[1] == pytest.approx(0.5, rel=1e-9)
    # Under a force P the tip comes nearer by ½ ∫ w'² dx = P²/15, with E I and the length one.
    q = soft * linear[2]
    assert 0.5 * q @ made.curved["tip"][0] @ q == pytest.approx(-1.0 / 15.0, rel=1e-9)
