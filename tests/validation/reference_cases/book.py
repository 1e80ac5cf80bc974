"""The mechanisms of chapter 2 and the rolling disk against equations written by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from ruamel.yaml import YAML

from reference_cases.comparison import Group, deviation, figure
from reference_cases.hand_equations import EQUATIONS
from reference_cases.motions import quiet
from reference_cases.rolling_disk import STRAIGHT, UPRIGHT, Disk, critical_rate
from reference_cases.system_files import ROOT, TIGHT, Matrices, motion, parameters
from vehicledyn.analyses import find_modes
from vehicledyn.files.scenario import load_scenario

STATES = 20
WORDS = {
    "slider_crank_two_angles": "slider-crank in two angles (2.12)",
    "ball_in_tube_dependent": "ball in a turning tube (2.60)",
    "upright_disk": "upright rolling disk (2.18, 2.19)",
    "parallelogram": "parallelogram (figure 2.5)",
    "roller_pendulum": "pendulum on two rollers (2.92)",
    "double_spring_mass": "double spring-mass system",
    "small_cart": "small cart with a pendulum",
    "small_cart_2": "small cart on rolling axles",
}
HAND = "Lagrange's equations by hand"
SHARES = {"disk": 0.5, "hoop": 1.0}
REST = ("initial.disk.lean=0", "initial.disk.yaw_rate=0", "initial.disk.spin_rate=0")


def compare():
    """Return the comparisons."""
    rows = [row for name in EQUATIONS for row in _equations(name)]
    rows += [_tube(), *_critical_rates(), _disk_motion(), _circle()]
    note = (
        "Equation numbers are those of Samin and Fisette, Symbolic Modeling of Multibody Systems "
        "(2003). Equations are compared at random times, places and rates, relative to the largest "
        "element; multipliers where the constraints hold. Bands: as asked of the program."
    )
    return Group("Mechanisms of chapter 2 and of the tutorial, rolling disk", note, tuple(rows))


def _equations(name):
    """Yield the deviation of M, c, J and γ, and of multipliers if there are any."""
    matrices, hand = Matrices(name), EQUATIONS[name]
    p, worst, forces = parameters(matrices.prepared), 0.0, 0.0
    for seed in range(STATES):
        q, v = matrices.consistent(seed, 0.1 * seed)
        equations = hand(p, 0.1 * seed, q, v)
        mass, bias, jacobian, quadratic = matrices.at(0.1 * seed, q, v)
        acting = np.abs(jacobian).max(axis=1, initial=0.0) > 0.0
        found = (mass, bias, jacobian[acting], quadratic[acting])
        worst = max(worst, *map(_difference, found, equations.in_file_coordinates()))
        _, channels = matrices.solved(0.1 * seed, q, v)
        ends = (".multiplier", ".force_x", ".force_z", "_rolls.force")
        told = np.array([value for key, value in channels.items() if key.endswith(ends)])
        forces = max(forces, _difference(told, equations.solution()[1]))
    reference = f"{STATES} random states"
    yield deviation(
        HAND,
        f"{WORDS[name]}: mass matrix, bias, Jacobian, quadratic term",
        reference=reference,
        largest=worst,
        band=1e-12,
        unit="(relative)",
    )
    if len(quadratic):
        yield deviation(
            HAND,
            f"{WORDS[name]}: constraint forces",
            reference=reference,
            largest=forces,
            band=1e-10,
            unit="(relative)",
        )


def _difference(found, wanted):
    return float(np.abs(found - wanted).max(initial=0.0) / (1.0 + np.abs(wanted).max(initial=0.0)))


def _tube():
    run = motion("ball_in_tube", *TIGHT)
    wanted = 0.3 * np.cosh(2.0 * run.time) - 0.1 * np.sinh(2.0 * run.time)
    return deviation(
        "solution of (2.59), k = 0",
        "ball in a turning tube: motion of 1.5 s",
        reference="q0 cosh wt + q0'/w sinh wt",
        largest=np.abs(run["ball.place"] - wanted).max(),
        band=1e-9,
        unit="m",
    )


def _critical_rates():
    path = Path(__file__).parents[1] / "data" / "rolling_disk.yaml"
    reference = YAML(typ="safe").load(path.read_text(encoding="utf-8"))
    scenario = ROOT / "scenarios" / "systems" / "rolling_disk.yaml"
    for kind, share in SHARES.items():
        for case, rate in (("straight", STRAIGHT), ("upright", UPRIGHT)):
            squares = {}
            for value in (2.0, 4.5):
                changes = [f"parameters.axle_share={share}", *REST, f"{rate}={value} rad/s"]
                loaded = load_scenario(scenario, changes)
                report = find_modes(loaded, speeds=[], backend="interpreted", progress=quiet)
                (entry,) = report.as_dict()["speeds"]
                modes = [complex(m["real"], m["imaginary"]) for m in entry["modes"]]
                squares[value] = (max(modes, key=abs) ** 2).real
            words = "rolling straight" if case == "straight" else "spinning upright"
            yield figure(
                "closed form",
                f"rolling {kind}: critical rate, {words}",
                reference=reference[kind][case],
                computed=critical_rate(squares),
                band=2e-6,
                unit="rad/s",
                digits=7,
            )


def _disk_motion():
    run = motion("rolling_disk", "duration=10 s", "output.interval=20 ms", *TIGHT)
    names = ("disk.lean", "disk.yaw", "disk.spin")
    names = (*names, *(f"{n}_rate" for n in names), "contact_x", "contact_y")
    wanted = Disk(1.0, 0.5, 0.5).motion([run[n][0] for n in names], run.time)
    return deviation(
        "Newton and Euler by hand, own integration",
        "rolling disk: angles, rates, path of the contact over 10 s",
        reference="each over its largest value",
        largest=max(
            np.abs(run[n] - row).max() / max(1.0, np.abs(row).max())
            for n, row in zip(names, wanted, strict=True)
        ),
        band=1e-7,
        unit="(relative)",
    )


def _circle():
    run = motion("tricycle", *TIGHT)
    p, late = parameters(run.prepared), run.time > 5.0
    speed = np.hypot(run["frame.x_rate"], run["frame.y_rate"])[late]
    return figure(
        "closed form L/tan d",
        "tricycle: radius of its circle at a steer angle of 20 degrees",
        reference=p["wheelbase"] / np.tan(p["steer"]),
        computed=float(np.mean(speed / run["frame.yaw_rate"][late])),
        band=1e-8,
        unit="m",
        digits=9,
    )
