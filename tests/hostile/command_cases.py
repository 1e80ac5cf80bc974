"""Commands on whole inputs with hostile values of their options."""

import mechanism_cases
import mutations
import result_cases
import road_file_cases
import table_cases
import yaml_cases
from harness import Case

PENDULUM = "scenarios/systems/double_pendulum.yaml"
QUARTER = "scenarios/systems/quarter_car.yaml"
WHEELSET = "systems/simple_wheelset.yaml"
FOUR_BAR = "systems/four_bar.yaml"
PROFILES = ["profiles", "S1002", "60E1", "--shift", "0 mm", "--amplitude", "3 mm"]
HUNT = [*mechanism_cases.HUNT, "-o", "out.h5"]
DRIVE = ["kinematics", FOUR_BAR, "--drive", "crank.angle=0:40 deg:4", "--no-plots", "-o", "out.h5"]
SWEPT = ["response", QUARTER, "--input", "road.height", "--output", "body.height"]
STATE = ["linearise", QUARTER, "--input", "force:body.height", "--output", "body.height", "-o",
         "out.npz"]  # fmt: skip
RIG = ["rig", "double_wishbone_suspension", "--no-plots", "-o", "out.h5"]
VERBS = [
    (["equilibrium", PENDULUM], {"--speed": "3 m/s", "--set": "parameters.length=1 m"}),
    (["eig", WHEELSET], {"--speed": "5 m/s:50 m/s:3", "--start": "static"}),
    (HUNT, {"--from": "-1 N*s/m", "--to": "2 N*s/m", "--points": "4", "--parameter": "gain",
            "--channel": "mass.x", "--amplitude": "3e-3"}),
    (SWEPT, {"--input": "road.height", "--output": "body.height", "--from": "0.1 Hz",
             "--to": "30 Hz",
             "--points": "8", "--at": "1 Hz", "--speed": "1 m/s", "--spacing": "log"}),
    (STATE, {"--input": "force:body.height", "--output": "body.height", "--order": "2",
             "--to": "*"}),
    (DRIVE, {"--drive": "crank.angle=0 deg:9 deg:3", "--channel": "*"}),
    (PROFILES, {"--gauge": "1435 mm", "--inclination": "1:40", "--radius": "460 mm",
                "--back-to-back": "1360 mm", "--flange-back": "70 mm", "--right-radius": "460 mm",
                "--gauge-depth": "14 mm", "--yaw": "5 mrad", "--curve-radius": "300 m",
                "--shift": "-1:1:1", "--amplitude": "1:3:1", "--smoothing": "5 mm",
                "--right-rail": "60E1", "--right-wheel": "S1002", "--defects": "refuse"}),
    (["track", "track.yaml"], {"--every": "5 m", "--speed": "80 km/h"}),
    (["tyre", "a.tir", "-o", "out.csv"], {"--load": "4 kN", "--convention": "standard"}),
    (["cam", "cam.yaml", "--profile", "out.dxf"], {"--tolerance": "10 um"}),
    (["info", "run.h5"], {"--json": None}),
    (["assess", "car.h5"], {"--from": "0 s", "--to": "1 s"}),
    (["plot", "run.h5", "--only", "*"], {"--only": "upper.angle", "--against": "time",
                                         "--format": "png"}),
    (["animate", "run.h5"], {"--from": "0 s", "--to": "10 ms", "--channel": "*"}),
    (["animate", "run.h5", "--picture", "out.png"], {"--at": "5 ms", "--view": "side"}),
    (["compare", "run.h5", "run.h5"], {"--relative": "1e-3", "--absolute": "1", "--channel": "*",
                                       "--tolerance": "upper.*=1e-3"}),
    (["export-data", "run.h5", "-o", "out.csv"], {"--channel": "upper.*"}),
    (["inverse", "scenarios/systems/slider_crank.yaml", "--no-plots", "-o", "out.h5"],
     {"--set": "output.interval=5 ms"}),
    (["models", "show"], {"": "double_pendulum"}),
    (["examples", "copy"], {"": "quarter_car"}),
    (["steady"], {"": PENDULUM, "--radius": "100 m", "--speed": "20 m/s"}),
    (["handling"], {"": PENDULUM, "--against": PENDULUM}),
    (["sensitivity", PENDULUM], {"--of": "max(upper.angle)", "--to": "length"}),
    (RIG, {"--test": "parallel", "--values": "-10 mm:10 mm:3", "--travel": "1 mm"}),
]  # fmt: skip
OUTPUTS = (*yaml_cases.OUTPUTS, "out.npz", "out.csv", "out.dxf", "out.png", "run_plots",
           "run_animation.html", "systems/quarter_car.yaml", "quarter_car.yaml")  # fmt: skip


def command(rng, name):
    """Return a verb of the program with one to three hostile values."""
    words, options = rng.choice(VERBS)
    words = list(words)
    for option in rng.sample(list(options), min(len(options), rng.choice([1, 1, 2, 3]))):
        given = options[option]
        value = _value(given, rng)
        if option in words:
            words[words.index(option) + 1] = value
        else:
            words += [option] if given is None else [value] if not option else [option, value]
    files = yaml_cases.around({
        "track.yaml": table_cases.LAYOUT.encode(),
        "cam.yaml": mechanism_cases.CAM.encode(),
        "self_excited.yaml": mechanism_cases.SELF_EXCITED.encode(),
        "a.tir": road_file_cases.tyres()[0].encode(),
        "run.h5": result_cases.seeds()["run.h5"],
        "car.h5": result_cases.seeds()["car.h5"],
    })  # fmt: skip
    return Case(name, files, words, OUTPUTS)


def _value(given, rng):
    if given is None or rng.random() < 0.15:
        return given
    way = rng.random()
    if way < 0.35:
        value = mutations.text(rng)
    elif way < 0.7:
        at = rng.randrange(len(given) + 1)
        value = given[:at] + rng.choice(["", "-", "e308", ":", " ", "*", "[", "0", "=", "nan"])
        value += given[at + rng.choice([0, 0, 1]) :]
    else:
        number = rng.choice(["0", "-1", "1e308", "nan", "inf", "1e-300", "1e9", "0.3", "1e12"])
        value = f"{number} {given.split()[-1]}" if " " in given else number
    value = value.replace("\0", "")
    return f" {value}" if value.startswith("-") and rng.random() < 0.5 else value
