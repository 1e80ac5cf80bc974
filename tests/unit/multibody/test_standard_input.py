"""Files of standard input data: written, read back, in other layouts, and with mistakes."""

import re

import numpy as np
import pytest
from finite_elements import assembled

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.bodies.finite_elements.beam_frames import (
    BeamElement,
    Member,
    stiffened,
)
from vehicledyn.multibody.bodies.finite_elements.reduced_modes import reduced_modes
from vehicledyn.multibody.bodies.finite_elements.reduction import component_modes
from vehicledyn.multibody.bodies.finite_elements.standard_input import read_standard_input
from vehicledyn.multibody.bodies.finite_elements.standard_input_modes import modes_from
from vehicledyn.multibody.bodies.finite_elements.standard_input_writer import write_standard_input
from vehicledyn.multibody.elements.flexible.flexible_body import FlexibleBody

GIVEN = {"axial": 5e3, "torsion": 20.0, "bending": (50.0, 30.0), "mass": 2.0, "polar": 0.1}
PLACES = [(0, 0, 0), (0.5, 0, 0.1), (1, 0.1, 0), (1.5, 0, 0), (1, 0.6, 0)]
MEMBERS = [(0, 1), (1, 2), (2, 3), (2, 4)]
ENDS = {"root": 1, "tip": 4}


def reduced(is_stiffened):
    frame = assembled(PLACES, MEMBERS, GIVEN)
    members = [Member(a + 1, b + 1, BeamElement(**GIVEN)) for a, b in MEMBERS]
    if is_stiffened:
        frame = stiffened(frame, members, 1, [4, 5])
    made = component_modes(frame, ENDS, 2, reference="root", kept={"side": 5})
    return reduced_modes(made)


@pytest.fixture
def file(tmp_path):
    write_standard_input(reduced(True), tmp_path / "frame.sid", {"root": 1, "tip": 4, "side": 5})
    return tmp_path / "frame.sid"


def signs(one, other):
    """Return by what the amplitudes of two descriptions of a body differ."""
    return np.sign((one.frames["tip"][1] * other.frames["tip"][1]).sum(axis=0))


@pytest.mark.parametrize("is_stiffened", [False, True])
def test_a_body_is_read_as_it_is_written(tmp_path, is_stiffened):
    """Frequencies, frames and all integrals that motion depends on, to 1e-9 of their size."""
    wanted = reduced(is_stiffened)
    write_standard_input(wanted, tmp_path / "a.sid")
    found = modes_from(read_standard_input(tmp_path / "a.sid"), {"root": 1, "tip": 2, "side": 3})
    assert found.frequencies == pytest.approx(wanted.frequencies, rel=1e-12)
    sign = signs(found, wanted)
    wide = np.concatenate([np.ones(4), np.repeat(sign, 3)])
    own, other = found.integrals, wanted.integrals
    moved = other.products.copy()
    moved[1:4, 1:4] += at_rest_share(other)
    assert own.products * np.outer(wide, wide) == pytest.approx(moved, abs=1e-9)
    turn = np.concatenate([np.ones(3), sign])
    left = own.turning * np.outer(turn, turn)
    assert left[:, 3:] == pytest.approx(other.turning[:, 3:], abs=1e-9)
    for name, (at, linear, turned) in wanted.frames.items():
        assert found.frames[name][0] == pytest.approx(at, abs=1e-12)
        assert found.frames[name][1] * sign == pytest.approx(linear, abs=1e-9)
        assert found.frames[name][2] * sign == pytest.approx(turned, abs=1e-9)
        if name in wanted.curved:
            bent = wanted.curved[name] * np.outer(sign, sign)
            assert found.curved[name] == pytest.approx(bent, abs=1e-9 * np.abs(bent).max())
    if is_stiffened:
        bent = other.second * np.outer(sign, sign)[:, :, None, None]
        assert own.second == pytest.approx(bent, abs=1e-9 * np.abs(bent).max())
    else:
        assert own.second is None


def at_rest_share(integrals):
    """Return ∫ x xᵀ dm that has the inertia which the body has beyond that of points."""
    turning = integrals.turning[:3, :3]
    return 0.5 * np.trace(turning) * np.eye(3) - turning


@pytest.mark.parametrize("lost", ["Gr", "Ge"])
def test_what_other_matrices_say_may_be_missing(tmp_path, lost):
    """Gyroscopic matrices of order 0 or of zeros, as some programs write them, say no less."""
    wanted = reduced(False)
    write_standard_input(wanted, tmp_path / "a.sid")
    text = (tmp_path / "a.sid").read_text()
    start, end = (re.search(rf"(?m)^ +{word}{lost}$", text).start() for word in ("", "end "))
    cut = re.sub(r"(?m)^ +m1.*\n" if lost == "Gr" else r"(?m)^ +m.*\n", "", text[start:end])
    (tmp_path / "b.sid").write_text(text[:start] + cut + text[end:])
    one, other = (
        modes_from(read_standard_input(tmp_path / name), {"tip": 2}) for name in ("a.sid", "b.sid")
    )
    assert other.integrals.products == pytest.approx(one.integrals.products, abs=1e-9)
    assert other.integrals.second is None


