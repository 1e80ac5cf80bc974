"""Finite-element matrices from files: the same from each format, and every mistake by name."""

import dataclasses

import numpy as np
import pytest
import scipy.io
import scipy.sparse
from finite_elements import assembled, straight

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.bodies.finite_elements.reading import (
    read_archive,
    read_matrices,
    read_matrix,
    write_archive,
)

GIVEN = {"axial": 5e5, "torsion": 20.0, "bending": (50.0, 80.0), "mass": 2.0, "polar": 0.01}


@pytest.fixture(scope="module")
def beam():
    return dataclasses.replace(straight(1.5, 3, GIVEN), damping=0.1 * straight(1.5, 3, GIVEN).mass)


def same(a, b):
    assert (a.numbers == b.numbers).all()
    assert (a.rows == b.rows).all()
    assert (a.places == b.places).all()
    for name in ("mass", "stiffness", "damping"):
        assert abs(getattr(a, name) - getattr(b, name)).max() <= 1e-15 * abs(getattr(a, name)).max()


def test_archives(tmp_path, beam):
    """Compressed rows and whole arrays are read alike; nodes and rows have usual numbers."""
    write_archive(beam, tmp_path / "sparse.npz")
    whole = {name: getattr(beam, name).toarray() for name in ("mass", "stiffness", "damping")}
    np.savez(tmp_path / "whole.npz", nodes=beam.places, **whole)
    same(beam, read_archive(tmp_path / "sparse.npz"))
    same(beam, read_archive(tmp_path / "whole.npz"))


@pytest.mark.parametrize("suffix", ["mtx", "npy", "npz"])
def test_a_file_each(tmp_path, beam, suffix):
    files = {n: tmp_path / f"{n}.{suffix}" for n in ("mass", "stiffness", "damping")}
    for name, path in files.items():
        matrix = getattr(beam, name)
        if suffix == "mtx":
            scipy.io.mmwrite(path, matrix, symmetry="symmetric", precision=17)
        elif suffix == "npy":
            np.save(path, matrix.toarray())
        else:
            scipy.sparse.save_npz(path, matrix.tocsc())
    rows = [f"{n}, {x!r}, {y!r}, {z!r}" for n, (x, y, z) in zip(
        beam.numbers, beam.places.tolist(), strict=True)]  # fmt: skip
    files["nodes"] = tmp_path / "nodes.csv"
    files["nodes"].write_text("number, x, y, z\n" + "\n".join(rows) + "  # the end\n")
    same(beam, read_matrices(files))
    files["dofs"] = tmp_path / "dofs.txt"
    files["dofs"].write_text("\n".join(f"{n} {d}" for n, d in beam.rows))
    same(beam, read_matrices(files))


def changed(beam, **arrays):
    whole = {name: getattr(beam, name).toarray() for name in ("mass", "stiffness")}
    return {"nodes": beam.places, "numbers": beam.numbers, "dofs": beam.rows, **whole, **arrays}


def entry(matrix, value, *places):
    found = matrix.toarray().copy()
    for place in places:
        found[place] = value
    return found


