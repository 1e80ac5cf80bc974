"""The MacPherson axle at the rig against closed geometry, and the car that it carries."""

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import fsolve
from scipy.spatial.transform import Rotation

import vehicledyn as vd

pytestmark = pytest.mark.long

SYSTEMS = Path(__file__).parents[3] / "systems"
AXLE, CAR = (str(SYSTEMS / f"{name}.yaml") for name in ("macpherson_axle", "front_wheel_drive_car"))
FRONT, REAR, BALL = np.array([[20.0, 370, 205], [-320, 400, 215], [5, 690, 200]]) * 1e-3
TOP, BOTTOM = np.array([[-35.0, 565, 880], [-8, 612, 420]]) * 1e-3
INNER, OUTER = np.array([[-120.0, 330, 264], [-130, 680, 260]]) * 1e-3
CENTRE, RADIUS = np.array([0.0, 0.75, 0.344]), 0.344


def length(a, b):
    return np.linalg.norm(np.subtract(a, b))


def wheel(pose):
    """Return contact point, camber and toe of a wheel moved by a shift and a turn vector."""
    turn = Rotation.from_rotvec(pose[3:]).as_matrix()
    spin = turn @ [0.0, 1.0, 0.0]
    forward = np.cross(spin, [0.0, 0.0, 1.0])
    spoke = np.cross(forward / np.linalg.norm(forward), spin)
    contact = turn @ (CENTRE - BALL) + BALL + pose[:3] - RADIUS * spoke
    return contact, np.arcsin(-spin[2]), np.arctan2(spin[0], spin[1])


def closed(pose, travel):
    """Return what the pose leaves open: arm, strut line through its mount, track rod, travel."""
    turn = Rotation.from_rotvec(pose[3:]).as_matrix()

    def moved(point):
        return turn @ (point - BALL) + BALL + pose[:3]

    line, away = turn @ (TOP - BOTTOM), TOP - moved(BOTTOM)
    across = np.cross(line, away)
    return [
        length(moved(BALL), FRONT) - length(BALL, FRONT),
        length(moved(BALL), REAR) - length(BALL, REAR),
        across[0],
        across[1],
        length(moved(OUTER), INNER) - length(OUTER, INNER),
        wheel(pose)[0][2] - travel,
    ]


def test_wheels_travel_as_the_strut_line_the_arm_and_the_track_rod_let_them():
    seen = vd.rig(AXLE, "parallel", "-40 mm:40 mm:2")
    pose = np.zeros(6)
    for k, travel in enumerate((-0.04, 0.0, 0.04)):
        pose = fsolve(closed, np.zeros(6), (travel,), xtol=1e-13)
        assert np.abs(closed(pose, travel)).max() < 1e-12
        contact, camber, toe = wheel(pose)
        found = [seen[f"left_wheel_angles.{n}"][k] for n in ("half_track", "camber", "toe_angle")]
        assert found[0] == pytest.approx(contact[1], abs=1e-6)
        assert found[1] == pytest.approx(camber, abs=1e-6)
        assert found[2] == pytest.approx(toe, abs=1e-6)
        for name in ("half_track", "camber", "toe_angle", "load"):
            sides = [seen[f"{side}_wheel_angles.{name}"][k] for side in ("left", "right")]
            assert sides[0] == pytest.approx(sides[1], rel=1e-9, abs=1e-12)


def test_the_roll_centre_is_that_of_the_planar_construction():
    """Strut, arm and track rod in planes across: the pole is where the arm meets the normal of the
    strut at its mount, and the roll centre on the line from the contact point to it."""
    ball, hinge, top, bottom = (
        np.array(p) for p in ((690, 200), (370, 206), (565, 880), (612, 420))
    )
    along, strut = (hinge - ball), (top - bottom)
    normal = np.array([-strut[1], strut[0]])
    reach = np.linalg.solve(np.column_stack([along, -normal]), top - ball)
    pole = ball + reach[0] * along
    outer = np.array([680.0, 260.0])
    inner = outer + (pole - outer) * (outer[0] - 330.0) / (outer[0] - pole[0])
    places = {
        "arm": {"front": (20, *hinge), "rear": (-320, *hinge), "ball": (0, *ball)},
        "strut": {"top": (0, *top), "bottom": (0, *bottom)},
        "track_rod": {"inner": (-130, *inner), "outer": (-130, *outer)},
        "wheel": {"centre": (0, 750, 344)},
    }
    given = {
        f"{part}.{name}": [f"{value} mm" for value in place]
        for part, points in places.items()
        for name, place in points.items()
    }
    seen = vd.rig(AXLE, "parallel", "0 mm:10 mm:1", set=given)
    wanted = 0.75 * pole[1] / (750.0 - pole[0])
    for side in ("left", "right"):
        found = float(seen[f"{side}_wheel_angles.roll_centre_height"][0])
        assert found == pytest.approx(wanted, abs=1e-6)
        assert float(seen[f"{side}_wheel_angles.toe_gain"][0]) == pytest.approx(0.0, abs=1e-7)


def test_the_car_stands_on_its_wheels():
    """Loads are the weight; the axles share it as the lever of all masses says."""
    found = vd.equilibrium(CAR, backend="interpreted")
    loads = dict(zip(found["force"].values, np.asarray(found["force_equilibrium"]), strict=True))
    front, rear = (
        sum(loads[f"{axle}_axle.wheel_{side}.tyre.normal_force"] for side in ("left", "right"))
        for axle in ("front", "rear")
    )
    at = np.array(
        [(1080.0, 0.0), (2 * 20.0, 1.0), (2 * 3.0, 1.0 - 0.06), (2 * 18.0, 1.0 - 0.005),
         (2 * 12.0, -1.6 + 0.21), (2 * 20.0, -1.6), (3.0, 0.88), (3.0 + 1.0, 0.88 - 0.25)]
    )  # fmt: skip
    weight = 9.81 * at[:, 0].sum()
    assert front + rear == pytest.approx(weight, rel=1e-4)
    share = (at[:, 0] @ at[:, 1] + 1.6 * at[:, 0].sum()) / 2.6
    assert front == pytest.approx(9.81 * share, rel=5e-3)
