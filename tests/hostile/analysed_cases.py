"""Spoilt systems under every analysis, beside those that only check, run and find modes.

Measured forces that a tyre is fitted to, and a run whose figures are drawn, are spoilt too.
"""

import mutations
import road_file_cases
import yaml_cases
from harness import Case
from yaml_cases import ROOT, SHORT

QUIET = ["--no-plots", "-q", "-o", "out.h5"]
DRIVEN = ["--drive", "crank.angle=0:40 deg:4", *QUIET]
PENDULUM = ["double_pendulum"]
ANALYSES = [
    (["kinematics", "{}", *DRIVEN], ["four_bar", "slider_crank", "parallelogram"]),
    (["inverse", "scenarios/{}", *SHORT, "-o", "out.h5"], ["slider_crank"]),
    (["response", "{}", "-u", "road.height", "-y", "body.height", "--points", "9", "-o", "out.h5"],
     ["quarter_car"]),
    (["linearise", "{}", "-u", "road.height", "-y", "body.height", "-o", "out.npz"],
     ["quarter_car"]),
    (["hunt", "{}", "--from", "50 m/s", "--to", "60 m/s", "--points", "4", "--no-simulation",
      *QUIET], ["simple_wheelset"]),
    (["sensitivity", "scenarios/{}", "--of", "max(upper.angle)", "--to", "parameters.length",
      *SHORT[:6]], PENDULUM),
    (["eig", "{}", "--plots", "figures", "-o", "out.h5"], ["double_spring_mass", "bicycle"]),
    (["run", "scenarios/{}", "-o", "out.h5", "--plots", "figures", *SHORT[:8]],
     ["double_pendulum", "double_spring_mass", "ball_in_tube"]),
    (["models", "show", "{}"], ["quarter_car", "four_bar", "small_cart"]),
    *((["export", "{}", "--to", language, "-o", "out.txt"], ["double_pendulum", "four_bar"])
      for language in ("c", "python", "matlab", "cuda")),
    (["export", "scenarios/{}", "--to", "fmu", "-o", "out"], ["double_pendulum"]),
    (["validate", "{}"],
     ["geneva_drive", "screw_jack", "roller_pendulum", "merry_go_round", "t_handle",
      "four_bar_chain", "mecanum_cart", "small_cart_2", "tricycle", "electric_motor",
      "manual_gearbox",
      "automatic_gearbox", "open_differential", "final_drive", "engine_and_gearbox",
      "coil_spring_axle", "air_spring_axle", "anti_roll_bar", "golden_car",
      "cam_follower"]),
]  # fmt: skip
OUTPUTS = (*yaml_cases.OUTPUTS, "out.npz", "out.txt", "out.h", "out", "figures")
MEASURED = "load [N], slip_angle [deg], lateral_force [N]\n" + "".join(
    f"{load}, {angle}, {-load * 0.2 * angle}\n" for load in (2000, 4000) for angle in range(-4, 5)
)


def analysed(rng, name):
    """Return an analysis of a spoilt system."""
    command, systems = rng.choice(ANALYSES)
    file = f"systems/{rng.choice(systems)}.yaml"
    texts = yaml_cases.system_texts() | {file: (ROOT / file).read_text(encoding="utf-8")}
    spoilt = yaml_cases._spoilt({file: texts[file]}, file, rng)
    words = [word.format(file) if "{}" in word else word for word in command]
    return Case(name, yaml_cases.around({file: spoilt}), words, OUTPUTS)


def fitted(rng, name):
    """Return a fit of a tyre to spoilt forces, or a comparison with a spoilt tyre."""
    text = road_file_cases.tyres()[0]
    files = {"a.tir": text.encode(), "b.tir": text.encode(), "forces.csv": MEASURED.encode()}
    extra = rng.choice([[], ["--coefficients", "PKY1,PDY1"], ["--coefficients", "PCY1"],
                        ["--coefficients", mutations.text(rng).replace("\0", "")]])  # fmt: skip
    if rng.random() < 0.8:
        content = mutations.spoil_lines(MEASURED, rng).encode("utf-8", "surrogatepass")
        files["forces.csv"] = content
        words = ["tyre", "a.tir", "--fit", "forces.csv", "-o", "new.tir", *extra]
    else:
        files["b.tir"] = mutations.spoil_lines(text, rng).encode("utf-8", "surrogatepass")
        words = ["tyre", "a.tir", "--compare", "b.tir", "--plots", "figures"]
    return Case(name, files, words, ("new.tir", "figures"))
