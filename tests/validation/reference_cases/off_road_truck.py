"""The off-road truck on a slope and in sand against statics, power balance and a closed form."""

import math
from pathlib import Path

import numpy as np

import vehicledyn as vd
from reference_cases.comparison import figure

SCENARIOS = Path(__file__).parents[3] / "scenarios" / "systems"
CORNERS = [(axle, side) for axle in ("front", "rear") for side in ("left", "right")]
WHEELS = [f"truck.{axle}_axle.wheel_{side}" for axle, side in CORNERS]
SHAFTS = [f"truck.{axle}_axle.{side}_wheel" for axle, side in CORNERS]
RADIUS, WIDTH, SLOPE = 0.4699, 0.3, 0.6


def last(run, channels):
    return np.array([np.asarray(run[name])[-1] for name in channels])


def rows():
    """Yield the statics of the climb, its power and the sinkage."""
    yield from climb_rows()
    yield from sinkage_rows()


def climb_rows():
    """Yield forces, load shift and power on the slope, when the speed is steady."""
    slope = SCENARIOS / "off_road_truck_slope.yaml"
    climb = vd.simulate(slope, set={"duration": "6 s"})
    loads, pulls, sides = (
        last(climb, [f"{wheel}.tyre.{force}_force" for wheel in WHEELS])
        for force in ("normal", "longitudinal", "lateral")
    )
    toe = last(climb, [f"{shaft}_angles.steer_angle" for shaft in SHAFTS])
    along = pulls * np.cos(toe) - sides * np.sin(toe)
    yield figure(
        "statics", "off-road truck on a slope of 60 %: tyre forces along over those across it",
        reference=SLOPE, computed=along.sum() / loads.sum(), band=1.2e-3, unit="", digits=4,
    )  # fmt: skip
    flat = vd.simulate(slope, set={"road.slope_x": 0, "duration": "10 ms"})
    level = np.asarray([np.asarray(flat[f"{wheel}.tyre.normal_force"])[0] for wheel in WHEELS])
    weight = level.sum()
    height = np.asarray(flat["energy.gravity"])[0] / weight
    cosine = 1.0 / math.hypot(1.0, SLOPE)
    wheelbase = 1.632965 + 1.744965 - 0.076  # of the wheels' centres
    rear = (level[2:].sum() + weight * SLOPE * height / wheelbase) * cosine
    for name, wanted, got, share in (
        ("load of all wheels", weight * cosine, loads.sum(), 2e-3),
        ("load of the rear axle", rear, loads[2:].sum(), 2e-2),
    ):
        yield figure(
            "statics", f"off-road truck on a slope of 60 %: {name}",
            reference=wanted / 1e3, computed=got / 1e3, band=round(share * wanted / 1e3, 2),
            unit="kN",
        )  # fmt: skip
    torque, turn = last(climb, ["drive.torque", "transfer.input.angle_rate"])
    arms = RADIUS - last(climb, [f"{wheel}.tyre.deflection" for wheel in WHEELS])
    turns = last(climb, [f"{shaft}.spin_rate" for shaft in SHAFTS])
    yield figure(
        "power of the drive",
        "off-road truck on a slope of 60 %: power of tyre forces at the wheels",
        reference=torque * turn / 1e3, computed=(turns * pulls * arms).sum() / 1e3,
        band=round(5e-3 * torque * turn / 1e3, 2), unit="kW",
    )  # fmt: skip


def sinkage_rows():
    """Yield loads in smooth sand with n = 1, N = b k R²/2 (θ - sin θ cos θ) at R (1 - cos θ).

    The pressure k z then is largest at the lowest point and no shear stress acts.
    """
    soil = {"cohesion": 0, "friction_angle": 0, "exponent": 1, "front_share": 1e-6}
    changes = {f"road.soil.{name}": value for name, value in soil.items()}
    run = vd.simulate(
        SCENARIOS / "off_road_truck_sand.yaml",
        set={**changes, "start": "static", "duration": "10 ms"},
    )
    modulus = 0.99e3 / WIDTH + 1528.43e3
    for wheel in WHEELS[::2]:
        load, depth, felt = last(
            run, [f"{wheel}.tyre.normal_force", f"{wheel}.sinkage", f"{wheel}.tyre.deflection"]
        )
        rim = RADIUS - (felt - depth)
        entry = math.acos(1.0 - depth / rim)
        wanted = 0.5 * WIDTH * modulus * rim**2 * (entry - math.sin(entry) * math.cos(entry))
        axle = "front" if "front" in wheel else "rear"
        yield figure(
            "closed form of Bekker's pressure, n = 1",
            f"off-road truck sunk in soil: load of a {axle} wheel",
            reference=wanted / 1e3, computed=load / 1e3, band=round(2e-3 * wanted / 1e3, 3),
            unit="kN",
        )  # fmt: skip
