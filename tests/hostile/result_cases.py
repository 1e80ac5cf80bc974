"""Spoilt result files of every kind, and what shows or reads them."""

import fcntl
import functools
import io
import json
import os
import pickle
import tempfile
from pathlib import Path

import harness
import mechanism_cases
import mutations
import result_tables
import road_file_cases
import table_cases
import yaml_cases
from harness import Case

SETS = ["--set", "duration=40 ms", "--set", "output.interval=5 ms",
        "--set", "solver={kind: rk4, step: 1 ms}"]  # fmt: skip
QUIET = ["--backend", "interpreted", "--no-plots", "-q"]
PENDULUM = "scenarios/systems/double_pendulum.yaml"
HUNT = [*mechanism_cases.HUNT, "--backend", "interpreted", "-o", "hunt.h5"]
CHECKPOINT = "hunt.h5.checkpoint"
"""What a hunting study keeps until it is finished."""
SEEDS = {
    "run.h5": ["run", PENDULUM, "-o", "run.h5", *SETS, *QUIET],
    "car.h5": ["run", "scenarios/iltis_ramp_steer.yaml", "-o", "car.h5", *SETS, *QUIET,
               "--set", "output.channels=[chassis.*, wheel_fr.*, accelerometer.*]"],
    "rail.h5": ["run", "scenarios/systems/rail_wheelset.yaml", "-o", "rail.h5", *SETS[:4], *QUIET,
                "--set", "output.channels=[wheelset.*]"],
    "study.h5": ["sweep", "study.yaml", "-o", "study.h5", "--workers", "1", "-q",
                 "--backend", "interpreted"],
    "modes.h5": ["eig", PENDULUM, "-o", "modes.h5"],
    "response.h5": ["response", "scenarios/systems/quarter_car.yaml", "-u", "road.height", "-y",
                    "body.height", "-o", "response.h5", "--points", "20"],
    "kinematics.h5": ["kinematics", "systems/four_bar.yaml", "--drive",
                      "crank.angle=-60 deg:60 deg:6", "-o", "kinematics.h5", "--no-plots", "-q"],
    "inverse.h5": ["inverse", "scenarios/systems/slider_crank.yaml", "-o", "inverse.h5",
                   *SETS[:4], *QUIET],
    "contact.h5": ["profiles", "S1002", "60E1", "--shift", "-2:2:2", "--amplitude", "2:3:1", "-o",
                   "contact.h5"],
    "hunt.h5": HUNT,
}  # fmt: skip
TABLES = {
    "equilibrium.h5": ["equilibrium", PENDULUM, "-o", "equilibrium.h5"],
    "track.h5": ["track", "track.yaml", "-o", "track.h5"],
    "cam.h5": ["cam", "cam.yaml", "-o", "cam.h5"],
    "tyre.h5": ["tyre", "a.tir", "-o", "tyre.h5"],
    "manoeuvre.h5": ["optimise-manoeuvre", "optimise-manoeuvre.yaml", "-o", "manoeuvre.h5"],
}  # fmt: skip
WITHOUT_OPTIMUM = 3
"""Exit code of the few steps towards an optimal manoeuvre, whose last point is kept."""


@functools.cache
def seeds():
    """Return whole results of every kind by name, computed by the program itself, and a checkpoint.

    Processes of one check share them in the folder CHECKED_RESULTS: the first computes them.
    """
    shared = os.environ.get("CHECKED_RESULTS")
    if not shared:
        return _computed_seeds()
    place = Path(shared) / "seeds_of_damage.pickle"
    with open(place.with_suffix(".lock"), "w") as lock:  # noqa: PTH123
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not place.is_file():
            place.write_bytes(pickle.dumps(_computed_seeds()))
        return pickle.loads(place.read_bytes())


def _computed_seeds():
    from vehicledyn.results.hdf5.checkpoint import Checkpoint

    found, removed = {}, Checkpoint.remove
    with tempfile.TemporaryDirectory(prefix="hostile-seeds-") as name:
        folder = Path(name)
        harness.write(yaml_cases.around(_inputs()), folder)
        for file, command in (SEEDS | TABLES).items():
            Checkpoint.remove = Checkpoint.close if file == "hunt.h5" else removed
            outcome = harness._run_in(folder, Case(file, {}, command), limited=False)
            if outcome.code not in (0, WITHOUT_OPTIMUM if file == "manoeuvre.h5" else 0):
                raise RuntimeError(f"{command}: {outcome}")
            found[file] = (folder / file).read_bytes()
        found[CHECKPOINT] = (folder / CHECKPOINT).read_bytes()
        for file, write in result_tables.WRITERS.items():
            write(folder / file)
            found[file] = (folder / file).read_bytes()
    return found