WRONG = {
    "lost node": (
        lambda b: {"numbers": b.numbers + 1},
        "nodes: missing: the matrices have directions of node 1, which has no coordinates; add it",
    ),
    "skew": (
        lambda b: {"stiffness": entry(b.stiffness, 7e5, (0, 6))},
        r"stiffness: is not symmetric: entry \(1, 7\) is 700000 and \(7, 1\) is -1e\+06; give the "
        "whole matrix",
    ),
    "indefinite": (
        lambda b: {"mass": entry(b.mass, 9.0, (1, 5), (5, 1))},
        "mass: is indefinite, found at node 1, y; no motion may have negative energy",
    ),
    "negative": (
        lambda b: {"mass": entry(b.mass, -1.0, (3, 3))},
        "mass: is indefinite, found at node 1, rx",
    ),
    "held": (
        lambda b: {"stiffness": entry(b.stiffness, 5e8, (1, 1))},
        r"stiffness: resists rigid motion \(y\); take supports and springs to the ground out",
    ),
    "small": (
        lambda b: {"mass": np.eye(6)},
        r"mass: has the shape \(6, 6\), the nodes have 24 directions",
    ),
    "twice": (
        lambda b: {"dofs": np.vstack([b.rows[:-1], b.rows[:1]])},
        "dofs: direction 1 of node 1 appears twice",
    ),
    "direction": (
        lambda b: {"dofs": b.rows + np.array([0, 1])},
        r"dofs: direction 7 of node 1; directions run from 1 \(x\) to 6",
    ),
    "not a number": (
        lambda b: {"mass": entry(b.mass, np.nan, (3, 3))},
        "mass: has an entry that is no finite number",
    ),
    "massless": (lambda b: {"mass": 0.0 * b.mass.toarray()}, "mass: is zero; give the matrix"),
    "heavier along y": (
        lambda b: {"mass": b.mass.toarray() + np.diag([0.0, 1.0, 0.0, 0.0, 0.0, 0.0] * 4)},
        "mass: is 3, 7, 3 kg along x, y and z, which must be one number above zero",
    ),
    "half": (
        lambda b: {"dofs": b.rows[:, :1]},
        r"dofs: has the shape \(24, 1\); give rows of 2 numbers",
    ),
    "half a node": (
        lambda b: {"numbers": b.numbers + 0.5},
        "numbers: 1.5 is no whole number",
    ),
    "no direction": (
        lambda b: {"dofs": np.where(b.rows == 6, np.nan, b.rows)},
        "dofs: nan is no whole number",
    ),
    "other": (lambda b: {"masses": b.rows}, "has an array 'masses' that says nothing"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_archives(tmp_path, beam, name):
    change, words = WRONG[name]
    file = tmp_path / "wrong.npz"
    np.savez(file, **changed(beam, **change(beam)))
    with pytest.raises(InputError, match=words) as caught:
        read_archive(file)
    assert str(caught.value).startswith(f"{file}: ")


def test_archives_that_are_none(tmp_path, beam):
    file = tmp_path / "none.npz"
    with pytest.raises(InputError, match=r"none.npz: there is no such file"):
        read_archive(file)
    file.write_bytes(b"PK\x03\x04 no archive")
    with pytest.raises(InputError, match="is no archive of NumPy"):
        read_archive(file)
    np.savez(file, nodes=beam.places, mass=beam.mass.toarray())
    with pytest.raises(InputError, match="lacks the array 'stiffness'; an archive holds"):
        read_archive(file)
    np.savez(file, nodes=np.array([{}], dtype=object))
    with pytest.raises(InputError, match="is no archive of NumPy"):
        read_archive(file)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1 0 0 0\n2 1 0 O\n", r"table.csv:2: '2 1 0 O' is no row of numbers"),
        ("1 0 0 0\n\n2 1 0\n", r"table.csv:3: has 3 numbers; give 4: number, x, y, z of a node"),
        ("# nothing\n", r"table.csv: has no rows"),
    ],
)
def test_wrong_tables(tmp_path, beam, text, words):
    files = {n: tmp_path / f"{n}.mtx" for n in ("mass", "stiffness")}
    for name, path in files.items():
        scipy.io.mmwrite(path, getattr(beam, name))
    files["nodes"] = tmp_path / "table.csv"
    files["nodes"].write_text(text)
    with pytest.raises(InputError, match=words):
        read_matrices(files)


def test_a_lost_node_has_a_line(tmp_path, beam):
    """A direction of a node without coordinates is named with the line of the table."""
    files = {n: tmp_path / f"{n}.mtx" for n in ("mass", "stiffness", "damping")}
    for name, path in files.items():
        scipy.io.mmwrite(path, getattr(beam, name))
    files |= {"nodes": tmp_path / "nodes.txt", "dofs": tmp_path / "dofs.txt"}
    files["nodes"].write_text("1 0 0 0\n2 0.5 0 0\n3 1 0 0\n")
    files["dofs"].write_text("\n".join(f"{n} {d}" for n, d in beam.rows))
    with pytest.raises(InputError, match=r"dofs.txt:19: nodes: missing: .* of node 4"):
        read_matrices(files)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("%%MatrixMarket matrix coordinate real general\n2 2 1\n1 x 3.0\n", r"m.mtx:3: "),
        ("no matrix", r"m.mtx.*; a Matrix Market file is needed"),
        ("%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1 2\n", "is complex"),
    ],
)
def test_wrong_matrix_market(tmp_path, text, words):
    file = tmp_path / "m.mtx"
    file.write_text(text)
    with pytest.raises(InputError, match=words):
        read_matrix(file)
    with pytest.raises(InputError, match=r"m.dat: is no matrix"):
        read_matrix(tmp_path / "m.dat")


def test_parts_that_nothing_joins():
    """Two pieces without a member between them resist no motion against each other."""
    from vehicledyn.multibody.bodies.finite_elements.reduction import component_modes

    places = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)]
    made = assembled(places, [(0, 1), (2, 3)], GIVEN)
    with pytest.raises(InputError, match=r"does not hold the body of frame, found at node [34]"):
        component_modes(made, {"start": 1}, 1)


def test_damaged_archives(tmp_path):
    """Whatever bytes of an archive are changed, it is read or refused in words."""
    import contextlib

    from element_examples import FRAME

    source, rng, file = FRAME.read_bytes(), np.random.default_rng(7), tmp_path / "damaged.npz"
    refused = 0
    for _ in range(60):
        damaged = bytearray(source)
        for place in rng.integers(len(source), size=3):
            damaged[place] = rng.integers(256)
        file.write_bytes(bytes(damaged))
        with contextlib.suppress(InputError):
            read_archive(file)
            continue
        refused += 1
    assert refused > 30
