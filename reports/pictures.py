"""The figures of the report: reference and computed above, their difference below."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from reference_cases import histories, kinematics, modes, slalom
from reference_cases.motions import drive
from reference_cases.tables import read_figures

from vehicledyn.results.plots.plot_style import BLUE, PALETTE, STYLE, VERMILION, WIDTH, axis_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CAPTIONS = {
    "ramp": "Ramp steer at 20 m/s: reference (dashed) and computed, and their difference.",
    "sine": "Sine steer of 2 mm at 20 m/s: reference (dashed) and computed, and their difference.",
    "bump": "Bump of all wheels at 5 m/s: reference (dashed) and computed, and their difference.",
    "kinematics": "Front left wheel over its travel, for three displacements of the rack.",
    "eigenvalues": "Eigenvalues over speed; zeros and decay faster than 60 1/s left out.",
    "slalom": "Slalom: path, ground swept by the body, cones (y enlarged); lateral acceleration.",
}
PANELS = {
    "ramp": (("y", "Lateral position"), ("yaw", "Yaw"), ("Fz_FL", "Right front wheel load")),
    "sine": (("y", "Lateral position"), ("yaw", "Yaw"), ("Fz_FL", "Right front wheel load")),
    "bump": (("z", "Height"), ("pitch", "Pitch"), ("Fz_FL", "Right front wheel load")),
}
UNITS = {"y": "m", "z": "m", "yaw": "rad", "pitch": "rad", "Fz_FL": "N"}
SPEEDS = tuple(float(v) for v in range(2, 42, 2))


def draw_all(folder: Path) -> None:
    """Draw every figure as PNG into a folder."""
    import matplotlib as mpl

    mpl.use("agg")
    folder.mkdir(exist_ok=True)
    with mpl.rc_context(STYLE):
        for name in PANELS:
            _save(_history(name), folder, name)
        _save(_kinematics(), folder, "kinematics")
        _save(_eigenvalues(), folder, "eigenvalues")
        _save(_slalom(), folder, "slalom")


def _save(figure: Figure, folder: Path, name: str) -> None:
    # Without the version of the drawing library in it, the same picture is the same file.
    figure.savefig(folder / f"{name}.png", metadata={"Software": None})


def _axes(n_rows: int, n_columns: int, height: float, **options: Any) -> tuple[Figure, Any]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    return figure, figure.subplots(n_rows, n_columns, squeeze=False, **options)


def _history(name: str) -> Figure:
    reference, computed, time = histories.both(name)
    panels = PANELS[name]
    figure, axes = _axes(2, len(panels), 3.8, sharex=True, height_ratios=(2, 1))
    for column, (key, words) in enumerate(panels):
        above, below = axes[:, column]
        above.plot(time, computed[key], color=BLUE, label="computed")
        above.plot(time, reference[key], "--", color=VERMILION, label="reference")
        below.plot(time, computed[key] - reference[key], color="black", linewidth=0.9)
        above.set_ylabel(axis_label(words, UNITS[key]))
        below.set_ylabel(axis_label("Difference", UNITS[key]))
        below.set_xlabel(axis_label("Time", "s"))
        below.ticklabel_format(axis="y", scilimits=(-2, 2))
    axes[0, 0].legend()
    return figure


def _kinematics() -> Figure:
    reference, computed = kinematics.both()
    panels = {"toe_deg": "Toe angle", "axis_incl_deg": "Inclination of axis"}
    figure, axes = _axes(2, 2, 4.2, sharex=True, height_ratios=(2, 1))
    for column, (key, words) in enumerate(panels.items()):
        above, below = axes[:, column]
        for color, rack in zip(PALETTE, np.unique(reference["rack_mm"]), strict=False):
            chosen = reference["rack_mm"] == rack
            travel, known = computed["dz_mm"][chosen], reference[key][chosen]
            above.plot(travel, computed[key][chosen], color=color, label=f"rack {rack:g} mm")
            above.plot(travel[::4], known[::4], "o", color=color, markersize=3, fillstyle="none")
            below.plot(travel, computed[key][chosen] - known, ".", color=color, markersize=3)
        above.set_ylabel(axis_label(words, "deg"))
        below.set_ylabel(axis_label("Difference", "deg"))
        below.set_xlabel(axis_label("Vertical travel of the wheel", "mm"))
        below.ticklabel_format(axis="y", scilimits=(-2, 2))
    axes[0, 0].legend(title="circles: reference")
    return figure


def _eigenvalues() -> Figure:
    figure, axes = _axes(1, 2, 3.6)
    damping, frequency = axes[0]
    entries = modes.modes(SPEEDS)
    for entry in entries:
        values = [m.eigenvalue for m in entry.modes if abs(m.eigenvalue) > modes.SMALL]
        damping.plot([entry.speed] * len(values), [v.real for v in values], ".", color=BLUE)
        turning = [v.imag / (2.0 * np.pi) for v in values if v.imag > 0.0]
        frequency.plot([entry.speed] * len(turning), turning, ".", color=BLUE)
    damping.axhline(0.0, color="black", linewidth=0.8)
    damping.set_ylim(-60.0, 3.0)
    damping.set_ylabel(axis_label("Real part", "1/s"))
    frequency.set_ylabel(axis_label("Damped frequency", "Hz"))
    for axis in (damping, frequency):
        axis.set_xlabel(axis_label("Speed", "m/s"))
    return figure


def _slalom() -> Figure:
    from matplotlib.patches import Circle

    run = drive("iltis_slalom")
    figure, axes = _axes(2, 1, 3.8, sharex=True)
    path, acceleration = axes[:, 0]
    _outline(path, run)
    path.plot(run["chassis.x"], run["chassis.y"], color=BLUE)
    for cone in slalom.CONES:
        path.add_patch(Circle((cone, 0.0), slalom.RADIUS, color=VERMILION))
    path.set_ylabel(axis_label("Position y", "m"))
    acceleration.plot(run["chassis.x"], run["accelerometer.lateral"], color=BLUE)
    acceleration.set_ylabel(axis_label("Lateral acceleration", "m/s^2"))
    acceleration.set_xlabel(axis_label("Position x", "m"))
    return figure


def _outline(axis: Axes, run: Any) -> None:
    """Shade the ground that the body sweeps."""
    body = read_figures("iltis_outline.yaml")
    side = body["half_width"]
    corners = np.array([[body[end], s] for end in ("front", "rear") for s in (side, -side)])
    x, y, yaw = (run[f"chassis.{name}"][::10] for name in ("x", "y", "yaw"))
    for k in range(len(x)):
        turn = np.array([[np.cos(yaw[k]), -np.sin(yaw[k])], [np.sin(yaw[k]), np.cos(yaw[k])]])
        shape = corners[[0, 1, 3, 2]] @ turn.T + [x[k], y[k]]
        axis.fill(shape[:, 0], shape[:, 1], color="0.85", linewidth=0.0)
