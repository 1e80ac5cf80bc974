"""Steered suspensions against rigid points at fixed distances, solved by a few lines of their own.

The carrier's points keep their distances to each other and to the ends of the rods on the body;
the strut's axis passes through its mount.
"""

import numpy as np
import pytest
from reference_cases.suspensions import swept
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

pytestmark = pytest.mark.validation

WISHBONE = {"front": (250, 400, 200), "rear": (-250, 450, 200), "ball": (0, 900, 200)}
UPPER = {"front": (225, 350, 500), "rear": (-275, 350, 500), "ball": (-25, 750, 500)}
ROD = ((50, 200, 250), (150, 800, 275))
WHEEL = ((-20, 950, 313.426), (-20, 800, 308.426))
TOP = np.array((-40.0, 700.0, 850.0))
# Ends on the body and on the carrier, the track rod first; wheel centre and inner axle point.
CORNERS = {
    "five_link": (
        [
            ((-137.5, 502.5, 199), (-85.5, 816, 195)),
            ((110, 468.5, 460), (8.5, 729.5, 451.5)),
            ((-146, 465, 439.5), (-31.5, 726, 448.5)),
            ((232, 467.5, 178.5), (39.5, 782.5, 197)),
            ((-56, 439, 204), (1, 789.5, 200.5)),
        ],
        ((0, 875, 316), (0, 725, 316)),
    ),
    "double_wishbone": (
        [ROD, *((arm[leg], arm["ball"]) for arm in (WISHBONE, UPPER) for leg in ("front", "rear"))],
        WHEEL,
    ),
    "macpherson": (
        [ROD, *((WISHBONE[leg], WISHBONE["ball"]) for leg in ("front", "rear"))],
        WHEEL,
    ),
}


def angles(name, height, rack):
    """Steer angle and camber as seen from the front [rad], lengths in mm."""
    rods, (centre, inner) = CORNERS[name]
    centre, inner = np.array(centre, float), np.array(inner, float)
    ball = np.array(WISHBONE["ball"], float)
    along = TOP - ball

    def placed(pose, point):
        return centre + pose[:3] + Rotation.from_rotvec(pose[3:]).apply(np.array(point) - centre)

    def gaps(pose):
        found = [placed(pose, centre)[2] - height]
        for number, (a, b) in enumerate(rods):
            moved = np.array(a, float) + (np.array((0.0, rack, 0.0)) if number == 0 else 0.0)
            length = np.linalg.norm(np.subtract(b, a))
            found.append(np.linalg.norm(placed(pose, b) - moved) - length)
        if name == "macpherson":
            axis = Rotation.from_rotvec(pose[3:]).apply(along / np.linalg.norm(along))
            found += list(np.cross(axis, TOP - placed(pose, ball)))
        return np.array(found)

    solved = least_squares(
        gaps, np.zeros(6), xtol=1e-15, ftol=1e-15, gtol=1e-15, x_scale=[100] * 3 + [1] * 3
    )
    assert np.abs(solved.fun).max() < 1e-8
    out = placed(solved.x, centre) - placed(solved.x, inner)
    return np.arctan2(-out[0], out[1]), -np.arctan2(out[2], out[1])


@pytest.mark.parametrize("name", CORNERS)
def test_steered_and_lifted(name):
    design = CORNERS[name][1][0][2]
    heights, racks = np.linspace(design - 60.0, design + 60.0, 3), np.linspace(-40.0, 40.0, 5)
    drives = {
        "wheel.z": f"{heights[0]} mm:{heights[-1]} mm:2",
        "rack.displacement": f"{racks[0]} mm:{racks[-1]} mm:4",
    }
    found = swept(name, drives)
    wanted = np.array([angles(name, height, rack) for height in heights for rack in racks])
    assert found["wheel.steer_angle"] == pytest.approx(wanted[:, 0], abs=1e-9)
    assert found["wheel.camber"] == pytest.approx(wanted[:, 1], abs=1e-9)
    assert np.ptp(wanted[:, 0]) > 0.4
