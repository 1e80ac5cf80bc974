"""Power balance of the free-running car at random states, and the loops during the slalom."""

from __future__ import annotations

import numpy as np

from reference_cases.comparison import Group, deviation
from reference_cases.motions import drive, drive_text
from vehicledyn.analyse.equilibrium import assemble

STATES = 20
SPREAD = {"chassis.z": 0.02, "a_arm_angle": 0.15, "roll": 0.15, "pitch": 0.15, "yaw": 3.0}
"""Half width of the random positions [m, rad] by the end of the name; others 0.3."""
COASTING = """title: Iltis coasting on free wheels
model: iltis
tyres: {kind: magic_formula_1987}
road: {kind: %s}
wheel_spin: free
speed: 15 m/s
start: steady
manoeuvre: {kind: straight}
duration: 10 ms
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""


def balance(prepared, seed):
    """Return rate of energy and power of forces at a random state [W]."""
    random = np.random.default_rng(seed)
    e, kernel = prepared.equations, prepared.kernel
    state = np.array([s.start for s in e.states])
    moving = set(e.velocities)
    for k, variable in enumerate(e.states):
        width = next((w for end, w in SPREAD.items() if variable.name.endswith(end)), 0.3)
        state[k] += random.uniform(-1.0, 1.0) * (1.5 if k in moving else width)
    guess = np.array([u.start for u in e.unknowns])
    unknowns = assemble(kernel, 0.0, state, guess)
    total = prepared.derivatives.total(0.0, state, unknowns, kernel.parameters)
    names = [channel.name for channel in e.channels]
    rates = kernel.rates(0.0, state, unknowns)
    energy = (
        total.outputs[names.index("energy.kinetic")]
        + (total.outputs[names.index("energy.gravity")])
    )
    power = kernel.outputs(0.0, state, unknowns)[names.index("power.forces")]
    return float(energy @ rates), float(power)


def compare():
    """Return the comparisons."""
    rows = []
    for road, words in (("flat", "flat road"), ("plane, slope_x: 0.05, slope_y: -0.08", "slope")):
        prepared = drive_text(COASTING % road).prepared
        pairs = [balance(prepared, seed) for seed in range(STATES)]
        powers = [abs(power) for _, power in pairs]
        rows.append(
            deviation(
                "power of all forces",
                f"rate of kinetic and gravity energy, {words}",
                reference=f"{STATES} random states, {min(powers):.2g} ... {max(powers):.2g} W",
                largest=max(abs(rate - power) / abs(power) for rate, power in pairs),
                band=1e-9,
                unit="(relative)",
            )
        )
    slalom = drive("iltis_slalom")
    for kind, band, unit in (("position", 1e-10, "m"), ("velocity", 1e-9, "m/s")):
        rows.append(
            deviation(
                "closed loops",
                f"{kind} error of all loops during the slalom",
                reference=f"{len(slalom.time)} samples, 0 {unit}",
                largest=slalom[f"constraints.{kind}_error"].max(),
                band=band,
                unit=unit,
            )
        )
    note = (
        "The rate of energy is the exact derivative along the motion, with the dependent "
        "coordinates following. Bands: as asked of the program."
    )
    return Group("Iltis: power balance and loops", note, tuple(rows))
