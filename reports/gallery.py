"""Write docs/gallery.md and its pictures: ``python reports/gallery.py [NAME ...]``.

Each scenario of scenarios and of scenarios/systems is run; what its picture shows stands in
PICTURES, else its first coordinates. With names only these are drawn anew.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vehicledyn.results.store.reader import Result

ROOT = Path(__file__).resolve().parents[1]
SCENARIOS = ROOT / "scenarios"
PAGE = ROOT / "docs" / "gallery.md"
FIGURES = ROOT / "docs" / "figures"
_STRETCHED = ("small_car", "assembled_car", "car_of_parts", "iltis_slalom", "off_road_truck_rough")
"""Whose paths are long: not true to scale."""
SIZE, DOTS = (4.2, 2.5), 100
_SMALL = 0.1
"""Largest place of an axis in millimetres [m]."""
_SHORT = (11, 23)
"""Letters below which three and two names of a legend stand side by side."""
HEAD = """# Gallery

Every scenario that comes with the program, with a picture of its run.
`python reports/gallery.py` makes page and pictures.
"""
VEHICLES = """## Vehicles

Vehicles on roads and rails, run by the files of [scenarios](../scenarios).
"""
SYSTEMS = """## Systems

Systems written in YAML, [systems](../systems), run by the files of
[scenarios/systems](../scenarios/systems).
"""


@dataclass(frozen=True)
class Picture:
    """Channels over time, or over the first one (``across``); a path is true to scale."""

    channels: tuple[str, ...]
    unit: str
    label: str
    across: str = ""
    across_label: str = ""


def _path(x: str, y: str, label: str = "Place") -> Picture:
    return Picture((y,), "m", label, x)


PICTURES = {
    "bas2000_curve": Picture(
        ("rail_large_left.left.Y", "rail_large_right.right.Y", "rail_small_left.left.Y"),
        "kN",
        "Force on the rail",
    ),
    "bogie_hunting": Picture(("axle_1.lateral_shift", "axle_2.lateral_shift"), "mm", "Shift"),
    "manchester_irregular_track": Picture(
        ("axle_1.lateral_shift", "axle_4.lateral_shift"), "mm", "Shift"
    ),
    "s1002_uic60_geometry": Picture(
        ("wheels.left.contact_1.place", "wheels.left.contact_2.place"),
        "mm",
        "Place on the left wheel",
        "wheels.lateral_shift",
        "Lateral shift of the wheelset",
    ),
    "tram2000_curve": Picture(
        ("front.yaw", "rear.yaw", "front_bolster.yaw"), "deg", "Articulations and bolster"
    ),
    "ball_in_tube": _path("ball.x", "ball.y", "Ball, seen from above: y"),
    "ball_in_tube_dependent": Picture(("tube.multiplier",), "N", "Force of the tube's wall"),
    "bicycle": Picture(("frame.roll", "fork.steer"), "deg", "Angle"),
    "cooperrider_classic": Picture(("front.lateral", "rear.lateral"), "mm", "Lateral shift"),
    "curving_wheelset": Picture(("wheelset.lateral",), "mm", "Lateral shift"),
    "double_pendulum": _path("tip.x", "tip.z", "Tip: z"),
    "double_spring_mass": Picture(("upper.height", "lower.height"), "mm", "Height"),
    "cam_follower": Picture(("contact.gap",), "mm", "Gap between cam and follower"),
    "motorcycle": Picture(("frame.roll", "fork.steer"), "deg", "Angle"),
    "off_road_truck_rough": Picture(("truck.chassis.z",), "m", "Height z", "truck.chassis.x"),
    "off_road_truck_sand": Picture(
        tuple(f"truck.{axle}_axle.wheel_left.sinkage" for axle in ("front", "rear")),
        "mm",
        "Sinkage of the left wheels",
    ),
    "off_road_truck_slope": Picture(
        tuple(f"truck.{axle}_axle.wheel_left.tyre.normal_force" for axle in ("front", "rear")),
        "kN",
        "Load of the left wheels",
    ),
    "omni_cart": _path("cart.x", "cart.y", "Cart, seen from above: y"),
    "mecanum_cart": Picture(
        tuple(f"wheel_{k}.spin_rate" for k in ("00", "01")), "rad/s", "Speed of the front wheels"
    ),
    "geneva_drive": Picture(("driver.angle_rate", "wheel.angle_rate"), "rad/s", "Angular velocity"),
    "valve_train": Picture(("cam.normal_force", "seat.force"), "N", "Force"),
    "four_bar": Picture(("crank.angle", "rocker.angle"), "deg", "Angle"),
    "four_bar_chain": Picture(("upright_0.angle",), "deg", "Angle of the uprights"),
    "iltis_bump_anti_phase": Picture(("chassis.roll",), "deg", "Roll angle"),
    "iltis_bump_in_phase": Picture(("chassis.z",), "m", "Height of the chassis"),
    "iltis_ramp_steer": _path("chassis.x", "chassis.y", "Chassis, seen from above: y"),
    "iltis_sine_steer": Picture(("chassis.roll", "chassis.yaw"), "deg", "Angle of the chassis"),
    "iltis_slalom": Picture(("chassis.y",), "m", "Place y", "chassis.x"),
    "iltis_standstill": Picture(
        tuple(f"wheel_{place}.tyre.normal_force" for place in ("fl", "rl")), "kN", "Wheel load"
    ),
    "jeep": Picture(("chassis.roll", "front_axle.roll", "rear_axle.roll"), "deg", "Roll angle"),
    "jeep_suspension": Picture(("body.roll", "axle.roll"), "deg", "Roll angle"),
    "merry_go_round": Picture(("seat_1.outward", "seat_1.forward"), "deg", "Angle of a seat"),
    "parallelogram": Picture(("first_crank.angle", "coupler.angle"), "deg", "Angle"),
    "quarter_car": Picture(("road.height", "wheel.height", "body.height"), "mm", "Height"),
    "radiation_counter": _path("head.y", "head.z", "Head, seen from the front: z"),
    "roller_pendulum": Picture(("pendulum.angle",), "deg", "Angle of the pendulum"),
    "rolling_disk": _path("contact_x", "contact_y", "Contact: y"),
    "radial_wheelset": Picture(("wheelset.lateral",), "mm", "Lateral shift"),
    "rail_wheelset": Picture(("wheelset.lateral",), "mm", "Lateral shift"),
    "simple_wheelset": Picture(("wheelset.lateral",), "mm", "Lateral shift"),
    "slider_crank": Picture(("slider.position",), "mm", "Place of the slider"),
    "truck_flexible_frame": Picture(
        ("frame.cab_front_left_z", "frame.load_rear_left_z"), "mm", "Deflection of the frame"
    ),
    "slider_crank_flexible": Picture(("bending_1",), "mm", "Bending of the rod"),
    "slider_crank_two_angles": Picture(("guide.multiplier",), "N", "Normal force of the guide"),
    "assembled_car": Picture(("chassis.y",), "m", "Place y", "chassis.x"),
    "car_and_caravan": Picture(("caravan.body.yaw",), "deg", "Articulation angle"),
    "car_of_parts": Picture(("chassis.y",), "m", "Place y", "chassis.x"),
    "flexible_axle_wheelset": Picture(
        ("left_half.tip_z", "right_half.tip_z"), "mm", "Bending of the axle"
    ),
    "jeep_leaf_springs": Picture(
        ("left_front.tip_z", "right_front.tip_z"), "mm", "Deflection of the leaves"
    ),
    "coach_flexible_body": Picture(
        ("body.middle_z", "body.bolster_1_z"), "mm", "Deflection of the car body"
    ),
    "coach_of_two_bogies": Picture(("car.y", "bogie_1.wheelset_1.y"), "mm", "Place y"),
    "double_wishbone_axle": Picture(("chassis.height",), "mm", "Height of the chassis"),
    "five_link_axle": Picture(("chassis.height",), "mm", "Height of the chassis"),
    "manchester_bogie": Picture(("wheelset_1.y", "wheelset_2.y"), "mm", "Wheelsets: y"),
    "small_car": Picture(("chassis.y",), "m", "Place y", "chassis.x"),
    "small_cart": Picture(("cart.x", "mass.x"), "m", "Cart and pendulum: x"),
    "small_cart_2": Picture(("load.slide",), "mm", "Load against the cart"),
    "screw_jack": Picture(("nut.turn_rate",), "rad/s", "Speed of the spindle"),
    "split_braking": Picture(("steering_angle.angle", "chassis.yaw"), "deg", "Angle"),
    "swept_sine": Picture(("steering_angle.angle", "chassis.roll"), "deg", "Angle"),
    "swept_steer": Picture(("accelerometer.lateral",), "m/s^2", "Lateral acceleration"),
    "t_handle": Picture(
        tuple(f"handle.omega_{axis}" for axis in "xyz"), "rad/s", "Angular velocity"
    ),
    "testset_wheelset": Picture(("wheelset.lateral",), "mm", "Lateral shift"),
    "tractor_semitrailer": Picture(("tractor.yaw", "trailer.yaw"), "deg", "Yaw, articulation"),
    "tricycle": _path("frame.x", "frame.y", "Rear axle: y"),
    "upright_disk": _path("fork.x", "fork.y", "Disk: y"),
    "wheelset_limit_cycle": Picture(("wheelset.lateral",), "mm", "Lateral shift"),
}
"""What the pictures show, by the name of the scenario."""


def main(names: list[str]) -> int:
    """Draw the pictures of these scenarios, or of all, and write the page."""
    FIGURES.mkdir(exist_ok=True)
    for path in scenarios():
        if not names or path.stem in names:
            sys.stderr.write(f"{path.stem}\n")
            _draw(path)
    PAGE.write_text(page(), encoding="utf-8")
    return 0


def scenarios() -> list[Path]:
    """Return the scenarios in the order of the page."""
    return [*sorted(SCENARIOS.glob("*.yaml")), *sorted(SCENARIOS.glob("systems/*.yaml"))]


def page() -> str:
    """Return the page: a line and a picture each."""
    paths = scenarios()
    vehicles = [_entry(path) for path in paths if path.parent == SCENARIOS]
    systems = [_entry(path) for path in paths if path.parent != SCENARIOS]
    return "\n".join([HEAD, VEHICLES, *vehicles, SYSTEMS, *systems])


def _entry(path: Path) -> str:
    from ruamel.yaml import YAML

    scenario = YAML(typ="safe").load(path.read_text(encoding="utf-8"))
    title = scenario["title"]
    links = f"[scenario](../{path.relative_to(ROOT).as_posix()})"
    if path.parent != SCENARIOS:
        links = f"[system](../systems/{Path(scenario['model']).name}), {links}"
    return f"**{title}** ({links})\n\n![{title}](figures/{path.stem}.png)\n"


def _draw(path: Path) -> None:
    import matplotlib as mpl

    mpl.use("agg")
    from matplotlib.figure import Figure

    from vehicledyn.results.plots.absent_contacts import shown_values
    from vehicledyn.results.plots.plot_description import unit_factor
    from vehicledyn.results.plots.plot_style import PALETTE, STYLE, axis_label
    from vehicledyn.results.store.reader import open_result

    program = Path(sys.executable).parent / "vehicledyn"
    with tempfile.TemporaryDirectory() as folder, mpl.rc_context(STYLE):
        result_file = Path(folder) / "result.h5"
        command = [program, "run", path, "--no-plots", "--quiet", "-o", result_file]
        subprocess.run(command, check=True)
        with open_result(result_file) as result:
            picture = PICTURES.get(path.stem) or _first_coordinates(result)
            figure = Figure(figsize=SIZE, layout="constrained")
            axes = figure.subplots()
            across, unit = result.time, "s"
            if picture.across:
                across, unit = result.channel(picture.across).values, "m"
                if abs(across).max() < _SMALL:
                    across, unit = 1e3 * across, "mm"
            for color, name in zip(PALETTE, picture.channels, strict=False):
                series = result.channel(name)
                values = shown_values(result, name) * unit_factor(series.unit, picture.unit)
                axes.plot(across, values, color=color, label=name)
            axes.set_ylabel(axis_label(picture.label, picture.unit))
            axes.set_xlabel(axis_label(picture.across_label or picture.across or "Time", unit))
            if len(picture.channels) == 1 and picture.across and path.stem not in _STRETCHED:
                axes.set_aspect("equal", adjustable="datalim")
            if len(picture.channels) > 1:
                letters = max(map(len, picture.channels))
                columns = 1 + sum(letters < most for most in _SHORT)
                axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns)
            # Without the version of the drawing library in it, the same picture is the same file.
            target = FIGURES / f"{path.stem}.png"
            figure.savefig(target, dpi=DOTS, metadata={"Software": None})


def _first_coordinates(result: Result) -> Picture:
    """Return the first three channels of one unit that move and have rates."""
    import numpy as np

    names = [n for n in result.channels if f"{n}_rate" in result.channels]
    moving = [n for n in names if np.ptp(result.channel(n).values) > 1e-9]
    unit = result.channel(moving[0]).unit
    alike = [n for n in moving if result.channel(n).unit == unit][:3]
    return Picture(tuple(alike), {"rad": "deg"}.get(unit, unit), "Coordinate")


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
