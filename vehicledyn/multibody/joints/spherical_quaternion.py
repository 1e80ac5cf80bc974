"""A ball joint whose attitude is a unit quaternion: no attitude is singular."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vehicledyn.base.registry import register
from vehicledyn.multibody.joints.joint_type import Axes, Element, JointType, choice
from vehicledyn.symbolic import rotations
from vehicledyn.symbolic.ops import Mat, Scalar

NORM_RATE = 1.0
"""Rate at which the norm of a quaternion goes back to one [1/s]."""

_QUATERNION = 4
_COMPONENTS = "wxyz"


@register("joint_type", "spherical_quaternion")
@dataclass(frozen=True)
class SphericalQuaternion(JointType):
    """Ball joint with four components Q = (w, v) of a unit quaternion as positions.

    Its speeds are the components of the relative angular velocity ω in the axes beyond the joint,
    Q̇ = ½ Q ∘ (0, ω) + k (1 - |Q|²) Q. The last term is zero for a unit quaternion and brings
    rounding and integration errors of the norm back; R depends on Q / |Q| alone, so that it is a
    rotation and turns with ω whatever the norm.
    """

    elements = (
        *(Element(f"quaternion_{c}", "1", f"component {c} of the quaternion") for c in _COMPONENTS),
        *(Element(f"omega_{c}", "rad/s", f"angular velocity about {c}") for c in "xyz"),
    )
    positions = _QUATERNION
    start = (1.0, 0.0, 0.0, 0.0)

    element: int = choice("Number of the coordinate in the joint, from 0")

    @property
    def turns_otherwise(self) -> bool:
        """Whether this coordinate is the first one that turns."""
        return self.element == _QUATERNION

    def rotation(self, q: Sequence[Scalar]) -> Mat:
        """Return R of the quaternion, (w² - v·v) 1 + 2 v vᵀ + 2 w tilde(v), over |Q|²."""
        w, x, y, z = (q[k] for k in range(_QUATERNION))
        scale = 2.0 / (w * w + x * x + y * y + z * z)
        sx, sy, sz = scale * x, scale * y, scale * z
        wx, wy, wz = w * sx, w * sy, w * sz
        xx, xy, xz = x * sx, x * sy, x * sz
        yy, yz, zz = y * sy, y * sz, z * sz
        return rotations.matrix(
            [
                [1.0 - (yy + zz), xy - wz, xz + wy],
                [xy + wz, 1.0 - (xx + zz), yz - wx],
                [xz - wy, yz + wx, 1.0 - (xx + yy)],
            ]
        )

    def motion(self, q: Scalar) -> Axes:
        """Return the axis of a component of the angular velocity."""
        return Axes(angular=rotations.axis_vector(self.element - _QUATERNION + 1))

    @classmethod
    def rates(cls, positions: Sequence[Scalar], speeds: Sequence[Scalar]) -> list[Scalar]:
        """Return Q̇."""
        w, x, y, z = positions
        a, b, c = (0.5 * speed for speed in speeds)
        back = NORM_RATE * (1.0 - (w * w + x * x + y * y + z * z))
        return [
            back * w - x * a - y * b - z * c,
            back * x + w * a + y * c - z * b,
            back * y + w * b + z * a - x * c,
            back * z + w * c + x * b - y * a,
        ]

    @classmethod
    def start_problem(cls, positions: Sequence[float]) -> str:
        """Refuse a quaternion of no length."""
        size = sum(value * value for value in positions)
        if 0.0 < size < float("inf"):
            return ""
        return "its quaternion has no length; start from [1, 0, 0, 0] for no rotation"

    def is_turned_by_mirror(self, axis: int) -> bool:
        """Return whether a component is about an axis in the mirror's plane."""
        about = (0, 1, 2, 3, 1, 2, 3)[self.element]
        return about not in (0, axis)
