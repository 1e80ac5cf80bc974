"""Spoilt cams, grounds, drivers, beams, and studies that optimise, identify and propagate."""

import functools
import re

import mutations
import yaml_cases
from harness import Case
from yaml_cases import RUN, SHORT

CAM = """\
title: Intake cam
motion:
  - {kind: polynomial_4567, over: 65 deg, lift: 9 mm}
  - {kind: dwell, over: 5 deg}
  - {kind: polynomial_4567, over: 65 deg, lift: -9 mm}
  - {kind: dwell, over: 225 deg}
base_radius: 30 mm
follower: {kind: roller, radius: 9 mm, offset: 2 mm}
load: {speed: 1500 rpm, mass: 0.2 kg, stiffness: 40 N/mm, preload: 250 N}
"""
OUTLINE = """\
title: Measured cam
outline: {kind: points, file: measured.csv, tolerance: 1 um}
follower: {kind: flat}
"""
ECCENTRIC = """\
title: Eccentric
outline: {kind: eccentric_circle, radius: 40 mm, eccentricity: 10 mm}
follower: {kind: roller, radius: 9 mm}
load: {speed: 600 rpm, mass: 1 kg}
"""
PAIR = """\
title: A conjugate pair
motion:
  - {kind: cycloidal, over: 120 deg, lift: 20 mm}
  - {kind: dwell, over: 60 deg}
  - {kind: modified_sine, over: 180 deg, lift: -20 mm}
base_radius: 40 mm
follower: {kind: roller, radius: 12 mm, offset: 2 mm}
conjugate: {follower: {kind: roller, radius: 14 mm}, distance: 130 mm}
load: {speed: 600 rpm, mass: 2 kg}
"""
GRID = "ncols 5\nnrows 4\nxllcorner -1\nyllcorner -2\ncellsize 20\nnodata_value -9999\n" + (
    "0 0.01 0 0.02 0\n0 0 0.01 0 0\n0.01 0 0 0 0\n0 0 0 0.01 0\n"
)
MESH = (
    "# a plate\no plate\nv -50 -20 0\nv 50 -20 0.1\nv 50 20 0.2\nv -50 20 0\nvn 0 0 1\n"
    "f 1 2 3\nf 1//1 3//1 4//1\n"
)
SOIL = (
    "{kind: bekker, wheel_width: 0.2 m, cohesion: 1 kPa, friction_angle: 28 deg, "
    "shear_modulus: 25 mm, exponent: 1.1, cohesive_modulus: 990 N/m, frictional_modulus: 1.5 MPa}"
)
PATCHES = (
    "[{kind: rectangle, friction: 0.3, start: 1 m, end: 9 m}, "
    "{kind: chequers, friction: 0.5, side: 2 m}]"
)
DRIVERS = [
    "{kind: preview, preview_time: 0.5 s, HANDS}",
    "{kind: macadam, preview_time: 1 s, points: 5, speed: 10 m/s, mass: 1600 kg, "
    "yaw_inertia: 1800 kg*m^2, front_distance: 1 m, rear_distance: 1 m, HANDS, "
    "front_stiffness: 60 kN/rad, rear_stiffness: 60 kN/rad, rack_speed: 0.5 m/s}",
    "{kind: pure_pursuit, distance: 5 m, HANDS, rack_acceleration: 20 m/s^2}",
    "{kind: stanley, gain: 3 Hz, HANDS}",
]
HANDS = "lag_frequency: 20 rad/s, lag_damping: 0.8, rack_stop: 60 mm"
MANOEUVRES = [
    "{kind: slalom, cones: 1, spacing: 18 m, first_cone: 4 m, cone_radius: 0.1 m, "
    "path_offset: 1 m, driver: DRIVER}",
    "{kind: double_lane_change, begin: -14 m, driver: DRIVER}",
    "{kind: obstacle_avoidance, begin: -11 m, release_at: 0, driver: DRIVER}",
    "{kind: braking_in_turn, angle: 3 deg, begin: 0, brake_at: 0.1 s, torque: 900 N*m}",
    "{kind: swept_sine, amplitude: 1 deg, sweep_time: 0.2 s, first: 5 Hz, last: 15 Hz, begin: 0}",
    "{kind: weave, amplitude: 1 deg, frequency: 10 Hz, begin: 0}",
]
BEAM = """\
title: A beam that a weight bends
parameters: {edge: 8 mm}
bodies:
  arm: {joints: [R2 angle]}
elements:
  rod:
    kind: beam
    body: arm
    length: 300 mm
    section: SECTION
    material: {density: 7870 kg/m^3, young: 200 GPa}
    modes: {z: 1}
    frames: [0.5]
forces:
  spring: {coordinate: arm.angle, force: -500 N*m/rad * position - 1 N*m*s/rad * rate}
"""
SECTIONS = ["{shape: rectangle, width: edge, height: edge}", "{shape: circle, radius: edge}",
            "{shape: tube, radius: edge, thickness: 1 mm}"]  # fmt: skip