def _inputs():
    """Return the files that results are computed from, by name."""
    studies = {f"{verb}.yaml": text for verb, text in mechanism_cases.STUDIES.items()}
    texts = studies | {
        "study.yaml": yaml_cases.STUDY,
        "measured.csv": mechanism_cases.MEASURED,
        "track.yaml": table_cases.LAYOUT,
        "cam.yaml": mechanism_cases.CAM,
        "self_excited.yaml": mechanism_cases.SELF_EXCITED,
        "a.tir": road_file_cases.tyres()[0],
    }
    return {name: text.encode() for name, text in texts.items()}


def result(rng, name):
    """Return a command on a spoilt result of a run, a sweep or a first analysis."""
    return _on_spoilt(list(SEEDS), rng, name)


def table(rng, name):
    """Return a command on a spoilt result that is a table of its own kind."""
    return _on_spoilt([*TABLES, *result_tables.WRITERS], rng, name)


def _on_spoilt(kinds, rng, name):
    files, file = seeds(), rng.choice(kinds)
    content = spoilt(files[file], rng)
    png = ["--format", "png"]
    commands = [["info", file], ["info", file, "--json"], ["plot", file, *png], ["report", file],
                ["compare", file, "whole.h5"], ["compare", "whole.h5", file], ["animate", file],
                ["assess", file], ["export-data", file, "-o", "out.csv"],
                ["report", "whole.h5", "--against", file]]  # fmt: skip
    if file == "study.h5":
        commands += [["sweep", "study.yaml", "-o", file, "--resume", "--workers", "1", "-q",
                      "--backend", "interpreted"]] * 3  # fmt: skip
    command = rng.choice(commands)
    given = {file: content, "whole.h5": files[file]}
    if command[0] == "sweep":
        given = yaml_cases.around(given | {"study.yaml": yaml_cases.STUDY.encode()})
    stem = file.removesuffix(".h5")
    outputs = (f"{stem}_plots", f"{stem}_report.html", f"{stem}_animation.html",
               "whole_report.html", "out.csv")  # fmt: skip
    return Case(name, given, command, outputs)


def spoilt(content, rng):
    """Return a result file with objects changed, or with bytes changed or cut off."""
    return (_spoilt_objects if rng.random() < 0.7 else _cut)(content, rng)


def _unsealed(content):
    """Return a file without its checksums, as older files are."""
    from vehicledyn.results.hdf5.seal import MAGIC

    at = content.rfind(MAGIC)
    return content if at < 0 else content[: int.from_bytes(content[at + 16 : at + 24], "little")]


def _cut(content, rng):
    content = content if rng.random() < 0.3 else _unsealed(content)
    if rng.random() < 0.5:
        return content[: rng.randrange(len(content))]
    found = bytearray(content)
    for _ in range(rng.choice([1, 3, 20])):
        found[rng.randrange(len(found))] = rng.randrange(256)
    return bytes(found)


def _spoilt_objects(content, rng):
    import h5py

    box = io.BytesIO(_unsealed(content))
    with h5py.File(box, "r+") as file:
        if rng.random() < 0.7:
            file.pop("checksums", None)  # as in older files
        for _ in range(rng.choice([1, 1, 2, 4])):
            try:
                _spoil(file, rng)
            except (ValueError, TypeError, LookupError, RuntimeError, OSError, OverflowError):
                continue
    return box.getvalue()


_LARGEST = 10**7
"""Numbers of a data set that is still changed; an earlier change may have made one of 10^12."""


