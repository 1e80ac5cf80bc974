"""Kinematics of the front suspension with the chassis fixed, over leaf angle and rack."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from reference_cases.comparison import Group, deviation
from reference_cases.motions import SCENARIOS
from reference_cases.tables import read_columns
from vehicledyn.analyse.equilibrium import assemble
from vehicledyn.analyses.preparation.build_model import build_vehicle
from vehicledyn.files.scenario import load_scenario
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody.equations.derivation import derive
from vehicledyn.multibody.model.parts import BasePart, Output
from vehicledyn.symbolic.equations import Channel

SOURCE = "independent model in ten minimal coordinates"
RACK_SPEED = 0.01  # m/s, of a ramp that serves to set the rack through the time
LEAF_ANGLE = "leaf_spring_fl.joint_angle"
COLUMNS = {
    "dz_mm": ("wheel centre, vertical", 1e-3, "m", 1e-5),
    "dy_mm": ("wheel centre, lateral", 1e-3, "m", 1e-5),
    "dx_mm": ("wheel centre, longitudinal", 1e-3, "m", 1e-5),
    "toe_deg": ("toe angle", 1.0, "deg", 1e-3),
    "axis_incl_deg": ("inclination of the wheel axis", 1.0, "deg", 1e-3),
    "shock_len": ("length of the shock absorber", 1.0, "m", 1e-5),
    "leaf_L": ("length of the leaf spring", 1.0, "m", 1e-5),
}


@dataclass(frozen=True)
class WheelPose(BasePart):
    """Centre and axis of a wheel in the axes of the chassis, from its centre of mass."""

    wheel: str
    chassis: str

    def outputs(self, situation):
        """Return the three components of both."""
        pair = situation.kinematics.between(self.chassis, self.wheel)
        to_chassis = pair.rotation(self.chassis).T
        reach = to_chassis @ (pair.position(self.wheel) - pair.position(self.chassis))
        axis = to_chassis @ pair.rotation(self.wheel)[:, 1]
        return tuple(
            Output(Channel(f"{self.name}.{name}_{k}", unit, name), vector[index])
            for name, unit, vector in (("centre", "m", reach), ("axis", "1", axis))
            for index, k in enumerate("xyz")
        )


class Corner:
    """The front left corner of the Iltis at any leaf angle and rack displacement."""

    def __init__(self):
        overrides = (f"manoeuvre.rate={RACK_SPEED} m/s", "manoeuvre.ramp_time=10 s")
        loaded = load_scenario(SCENARIOS / "iltis_ramp_steer.yaml", overrides)
        vehicle = build_vehicle(loaded).with_parts(WheelPose("pose", "wheel_fl", "chassis"))
        equations = derive(vehicle.system)
        self.kernel = compile_kernel(equations, backend="interpreted")
        self.names = [channel.name for channel in equations.channels]
        self.state = np.array([s.start for s in equations.states])
        states = [s.name for s in equations.states]
        self.arm = states.index("suspension_fl.a_arm_angle")
        self.guess = np.array([u.start for u in equations.unknowns])

    def at_arm(self, arm_angle, rack):
        """Return all channels for an angle of the A-arm [rad] and a rack displacement [m]."""
        time = rack / RACK_SPEED
        self.state[self.arm] = arm_angle
        unknowns = assemble(self.kernel, time, self.state, self.guess)
        values = self.kernel.outputs(time, self.state, unknowns)
        return dict(zip(self.names, values, strict=True))

    def at_leaf(self, leaf_angle, rack):
        """Return all channels for an angle of the leaf [rad], found by the secant method."""
        angles = [leaf_angle - self.at_arm(0.0, rack)[LEAF_ANGLE]]
        angles.append(1.01 * angles[0] + 1e-6)
        misses = [self.at_arm(a, rack)[LEAF_ANGLE] - leaf_angle for a in angles]
        while abs(misses[-1]) > 1e-13:
            if len(angles) > 30:
                raise ValueError(f"no arm angle gives the leaf angle {leaf_angle}")
            slope = (misses[-1] - misses[-2]) / (angles[-1] - angles[-2])
            angles.append(angles[-1] - misses[-1] / slope)
            misses.append(self.at_arm(angles[-1], rack)[LEAF_ANGLE] - leaf_angle)
        return self.at_arm(angles[-1], rack)


@lru_cache(maxsize=1)
def both():
    """Return the reference columns and the computed ones, in the reference's units."""
    reference, corner = read_columns("iltis_front_kinematics.csv"), Corner()
    nominal = centre_of(corner.at_leaf(np.arctan2(0.531 - 0.600, 0.488 - 0.1585), 0.0))
    rows = [
        columns_of(corner.at_leaf(-phi, 1e-3 * rack), nominal)
        for phi, rack in zip(reference["phi_rad"], reference["rack_mm"], strict=True)
    ]
    return reference, {key: np.array([row[key] for row in rows]) for key in COLUMNS}


def centre_of(channels):
    """Return the wheel centre in chassis axes [m]."""
    return np.array([channels[f"pose.centre_{k}"] for k in "xyz"])


def columns_of(channels, nominal):
    """Return what the reference lists, from the channels of one position."""
    moved = 1e3 * (centre_of(channels) - nominal)
    axis = [channels[f"pose.axis_{k}"] for k in "xyz"]
    return {
        "dx_mm": moved[0],
        "dy_mm": moved[1],
        "dz_mm": moved[2],
        "toe_deg": np.degrees(np.arctan2(-axis[0], axis[1])),
        "axis_incl_deg": np.degrees(np.arcsin(axis[2])),
        "shock_len": channels["shock_fl.length"],
        "leaf_L": channels["leaf_spring_fl.length"],
    }


def compare():
    """Return the comparisons, over all positions."""
    reference, computed = both()
    rows = []
    for key, (words, factor, unit, band) in COLUMNS.items():
        known = factor * reference[key]
        rows.append(
            deviation(
                SOURCE,
                words,
                reference=f"{len(known)} positions, {known.min():.6g} ... {known.max():.6g} {unit}",
                largest=np.abs(factor * computed[key] - known).max(),
                band=band,
                unit=unit,
            )
        )
    note = "Bands: as asked of the program; the reference has six digits."
    return Group("Iltis: kinematics of the front suspension", note, tuple(rows))