KINDS_OF_BEAM = [
    "",
    "    model: exact\n    curvature: [0, -1 / (0.3 m), 0.2 1/m]\n    stresses: true\n",
    "    model: segments\n    segments: 4\n    curvature: [1 1/m, 0, 0]\n",
    "    model: segments\n    segments: 5\n",
    "    basis: attached\n"
    "    foundation: {at: [0, 0, 0], stiffness: [0, 0, 1 MN/m^2], begin: 0.2, end: 0.9}\n",
]
STUCK = """\
title: A box on a slope
bodies:
  box: {joints: [T1 x, T3 z], mass: 2 kg}
elements:
  slope: {kind: KIND, body_a: ground, body_b: box, plane: {normal: [0.6, 0, 0.8]}, MORE
    ball: {radius: 0.1 m}, friction: 0.8, stick_stiffness: 1e4 N/m, stick_damping: 200 N*s/m}
initial: {box.x: 0.06 m, box.z: 0.08 m}
"""
CONTACTS = {"body_impact": "restitution: 0.3,", "body_contact": "stiffness: 1e6, exponent: 1,"}
SELF_EXCITED = (yaml_cases.ROOT / "tests" / "unit" / "cli" / "self_excited.yaml").read_text()
HUNT = ["hunt", "self_excited.yaml", "--parameter", "gain", "--from", "-1 N*s/m", "--to",
        "2 N*s/m", "--points", "4", "--amplitude", "3e-3", "--no-simulation", "--no-plots",
        "-q"]  # fmt: skip
"""Limit cycles in half a second, interpreted."""
SCENARIO = b"title: It swings\nmodel: beam.yaml\nduration: 20 ms\n"
PENDULUM = "scenarios/systems/double_pendulum.yaml"
SETS = "{solver: {kind: rk4, step: 1 ms}, duration: 20 ms, output: {interval: 2 ms}}"
STUDIES = {
    "optimise": f"""\
title: Lengths
scenarios: {PENDULUM}
set: {SETS}
variables:
  length: {{from: 0.5 m, to: 2 m}}
minimise: max(upper.angle)
constraints:
  max(lower.angle): {{at_most: 100 rad}}
most_runs: 4
""",
    "optimise-manoeuvre": f"""\
title: Swing
scenario: {PENDULUM}
controls:
  motor: {{input: force:upper.angle, from: -5 N*m, to: 5 N*m, rate: 60 N*m/s}}
minimise: {{time: 1, effort: 0.1, final(upper.angle): 1}}
duration: {{from: 0.1 s, to: 1 s, guess: 0.2 s}}
start: {{upper.angle: {{from: 0.4 rad, to: 30 deg}}}}
end: {{upper.angle: 0.6 rad}}
limits: {{upper.angle_rate: {{to: 40 rad/s}}}}
intervals: 4
refinements: 0
most_iterations: 4
""",
    "identify": f"""\
title: Length of a pendulum
experiments:
  swing:
    scenario: {PENDULUM}
    set: {SETS}
    data: measured.csv
    signals:
      upper.angle: {{noise: 1 mrad}}
parameters:
  length: {{from: 0.5 m, to: 2 m, prior: 1 m, deviation: 0.1 m}}
""",
    "uncertainty": f"""\
title: Scatter of a pendulum
scenario: {PENDULUM}
set: {SETS}
of: [max(upper.angle)]
parameters:
  length: {{kind: normal, mean: 1 m, deviation: 10 mm}}
method: sequence
number: 4
limits:
  max(upper.angle): {{at_most: 3 rad}}
""",
}
ROBUST = """\
least_squares: {max(upper.angle): {target: 1 rad, size: 10 mrad}}
optimiser: ipopt
explore: 8
scatter: {length: {kind: normal, mean: 1 m, deviation: 10 mm}}
deviations: 2
choices: {parameters.mass: [1 kg, 2 kg]}
"""
VARIANTS = [
    *STUDIES.items(),
    ("optimise", STUDIES["optimise"].replace("minimise: max(upper.angle)\n", ROBUST)),
    ("uncertainty", STUDIES["uncertainty"].replace("sequence", "reliability")),
    ("uncertainty", STUDIES["uncertainty"].replace("sequence", "polynomial_chaos")),
]
MEASURED = "time [s],upper.angle [rad]\n" + "".join(f"{k / 500}, 0.1\n" for k in range(11))
POINTS = "angle [deg], radius [mm]\n" + "".join(f"{k}, {30 + k % 4}\n" for k in range(0, 360, 15))