def _spoil(file, rng):
    import h5py

    names = []
    file.visit(names.append)
    place = file[rng.choice(names)] if rng.random() < 0.85 else file
    if rng.random() < 0.35 and place.attrs:
        key = rng.choice(list(place.attrs))
        way = rng.randrange(4)
        if way == 0:
            del place.attrs[key]
        elif way == 1:
            place.attrs[key] = _array(rng)
        else:
            place.attrs[key] = _like(place.attrs[key], rng)
        return
    if place == file or place.name == "/":
        file.create_dataset("another", data=_array(rng))
        return
    parent, name = place.parent, place.name.rpartition("/")[2]
    way = rng.randrange(9)
    if isinstance(place, h5py.Dataset) and way < 4 and 0 < place.size < _LARGEST:
        old = place[()]
        if way == 0:
            place[...] = _like(old, rng)
            return
        attributes = dict(place.attrs)
        del parent[name]
        new = parent.create_dataset(name, data=_reshaped(old, rng))
        for key, item in attributes.items():
            if key not in ("DIMENSION_LIST", "REFERENCE_LIST"):
                new.attrs[key] = item
        return
    del parent[name]
    if way == 4:
        parent[name] = h5py.SoftLink(rng.choice([f"/{name}", "/nowhere", "/", "/time"]))
    elif way == 5:
        parent[name] = h5py.ExternalLink(rng.choice(["/dev/zero", "whole.h5", "none"]), "/time")
    elif way == 6:
        parent[name] = file["/"]
    elif way == 7:
        parent.create_dataset(name, (10**12,), "f8", chunks=(1000,), fillvalue=0.0)
    elif way == 8 and rng.random() < 0.7:
        parent.create_dataset(name, data=_array(rng))


def _like(old, rng):
    import numpy as np

    array = np.asarray(old)
    if array.dtype.kind in "fiu":
        new = array.astype(float) if array.dtype.kind == "f" else array.copy()
        hostile = [0, -1, 1e308, -1e308, np.nan, np.inf, 1e-300, 2**31 - 1, 1e9, 7]
        item = rng.choice(hostile)
        if array.dtype.kind != "f":
            item = int(item) if np.isfinite(item) and abs(item) < 2**31 else 0
        if array.ndim == 0 or rng.random() < 0.5:
            return np.full_like(new, item)
        flat = new.reshape(-1)
        flat[rng.randrange(flat.size)] = item
        return new
    texts = ["", "\x01", "a/b", "../x", "é" * 100, "x" * 3000, "nan", "1", "{}", "[]", "null",
             "{\"a\": [1, {}]}", "kg", "<script>alert(1)</script>", "$x^2_{$", "%s",
             "running"]  # fmt: skip
    if array.ndim == 0:
        text = str(old)
        if text[:1] in ("{", "[") and rng.random() < 0.7:
            return _spoilt_json(text, rng)
        return rng.choice([*texts, text[: len(text) // 2], text.replace("1", "1e308"), text * 2])
    new = array.astype(object)
    flat = new.reshape(-1)
    flat[rng.randrange(flat.size)] = rng.choice(texts)
    if rng.random() < 0.3:
        flat[:] = flat[0]
    return new


def _spoilt_json(text, rng):
    """Return a description in JSON, of plots or shapes say, with values and keys changed."""
    try:
        data = json.loads(text)
    except ValueError:
        return text[::-1]
    for _ in range(rng.choice([1, 1, 2, 3])):
        mutations.spoil_data(data, [data], rng)
    return json.dumps(data).encode("utf-8", "replace").decode()


def _reshaped(old, rng):
    import numpy as np

    array = np.asarray(old)
    way = rng.randrange(6)
    if way == 0:
        return array.reshape(-1)[: array.size // 2]
    if way == 1:
        return array[np.newaxis]
    if way == 2:
        return array.reshape(-1)[0]
    if way == 3:
        return np.concatenate([array, array], axis=-1) if array.ndim else array
    if way == 4:
        return array[..., :0] if array.ndim else array
    return _array(rng)


def _array(rng):
    import numpy as np

    return rng.choice([
        np.zeros(0), np.zeros((0, 3)), np.array(5), np.array(5.5), np.array("text", dtype="S4"),
        np.array([b"a", b"b"]), np.arange(7), np.full((2, 2), np.nan), np.zeros((2, 3, 4, 5)),
        np.array([(1, 2.0)], dtype=[("a", "i4"), ("b", "f8")]), np.array([1 + 2j]),
        np.array([True, False]), np.full(9, np.inf), np.array([b"\xff\xfe"]),
    ])  # fmt: skip
