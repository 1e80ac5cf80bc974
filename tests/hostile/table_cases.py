"""Spoilt profiles, tracks, irregularity records, roads and motions as tables."""

import functools

import mutations
import yaml_cases
from harness import Case
from yaml_cases import ROOT, SHORT

LAYOUT = """\
kind: layout
gauge: 1435 mm
inclination: 1/40
rail: 60E1
cant_about: low_rail
segments:
  - {kind: straight, length: 60 m}
  - {kind: clothoid, length: 70 m}
  - {kind: arc, length: 120 m, radius: 300 m, cant: 100 mm, widening: 5 mm}
  - {kind: bloss, length: 70 m}
  - {kind: straight, length: 50 m}
gradients:
  - {at: 100 m, slope: 12 permil, radius: 3000 m}
irregularities: {kind: erri_b176, level: low, seed: 1, length: 250 m, fade: 30 m}
"""
HEAD = "gauge: 1435 mm\ninclination: 1/40\nrail: 60E1\n"
TRACKS = {
    "track.yaml": LAYOUT,
    "yard.csv": "kind, length [m], radius [m], cant [mm]\nstraight, 20\nramp, 5\n"
    "arc, 31.4, -25, -40\nramp, 5\nstraight, 20\n",
    "surveyed.csv": "s [m], curvature [1/km], cant [mm], gradient [permil], gauge [mm]\n"
    "0, 0.0, 0, 4.0, 1435\n10, 0.8, 20, 4.5, 1435\n20, 1.6, 40, 5.0, 1436\n"
    "30, 1.6, 40, 5.0, 1437\n40, 0.8, 20, 4.5, 1436\n50, 0.0, 0, 4.0, 1435\n",
    "rough.csv": "s [m], level [mm], cross_level [mm]\n0, 0.0, 0.0\n2, 1.5, -0.5\n"
    "4, 2.0, 0.5\n6, 0.5, 1.0\n8, -1.0, 0.0\n10, -0.5, -1.0\n12, 0.0, 0.0\n",
}
OF_TABLES = {
    "yard.csv": f"kind: layout_table\nfile: yard.csv\n{HEAD}",
    "surveyed.csv": f"kind: measured\nfile: surveyed.csv\n{HEAD}",
    "rough.csv": f"kind: straight\n{HEAD}irregularities: {{kind: record, file: rough.csv, "
    "fade: 2 m}\n",
}
MOTION = "time, crank.angle [deg]\n" + "".join(f"{k * 0.01:g}, {k * k * 0.5:g}\n" for k in range(9))
ROAD = "x [m], z [mm]\n" + "".join(f"{k * 0.5:g}, {(k % 5) * 3:g}\n" for k in range(40))
MINIPROF = 'FileName=x.whl\n"Date=01-01-2020"\nColumnDef=X,Y,A\nXYPOINTS=100\n\n'
SIMPACK = (
    "header.begin\n version = 1\n type = 1\nheader.end\nspline.begin\n"
    " units.len.f = 1000\n shift.y = 0\n point.begin\n"
)


@functools.cache
def profiles():
    """Return profile files by name: plain columns, CSV, Simpack and MiniProf."""
    found = {}
    for stem, (simpack, miniprof) in {
        "s1002": ("w.prw", "w.whl"),
        "60e1": ("r.prr", "r.ban"),
    }.items():
        text = (ROOT / "profiles" / f"{stem}.csv").read_text(encoding="utf-8")
        rows = [line for line in text.splitlines() if line[:1] in "-0123456789"][::8]
        pairs = [line.replace(",", " ").split()[:2] for line in rows]
        plain = "".join(f"{y} {z}\n" for y, z in pairs)
        found[f"{stem}.csv"] = "# unit: mm\n" + "".join(f"{y}, {z}\n" for y, z in pairs)
        found[f"{stem}.txt"] = plain
        found[simpack] = f"{SIMPACK}{plain} point.end\nspline.end\n"
        found[miniprof] = MINIPROF + "".join(f"{y} {z} 0\n" for y, z in pairs)
    return found