def test_symmetric_diagonal_and_unit_matrices(tmp_path, file):
    """Structures 1, 2 and 4 and short lines: one triangle of Ke, no entries of a unit Me."""
    text = file.read_text()
    lines = [" ".join(line.split()) for line in text.splitlines()]
    (tmp_path / "short.sid").write_text("\n".join(lines))
    long, short = (read_standard_input(path) for path in (file, tmp_path / "short.sid"))
    assert (short.matrices["Oe"].linear == long.matrices["Oe"].linear).all()
    head = text[: re.search(r"(?m)^ +Me$", text).start()]
    tail = text[re.search(r"(?m)^ +Gr$", text).start() :]
    tail = tail[: re.search(r"(?m)^ +Ke$", tail).start()]
    own = f"Me\nstructure = 4\nend Me\n{tail}Ke\nstructure = 2\n"
    n = long.count
    own += "".join(f"m0({k},{k}) = {k}.5\n" for k in range(1, n + 1))
    (tmp_path / "own.sid").write_text(f"{head}{own}m0(1,2) = 0.25\nend Ke\nend modal\nend part\n")
    found = read_standard_input(tmp_path / "own.sid").matrices
    assert (found["Me"].constant == np.eye(n)).all()
    assert found["Ke"].constant[1, 0] == found["Ke"].constant[0, 1] == 0.25


BAD = [
    ("nelastq = ", "nelastq = x", r":6: nelastq: 'x.*' is no whole number from 1 to 2000"),
    ("mass = ", "mass = -", r":5: mass: -4.* kg is not above zero"),
    ("m0( 1, 1) = ", "m0( 1, 1) = ?", r":\d+: .*m0\(1,1\): '\?.*' is no number"),
    ("m0( 1, 1) = ", "m0( 9, 1) = ", r":\d+: .*: m0\(9,1\) is outside of the matrix"),
    ("m0( 1, 1) = ", "m0( 1) = ", r":\d+: .*: 'm0\(1\)' is no entry of m0 or m1"),
    ("nrow = 3", "nrow = 4", r":\d+: origin: nrow: is 4 and must be 3 with nelastq = 8"),
    ("end refmod", "end modal", r":\d+: 'end modal' ends 'refmod' of line 4; each class has"),
    ("new node = 4", "new node = 1", r":\d+: node 1 is given twice"),
    ("new node = 4", "new node = a", r":\d+: is no 'new node = NUMBER'"),
    ("end part", "", r": ends within 'part'; the file is not whole"),
    ("part", "peace", r": has no line 'part': it is no file of standard input data"),
    ("Ct\n", "Dt\n", r":\d+: 'end Ct' ends 'Dt' of line"),
    ("ksigma", "K", r":\d+: 'end ksigma' ends 'K' of line"),
]


@pytest.mark.parametrize(("old", "new", "words"), BAD)
def test_mistakes_have_a_line(file, old, new, words):
    text = "\n".join(" ".join(line.split()) for line in file.read_text().splitlines())
    text = re.sub(r"m([01])\( ?(\d+), ?(\d+)", r"m\1( \2, \3", text)
    assert old in text
    file.write_text(text.replace(old, new, 1))
    with pytest.raises(InputError, match=re.escape(str(file)) + words):
        read_standard_input(file)


@pytest.mark.parametrize(
    ("name", "entry", "words"),
    [
        ("Ke", (1, 2), r"Ke: is not symmetric: entry \(1, 2\) is 1e\+06 and \(2, 1\) is 0"),
        ("Ke", (2, 2, -1.0), "Ke: is indefinite or lets a mode move freely"),
        ("Me", (1, 1, -1.0), "Me: is indefinite; no motion may have negative energy"),
        ("De", (1, 1, -1.0), "De: is indefinite; damping takes energy away"),
        ("J", (1, 1, -9.0), "J, Cr, Ct, mdCM and Me are together indefinite"),
        ("Ct", (1, 1, 5.0), r"mdCM: does not go with Ct of line \d+ in mode 1"),
        ("Oe", (2, 3, 5.0), r"Oe: does not go with Gr of line \d+ in mode 2"),
        ("ksigma", (1, 1, 5.0), "ksigma: the body is prestressed, which is not read"),
    ],
)
def test_matrices_of_no_body_are_refused(file, name, entry, words):
    data = read_standard_input(file)
    i, j, value = entry if len(entry) == 3 else (*entry, 1e6)
    data.matrices[name].constant[i - 1, j - 1] = value
    with pytest.raises(InputError, match=rf"frame\.sid:\d+: {words}"):
        modes_from(data, {"tip": 4})


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"interface": {"tip": 3}}, "interface.tip: .* has no node 3; the nearest number is 4"),
        ({"nodes": {"side": 6}}, "nodes.side: .* has no node 6; the nearest number is 5"),
        ({"lines": ((1, 9),)}, "lines: .* has no node 9; the nearest number is 5"),
        ({"modes": 9}, "modes: the body has 8; give 1 to 8, or leave it out"),
        ({"highest_frequency": 1e-3}, "highest_frequency: is below the lowest of the body"),
        ({"reference": "tip"}, "reference: is for matrices; standard input data are reduced"),
        ({"interface": {"tip": (1, 4)}}, "interface.tip: give one node; standard input data"),
        ({"file": "none.sid"}, "file: none.sid: there is no such file"),
    ],
)
def test_fields_that_go_with_no_such_file(file, change, words):
    settings = {"file": str(file), "interface": {"tip": 4}}
    with pytest.raises(InputError, match=words):
        _ = FlexibleBody("frame", body="hub", **{**settings, **change}).component_modes


def test_fewer_modes(file):
    """The slowest modes by number or frequency are those of the whole body."""
    settings = {"file": str(file), "interface": {"tip": 4}}
    whole, few, slow = (
        FlexibleBody("f", body="hub", **settings, **more).component_modes
        for more in ({}, {"modes": 3}, {"highest_frequency": 3.0})
    )
    assert few.frequencies == pytest.approx(whole.frequencies[:3])
    assert few.integrals.products == pytest.approx(whole.integrals.products[:13, :13])
    assert len(slow.frequencies) == (whole.frequencies < 3.0 * 2.0 * np.pi).sum() > 0