def _yaml(content, rng):
    """Return a YAML text with values, keys, lines or bytes changed."""
    return yaml_cases._spoilt({"a": content}, "a", rng)


def _lines(content, rng):
    if rng.random() < 0.75:
        return mutations.spoil_lines(content, rng).encode("utf-8", "surrogatepass")
    return mutations.spoil_bytes(content.encode(), rng)


def cam(rng, name):
    """Return a spoilt cam, or spoilt points of one."""
    text = rng.choice([CAM, OUTLINE, ECCENTRIC, PAIR])
    is_table = text == OUTLINE and rng.random() < 0.6
    files = {
        "cam.yaml": text.encode() if is_table else _yaml(text, rng),
        "measured.csv": _lines(POINTS, rng) if is_table else POINTS.encode(),
    }
    extra = rng.choice([[], [], ["-o", "out.csv"], ["-o", "out.h5"],
                        ["--profile", "out.dxf", "--tolerance", "10 um"],
                        ["--tolerance", mutations.text(rng).replace("\0", "")]])  # fmt: skip
    return Case(name, files, ["cam", "cam.yaml", *extra], ("out.csv", "out.h5", "out.dxf"))


@functools.cache
def _iltis():
    return yaml_cases.scenario_texts()["scenarios/iltis_ramp_steer.yaml"]


def ground(rng, name):
    """Return a spoilt grid of heights, mesh, soil or patch under a car."""
    kind, file, content = rng.choice([("heightfield", "g.asc", GRID), ("mesh", "g.obj", MESH)])
    more = rng.choice(["", f", soil: {SOIL}", f", patches: {PATCHES}"])
    cell = ", cell: 10 m" if kind == "mesh" else ""
    road = f"road: {{kind: {kind}, file: {file}{cell}{more}}}"
    text = _iltis().replace("road:\n  kind: flat", road)
    is_file = not more or rng.random() < 0.5
    scenario = text.encode() if is_file else _yaml(text, rng)
    content = _lines(content, rng) if is_file else content.encode()
    command = _mostly_validate("a.yaml", rng)
    files = {"a.yaml": yaml_cases.lighter(scenario, command), file: content}
    return Case(name, files, command, yaml_cases.OUTPUTS)


def driven(rng, name):
    """Return a car with a spoilt manoeuvre or driver."""
    driver = rng.choice(DRIVERS).replace("HANDS", HANDS)
    manoeuvre = rng.choice(MANOEUVRES).replace("DRIVER", driver)
    head, _, rest = _iltis().partition("manoeuvre:")
    rest = rest[rest.index("duration:") :]
    text = f"{head}manoeuvre: {manoeuvre}\n{rest}"
    spoilt, command = _yaml(text, rng), _mostly_validate("a.yaml", rng)
    return Case(name, {"a.yaml": yaml_cases.lighter(spoilt, command)}, command, yaml_cases.OUTPUTS)


def beam(rng, name):
    """Return a system with a spoilt beam."""
    text = BEAM.replace("SECTION", rng.choice(SECTIONS))
    more = rng.choice(KINDS_OF_BEAM)
    text = text.replace("    frames:", f"{more}    frames:")
    if "attached" in more:
        text = text.replace("{z: 1}", "{z: 3, twist: 2}")
    if rng.random() < 0.25:
        kind, more = rng.choice(list(CONTACTS.items()))
        text = STUCK.replace("KIND", kind).replace("MORE", more)
    files = {"beam.yaml": _yaml(text, rng), "a.yaml": SCENARIO}
    command = rng.choice([["validate", "beam.yaml"], ["eig", "beam.yaml"], RUN])
    words = [word.format("a.yaml") if "{}" in word else word for word in command]
    return Case(name, files, words, yaml_cases.OUTPUTS)


_LONG_RUNS = re.compile(rb'duration"?: *"?[0-9.e+]{5}|step"?: *"?[0-9.]+e-[0-9]+ ms')
"""Sound runs, each of which takes more than ten seconds."""


def gradient_study(rng, name):
    """Return a spoilt study that optimises, identifies or propagates uncertainty."""
    verb, text = rng.choice(VARIANTS)
    is_data = verb == "identify" and rng.random() < 0.4
    files = yaml_cases.around({
        "study.yaml": text.encode() if is_data else _yaml(text, rng),
        "measured.csv": _lines(MEASURED, rng) if is_data else MEASURED.encode(),
    })  # fmt: skip
    command = [verb, "study.yaml", "-o", "out.h5"]
    if _LONG_RUNS.search(files["study.yaml"]):
        command = ["validate", "study.yaml"]
    return Case(name, files, command, yaml_cases.OUTPUTS)


def _mostly_validate(file, rng):
    if rng.random() < 0.85:
        return ["validate", file]
    return ["run", file, "-o", "out.h5", *SHORT]