def _spoilt(content, rng):
    if rng.random() < 0.75:
        return mutations.spoil_lines(content, rng).encode("utf-8", "surrogatepass")
    return mutations.spoil_bytes(content.encode(), rng)


def profile(rng, name):
    files = profiles()
    file = rng.choice(list(files))
    is_wheel = file in ("s1002.csv", "s1002.txt", "w.prw", "w.whl")
    pair = [file, "60E1"] if is_wheel else ["S1002", file]
    extra = rng.choice([
        [], ["--smoothing", "2 mm"], ["--yaw", "5 mrad"], ["--shift", "-2:2:4"],
        ["--shift", mutations.text(rng)], ["--amplitude", mutations.text(rng)],
        ["--gauge", mutations.text(rng)], ["--radius", mutations.text(rng)],
        ["--inclination", mutations.text(rng)],
    ])  # fmt: skip
    content = files[file].encode() if extra and rng.random() < 0.3 else _spoilt(files[file], rng)
    extra = [word.replace("\0", "") for word in extra]
    command = ["profiles", *pair, "--shift", "0:1:1", "--amplitude", "0.5:1:1", *extra]
    return Case(name, {file: content}, command)


def track(rng, name):
    file = rng.choice(list(TRACKS))
    content = _spoilt(TRACKS[file], rng)
    if file == "track.yaml" and rng.random() < 0.6:
        data = mutations._copy(yaml_cases._data(LAYOUT))
        for _ in range(rng.choice([1, 2, 3])):
            mutations.spoil_data(data, [data], rng)
        content = mutations.dump(data).encode("utf-8", "surrogatepass")
    files = {
        file: content,
        **({"track.yaml": OF_TABLES[file].encode()} if file in OF_TABLES else {}),
    }
    extra = rng.choice([[], [], ["-o", "out.csv"], ["--every", mutations.text(rng)],
                        ["--speed", mutations.text(rng)]])  # fmt: skip
    extra = [word.replace("\0", "") for word in extra]
    return Case(name, files, ["track", "track.yaml", *extra], ("out.csv",))


def road(rng, name):
    texts = yaml_cases.scenario_texts()
    flat = "road:\n  kind: flat"
    scenario = texts["scenarios/iltis_ramp_steer.yaml"].replace(
        flat, "road:\n  kind: profile\n  file: road.csv"
    )
    content, run = _spoilt(ROAD, rng), ["run", "a.yaml", "-o", "out.h5", *SHORT]
    command = rng.choice([["validate", "a.yaml"], ["validate", "a.yaml"], run])
    files = {"a.yaml": yaml_cases.lighter(scenario.encode(), command), "road.csv": content}
    return Case(name, files, command, yaml_cases.OUTPUTS)


def motion(rng, name):
    files = yaml_cases.around({"motion.csv": _spoilt(MOTION, rng)})
    sets = ["--set", "duration=60 ms", "--set", "output.interval=5 ms"]
    command = ["inverse", "scenarios/systems/slider_crank.yaml", "--motion", "motion.csv", *sets,
               "-o", "out.h5", "--no-plots", "--backend", "interpreted", "-q"]  # fmt: skip
    return Case(name, files, command, yaml_cases.OUTPUTS)


def cases_table(rng, name):
    table = "parameters.length [m], parameters.mass [kg]\n1, 2\n1.5, 2.5\n# c\n2, 3\n"
    study = (
        yaml_cases.LISTED.partition("  rows:")[0] + "  file: cases.csv\noutput: {channels: []}\n"
    )
    files = yaml_cases.around({"study.yaml": study.encode(), "cases.csv": _spoilt(table, rng)})
    sweep = ["sweep", "study.yaml", "-o", "out.h5", "--workers", "1", "--backend", "interpreted"]
    command = rng.choice([["validate", "study.yaml"], [*sweep, "-q"]])
    return Case(name, files, command, yaml_cases.OUTPUTS)
