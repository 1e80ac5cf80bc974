"""Cams that several tests share."""

from pathlib import Path

import numpy as np

from vehicledyn.cams.cam import Cam
from vehicledyn.cams.cam_file import CamFile  # noqa: F401  (enters the catalogues)

TURN = 2.0 * np.pi


def rise_and_fall(kind, rise, name="lift", angles=(120, 60, 100)):
    """Return the laws of a rise, a dwell, a fall and a dwell; angles in degrees."""
    up, rest, down = angles
    last = 360 - up - rest - down
    laws = [
        {"kind": kind, "over": f"{up} deg", name: rise},
        {"kind": "dwell", "over": f"{rest} deg"},
        {"kind": kind, "over": f"{down} deg", name: f"-{rise}"},
        {"kind": "dwell", "over": f"{last} deg"},
    ]
    return [law for law in laws if law["over"] != "0 deg"]


def cam(**fields):
    """Return a cam of these fields."""
    return Cam.model_validate(fields).beside(Path())
