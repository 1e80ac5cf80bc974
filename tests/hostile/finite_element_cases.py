"""Spoilt data of a flexible body: archives, Matrix Market files, tables, standard input data."""

import functools
import io

import mutations
import numpy as np
import yaml_cases
from harness import Case
from mechanism_cases import RUN

SYSTEM = """\
title: A blade on a hinge
bodies:
  hub: {joints: [R2 angle]}
elements:
  blade:
    kind: flexible_body
    body: hub
    SOURCE
    interface: {root: 1, tip: 3}
    reference: root
    modes: 2
    nodes: {middle: 2}
    lines: [[1, 2, 3]]
forces:
  spring: {coordinate: hub.angle, force: -50 N*m/rad * position - 1 N*m*s/rad * rate}
"""
ARCHIVE = "file: blade.npz"
FILES = "matrices: {nodes: nodes.csv, dofs: dofs.csv, mass: mass.mtx, stiffness: stiffness.mtx}"
STANDARD = SYSTEM.replace("SOURCE", "file: blade.sid").replace("    reference: root\n", "")
SCENARIO = b"title: It swings\nmodel: blade.yaml\nduration: 20 ms\n"
NUMBERS = [0.0, -1.0, 1e-300, 1e308, np.nan, np.inf, 1e12, 7.0]


@functools.cache
def arrays():
    """Return the arrays of a clamped blade of two elements, matrices as whole ones."""
    from vehicledyn.multibody.bodies.finite_elements.beam_frames import (
        BeamElement,
        Member,
        beam_frame,
    )

    bar = BeamElement(axial=160e6, torsion=95.0, bending=(120.0, 240.0), mass=5.9, polar=0.009)
    places = [(0, 0, 0), (0.5, 0, 0), (1, 0, 0)]
    model = beam_frame("blade", places, [Member(1, 2, bar), Member(2, 3, bar)])
    return {
        "nodes": model.places,
        "numbers": model.numbers,
        "dofs": model.rows,
        "mass": model.mass.toarray(),
        "stiffness": model.stiffness.toarray(),
    }


@functools.cache
def standard_input():
    """Return the text of standard input data of the blade."""
    import pathlib
    import tempfile

    from vehicledyn.multibody.bodies.finite_elements.reading import read_archive
    from vehicledyn.multibody.bodies.finite_elements.reduced_modes import reduced_modes
    from vehicledyn.multibody.bodies.finite_elements.reduction import component_modes
    from vehicledyn.multibody.bodies.finite_elements.standard_input_writer import (
        write_standard_input,
    )

    with tempfile.TemporaryDirectory() as folder:
        archive, file = pathlib.Path(folder, "blade.npz"), pathlib.Path(folder, "blade.sid")
        archive.write_bytes(_archive(arrays())["blade.npz"])
        ends, middle = {"root": 1, "tip": 3}, {"middle": 2}
        made = component_modes(read_archive(archive), ends, 2, reference="root", kept=middle)
        write_standard_input(reduced_modes(made), file, ends | middle)
        return file.read_text()


def _standard_case(rng, name):
    files = {"blade.sid": mutations.spoil_lines(standard_input(), rng).encode("utf-8", "replace")}
    files |= {"blade.yaml": STANDARD.encode(), "a.yaml": SCENARIO}
    command = rng.choice([["validate", "blade.yaml"], ["eig", "blade.yaml"], RUN])
    words = [word.format("a.yaml") if "{}" in word else word for word in command]
    return Case(name, files, words, yaml_cases.OUTPUTS)


def finite_elements(rng, name):
    """Return a command on a system whose flexible body has spoilt matrices or a spoilt entry."""
    if rng.random() < 0.3:
        return _standard_case(rng, name)
    is_archive = rng.random() < 0.5
    text = SYSTEM.replace("SOURCE", ARCHIVE if is_archive else FILES)
    given = dict(arrays())
    in_system = rng.random() < 0.3
    if not in_system and (is_archive or rng.random() < 0.4):
        for _ in range(rng.choice([1, 1, 2])):
            _spoil_array(given, rng)
    files = _archive(given) if is_archive else _texts(given)
    if not in_system:
        file = rng.choice(list(files))
        if is_archive and rng.random() < 0.3:
            files[file] = mutations.spoil_bytes(files[file], rng)
        elif not is_archive and given.keys() == arrays().keys():
            content = mutations.spoil_lines(files[file].decode(), rng)
            files[file] = content.encode("utf-8", "surrogatepass")
    system = yaml_cases._spoilt({"a": text}, "a", rng) if in_system else text.encode()
    files |= {"blade.yaml": system, "a.yaml": SCENARIO}
    command = rng.choice([["validate", "blade.yaml"], ["eig", "blade.yaml"], RUN])
    words = [word.format("a.yaml") if "{}" in word else word for word in command]
    return Case(name, files, words, yaml_cases.OUTPUTS)


def _spoil_array(given, rng):
    key = rng.choice(list(given))
    values = np.array(given[key])
    way = rng.randrange(6)
    if way == 0:
        del given[key]
    elif way == 1:
        given[key] = values[: len(values) // 2]
    elif way == 2:
        given[key] = values.reshape(-1)
    elif way == 3:
        given[key] = values.astype(rng.choice(["c16", "S8", "f4", "i1", "?"]))
    else:
        number = rng.choice(NUMBERS)
        kept = values.astype(float) if values.dtype.kind == "f" else values
        if kept.dtype.kind != "f":
            number = int(number) if np.isfinite(number) and abs(number) < 2**31 else 0
        for _ in range(rng.choice([1, 1, 3, 50])):
            kept.reshape(-1)[rng.randrange(kept.size)] = number
        given[key] = kept


def _archive(given):
    box = io.BytesIO()
    np.savez(box, **given)
    return {"blade.npz": box.getvalue()}


def _texts(given):
    files = {}
    for key in ("mass", "stiffness"):
        if key in given:
            files[f"{key}.mtx"] = _matrix_market(np.atleast_2d(given[key]))
    places, numbers = given.get("nodes", np.zeros((0, 3))), given.get("numbers", np.zeros(0))
    rows = [f"{a}, {', '.join(map(str, np.ravel(b)))}" for a, b in zip(numbers, places)]  # noqa: B905
    files["nodes.csv"] = "\n".join(["node, x, y, z", *rows, ""]).encode()
    lines = [", ".join(map(str, np.ravel(row))) for row in given.get("dofs", [])]
    files["dofs.csv"] = "\n".join(["node, direction", *lines, ""]).encode()
    return files


def _matrix_market(values):
    head = [
        "%%MatrixMarket matrix coordinate real general",
        f"{values.shape[0]} {values.shape[-1]} {np.count_nonzero(values)}",
    ]
    places = np.argwhere(values)
    entries = [f"{i + 1} {j + 1} {values[i, j]}" for i, j in places[:, :2]]
    return "\n".join([*head, *entries, ""]).encode()
