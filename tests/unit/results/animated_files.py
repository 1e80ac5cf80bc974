"""A small animated result: a car that drives a circle on four bodies, with forces and cones."""

from __future__ import annotations

import numpy as np

from vehicledyn.results.store.animation_section import Pictures
from vehicledyn.results.store.animation_stage import Stage
from vehicledyn.results.store.layout import ResultHeader, SceneItem
from vehicledyn.results.store.writer import ResultWriter

RADIUS, SPEED, DURATION, WHEEL = 20.0, 10.0, 4.0, 0.3
PLOTS = [
    {
        "name": "forces",
        "kind": "time",
        "title": "Forces",
        "panels": [
            {"label": "Load", "unit": "kN", "channels": ["wheel.load"]},
            {"label": "Angle", "unit": "deg", "channels": ["car.yaw"]},
        ],
    }
]
SHAPES = [
    {
        "kind": "hull",
        "name": "car",
        "body": "car",
        "outline": [[2.0, 0.8], [-1.6, 0.8], [-1.6, -0.8], [2.0, -0.8]],
        "bottom": 0.3,
        "top": 0.9,
    },
    {
        "kind": "wheel",
        "name": "wheel",
        "at": {"body": "wheel", "point": [0.0, 0.0, 0.0]},
        "axis": [0.0, 1.0, 0.0],
        "radius": WHEEL,
        "width": 0.2,
        "style": "tyre",
    },
    {
        "kind": "coil",
        "name": "spring",
        "a": {"body": "car", "point": [1.2, 0.7, 1.2]},
        "b": {"body": "wheel", "point": [0.0, 0.0, 0.0]},
        "radius": 0.06,
        "direction": None,
    },
    {
        "kind": "box",
        "name": "load",
        "at": {"body": "car", "point": [-0.8, 0.0, 0.7]},
        "size": [0.6, 0.8, 0.4],
        "rotation": None,
        "style": "body",
    },
    {
        "kind": "ball",
        "name": "mark",
        "at": {"body": "ground", "point": [0.0, 4.0, 0.5]},
        "radius": 0.5,
        "style": "joint",
    },
    {
        "kind": "tube",
        "name": "rope",
        "a": {"body": "ground", "point": [0.0, 4.0, 0.5]},
        "b": {"body": "car", "point": [0.0, 0.0, 0.5]},
        "radius": 0.02,
        "style": "rod",
    },
    {"kind": "plane", "name": "ground", "point": [0.0, 0.0, 0.0], "normal": [0.0, 0.0, 1.0]},
    {
        "kind": "force",
        "name": "wheel.tyre",
        "at": ["wheel.x", "wheel.y", "wheel.z"],
        "components": [None, "wheel.side", "wheel.load"],
        "axes": "contact",
        "body": "wheel",
        "camber": "wheel.camber",
    },
]
BODIES = [
    {"name": "car", "axis": 0, "axes_spin": True},
    {"name": "wheel", "axis": 2, "axes_spin": False},
]


class Quantity:
    def __init__(self, name, unit):
        self.name, self.unit, self.description, self.frame = name, unit, "Some quantity", ""


def motion(time):
    """Poses and channels at some times."""
    yaw = SPEED / RADIUS * time
    car = np.column_stack([RADIUS * np.sin(yaw), RADIUS * (1 - np.cos(yaw)), 0.0 * time])
    ahead = np.column_stack([np.cos(yaw), np.sin(yaw), 0.0 * time])
    left = np.column_stack([-np.sin(yaw), np.cos(yaw), 0.0 * time])
    wheel = car + 1.2 * ahead + 0.7 * left + [0.0, 0.0, WHEEL]
    turned = np.column_stack([np.cos(yaw / 2), 0.0 * yaw, 0.0 * yaw, np.sin(yaw / 2)])
    pictures = Pictures(
        time,
        np.stack([car, wheel], axis=1),
        np.stack([turned, turned], axis=1),
        np.column_stack([0.0 * time, SPEED / WHEEL * time]),
    )
    channels = {
        "car.yaw": ("rad", yaw),
        "wheel.x": ("m", wheel[:, 0]),
        "wheel.y": ("m", wheel[:, 1]),
        "wheel.z": ("m", 0.0 * time),
        "wheel.load": ("N", 4000.0 + 500.0 * np.sin(3.0 * time)),
        "wheel.side": ("N", 1500.0 * np.cos(time)),
        "wheel.camber": ("rad", 0.0 * time),
    }
    return pictures, channels


def write_car(
    path, *, title="A car drives a circle", close=True, spoil=None, count=401, stage=None,
    plots=PLOTS,
):  # fmt: skip
    """Write the result; ``spoil`` changes the pictures, ``close`` False leaves it broken off."""
    time = np.linspace(0.0, DURATION, count)
    pictures, channels = motion(time)
    if spoil is not None:
        pictures = spoil(pictures)
    cones = SceneItem([[5.0, -3.0], [10.0, 6.0]], "m", "Feet of the cones", {"radius": 0.15})
    writer = ResultWriter(
        path,
        channels=[Quantity(name, unit) for name, (unit, _) in channels.items()],
        header=ResultHeader(title=title, model="car", plots=plots, scene={"cones": cones}),
        stage=stage or Stage(BODIES, SHAPES),
        expected_samples=count,
    )
    writer.append_pictures(pictures)
    writer.append(time, np.column_stack([values for _, values in channels.values()]))
    if close:
        writer.close()
    return writer
