"""What the small result files of these tests hold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vehicledyn.results.store.layout import ResultHeader, SceneItem


@dataclass(frozen=True)
class Quantity:
    name: str
    unit: str
    description: str = "Some quantity"
    frame: str = "ground"


def slalom_values(count=221):
    """A made-up slalom: units and values of channels by name, and the time."""
    time = np.linspace(0.0, 22.0, count)
    x = 10.0 * time
    y = 1.5 * np.sin(np.pi * (x - 20.0) / 18.0)
    values = {
        "chassis.x": ("m", x),
        "chassis.y": ("m", y),
        "chassis.yaw": ("rad", np.gradient(y, x)),
        "chassis.roll": ("rad", 0.02 * y),
        "wheel_fl.tyre.normal_force": ("N", 3800.0 - 900.0 * y),
        "wheel_fr.tyre.normal_force": ("N", 3800.0 + 900.0 * y),
    }
    return time, values


PLOTS = [
    {
        "name": "path",
        "kind": "path",
        "title": "Path",
        "x": "chassis.x",
        "y": "chassis.y",
        "heading": "chassis.yaw",
        "cones": True,
    },
    {
        "name": "loads",
        "kind": "time",
        "title": "Wheel loads",
        "panels": [
            {
                "label": "Normal force",
                "unit": "kN",
                "channels": ["wheel_fl.tyre.normal_force", "wheel_fr.tyre.normal_force"],
                "labels": ["front left", "front right"],
            },
            {"label": "Roll angle", "unit": "deg", "channels": ["chassis.roll"]},
        ],
    },
]
SCENE = {
    "cones": SceneItem([[20.0 + 18.0 * k, 0.0] for k in range(9)], "m", "Cones", {"radius": 0.15}),
    "outline": SceneItem([[2, 0.8], [-2, 0.8], [-2, -0.8], [2, -0.8]], "m", "Body outline"),
}


def header(**changes):
    known = {
        "title": "Nine cones",
        "model": "iltis",
        "model_hash": "0123456789abcdef",
        "scenario_text": "title: Nine cones  # µ\n",
        "configuration": {"model": "iltis", "speed": 10.0},
        "plots": PLOTS,
        "scene": SCENE,
    }
    return ResultHeader(**{**known, **changes})
