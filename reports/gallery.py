"""Write docs/gallery.md and its pictures: ``python reports/gallery.py [NAME ...]``.

Each scenario of scenarios/systems is run; what its picture shows stands in PICTURES, else its
first coordinates. With names only these are drawn anew.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vehicledyn.results.reader import Result

ROOT = Path(__file__).resolve().parents[1]
SCENARIOS = ROOT / "scenarios" / "systems"
PAGE = ROOT / "docs" / "gallery.md"
FIGURES = ROOT / "docs" / "figures"
SIZE, DOTS = (4.2, 2.5), 100
HEAD = """# Gallery of systems

Every system of [systems](../systems), run by its scenario in
[scenarios/systems](../scenarios/systems). `python reports/gallery.py` makes page and pictures.
"""


@dataclass(frozen=True)
class Picture:
    """Channels over time, or over the first one (``across``); a path is true to scale."""

    channels: tuple[str, ...]
    unit: str
    label: str
    across: str = ""


def _path(x: str, y: str, label: str = "Place") -> Picture:
    return Picture((y,), "m", label, x)


PICTURES = {
    "ball_in_tube": _path("ball.x", "ball.y", "Ball, seen from above: y"),
    "ball_in_tube_dependent": Picture(("tube.multiplier",), "N", "Force of the tube's wall"),
    "bicycle": Picture(("frame.roll", "fork.steer"), "deg", "Angle"),
    "curving_wheelset": Picture(("wheelset.lateral",), "mm", "Lateral shift"),
    "double_pendulum": _path("tip.x", "tip.z", "Tip: z"),
    "double_spring_mass": Picture(("upper.height", "lower.height"), "mm", "Height"),
    "four_bar": Picture(("crank.angle", "rocker.angle"), "deg", "Angle"),
    "four_bar_chain": Picture(("upright_0.angle",), "deg", "Angle of the uprights"),
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
    "slider_crank_two_angles": Picture(("guide.multiplier",), "N", "Normal force of the guide"),
    "small_car": Picture(("chassis.y",), "m", "Place y", "chassis.x"),
    "small_cart": Picture(("cart.x", "mass.x"), "m", "Cart and pendulum: x"),
    "small_cart_2": Picture(("load.slide",), "mm", "Load against the cart"),
    "testset_wheelset": Picture(("wheelset.lateral",), "mm", "Lateral shift"),
    "tricycle": _path("frame.x", "frame.y", "Rear axle: y"),
    "upright_disk": _path("fork.x", "fork.y", "Disk: y"),
}
"""What the pictures show, by the name of the scenario."""


def main(names: list[str]) -> int:
    """Draw the pictures of these scenarios, or of all, and write the page."""
    FIGURES.mkdir(exist_ok=True)
    paths = sorted(SCENARIOS.glob("*.yaml"))
    for path in paths:
        if not names or path.stem in names:
            sys.stderr.write(f"{path.stem}\n")
            _draw(path)
    PAGE.write_text(page(paths), encoding="utf-8")
    return 0


def page(paths: list[Path]) -> str:
    """Return the page: a line and a picture each."""
    entries = [_entry(path) for path in paths]
    return "\n".join([HEAD, *entries])


def _entry(path: Path) -> str:
    from ruamel.yaml import YAML

    title = YAML(typ="safe").load(path.read_text(encoding="utf-8"))["title"]
    links = f"[system](../systems/{path.name}), [scenario](../scenarios/systems/{path.name})"
    return f"**{title}** ({links})\n\n![{title}](figures/{path.stem}.png)\n"


def _draw(path: Path) -> None:
    import matplotlib as mpl

    mpl.use("agg")
    from matplotlib.figure import Figure

    from vehicledyn.results.plot_description import unit_factor
    from vehicledyn.results.plot_style import PALETTE, STYLE, axis_label
    from vehicledyn.results.reader import open_result

    program = Path(sys.executable).parent / "vehicledyn"
    with tempfile.TemporaryDirectory() as folder, mpl.rc_context(STYLE):
        result_file = Path(folder) / "result.h5"
        command = [program, "run", path, "--no-plots", "--quiet", "-o", result_file]
        subprocess.run(command, check=True)
        with open_result(result_file) as result:
            picture = PICTURES.get(path.stem) or _first_coordinates(result)
            figure = Figure(figsize=SIZE, layout="constrained")
            axes = figure.subplots()
            across = result.channel(picture.across).values if picture.across else result.time
            for color, name in zip(PALETTE, picture.channels, strict=False):
                series = result.channel(name)
                values = series.values * unit_factor(series.unit, picture.unit)
                axes.plot(across, values, color=color, label=name)
            axes.set_ylabel(axis_label(picture.label, picture.unit))
            unit = "m" if picture.across else "s"
            axes.set_xlabel(axis_label(picture.across or "Time", unit))
            if len(picture.channels) == 1 and picture.across and path.stem != "small_car":
                axes.set_aspect("equal", adjustable="datalim")
            if len(picture.channels) > 1:
                axes.legend()
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
