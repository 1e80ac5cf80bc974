"""The Iltis: chassis and four corners of A-arm, leaf spring, tie rod, carrier, wheel, shock.

All bodies are aligned with the chassis in the nominal position, where every coordinate but
the height is zero. The leaf spring is massless and hinged about x like the A-arm, so both its
ends move in planes across the car; it is a rod cut with the leaf's vertical stiffness as a
guided link at its outer end. The carrier turns about the line between the two ball joints.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from vehicledyn.multibody.elements.drives import ConstantRate
from vehicledyn.multibody.elements.motion_sensors import Accelerometer, BodySensor, SequenceSensor
from vehicledyn.multibody.elements.point_forces import Attachment, PointForce
from vehicledyn.multibody.model.bodies import Body, Joint, Turn
from vehicledyn.multibody.model.cuts import Cut, RodCut
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.model.parts import Part
from vehicledyn.multibody.model.system import System
from vehicledyn.road.vehicle import Corner, RoadOptions, RoadVehicle
from vehicledyn.road.wheel.road_wheel import RoadWheel
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Mat, Scalar
from vehicledyn.symbolic.parameters import ParameterTable
from vehicledyn.vehicles.iltis_parameters import (
    AArm,
    Axle,
    IltisParameters,
    LeafSpring,
    ShockAbsorber,
)
from vehicledyn.vehicles.leaf_angle import LeafAngle

Point = tuple[Scalar, Scalar, Scalar]
CHASSIS = "chassis"
RACK = "steering.rack"


def build_iltis(parameters: IltisParameters, options: RoadOptions) -> RoadVehicle:
    """Return the vehicle on its road, without steering or drive."""
    table = ParameterTable()
    p = table.add_set("", parameters)
    speed = table.add("speed", options.speed, "m/s", "Forward speed at the start")
    chosen = _with_symbols(options, table)
    corners = [
        _Corner(p, parameters, chosen, speed, is_front=front, is_left=left)
        for front in (True, False)
        for left in (True, False)
    ]
    bodies = [_chassis(p, parameters, options.speed), _rack(p)]
    parts: list[Part] = [
        BodySensor("body", CHASSIS),
        Accelerometer("accelerometer", CHASSIS),
        SequenceSensor("benchmark", CHASSIS, (2, 1, 3)),
    ]
    cuts: list[Cut] = []
    for corner in corners:
        bodies.extend(corner.bodies())
        cuts.extend(corner.cuts())
        parts.extend(corner.parts())
    system = System(
        name="iltis",
        table=table,
        bodies=tuple(bodies),
        cuts=tuple(cuts),
        parts=tuple(parts),
        gravity=(0.0, 0.0, -p.gravity),
    )
    front_x, rear_x = p.front.hardpoints.wheel_centre[0], p.rear.hardpoints.wheel_centre[0]
    return RoadVehicle(
        system=system,
        chassis=CHASSIS,
        rack=RACK,
        steering_gain=p.steering.gain,
        wheelbase=front_x - rear_x,
        front_distance=front_x - p.chassis.centre_of_mass[0],
        outline=_outline(parameters),
        corners=tuple(corner.description for corner in corners),
        free_wheels=options.free_wheels,
        speed=speed,
        surface=options.surface,
    )


def _chassis(p: IltisParameters, numbers: IltisParameters, speed: float) -> Body:
    height = float(numbers.chassis.centre_of_mass[2])
    joints = (
        Joint("T1", "chassis.x", role="independent", start_rate=speed, description="Position x"),
        Joint("T2", "chassis.y", role="independent", description="Position y"),
        Joint("T3", "chassis.z", height, role="independent", description="Height"),
        Joint("R3", "chassis.yaw", role="independent", description="Yaw angle"),
        Joint("R2", "chassis.pitch", role="independent", description="Pitch angle"),
        Joint("R1", "chassis.roll", role="independent", description="Roll angle"),
    )
    c = p.chassis
    return Body(
        CHASSIS,
        GROUND,
        joints=joints,
        mass=c.mass,
        inertia=(c.inertia_roll, c.inertia_pitch, c.inertia_yaw),
    )


def _rack(p: IltisParameters) -> Body:
    joint = Joint("T2", RACK, role="driven", description="Displacement of the steering rack")
    return Body("rack", CHASSIS, joints=(joint,))


def _outline(numbers: IltisParameters) -> tuple[tuple[float, float], ...]:
    o = numbers.outline
    front, rear, side = o.front, o.rear, o.half_width
    return ((front, side), (rear, side), (rear, -side), (front, -side))


@dataclass(frozen=True)
class _Corner:
    """One corner, from symbols ``p`` and the numbers of the same set."""

    p: IltisParameters
    numbers: IltisParameters
    options: RoadOptions
    speed: Scalar
    is_front: bool
    is_left: bool

    @property
    def name(self) -> str:
        return ("f" if self.is_front else "r") + ("l" if self.is_left else "r")

    @property
    def wheel(self) -> str:
        return f"wheel_{self.name}"

    @property
    def description(self) -> Corner:
        axle = self.numbers.front if self.is_front else self.numbers.rear
        spin = f"{self.wheel}.spin_angle"
        return Corner(
            self.wheel, self.wheel, spin, self.is_front, self.is_left, axle.unloaded_radius
        )

    @property
    def axle(self) -> Axle:
        return self.p.front if self.is_front else self.p.rear

    def mirrored(self, point: Point) -> Point:
        """Return a hardpoint of this side."""
        return (point[0], point[1] if self.is_left else -point[1], point[2])

    def on_chassis(self, point: Point) -> Point:
        """Return a nominal point in chassis axes from the centre of mass."""
        return _minus(self.mirrored(point), self.p.chassis.centre_of_mass)

    def from_arm(self, point: Point) -> Point:
        """Return a nominal point in A-arm axes from its inner hinge."""
        return _minus(self.mirrored(point), self.mirrored(self.axle.hardpoints.a_arm_inner))

    def from_ball(self, point: Point) -> Point:
        """Return a nominal point in carrier axes from the lower ball joint."""
        return _minus(self.mirrored(point), self.mirrored(self.axle.hardpoints.a_arm_outer))

    def bodies(self) -> tuple[Body, ...]:
        h = self.axle.hardpoints
        prefix = f"suspension_{self.name}"
        outer = self.from_arm(h.a_arm_outer)
        arm = Body(
            f"a_arm_{self.name}",
            CHASSIS,
            self.on_chassis(h.a_arm_inner),
            (Joint("R1", f"{prefix}.a_arm_angle", description="A-arm angle"),),
            mass=self.p.a_arm.mass,
            com=_towards_origin(outer, self.p.a_arm.centre_of_mass),
            inertia=_arm_inertia(self.p.a_arm, outer),
        )
        kingpin = _frame_along(self.from_ball(h.leaf_outer))
        carrier = Body(
            f"carrier_{self.name}",
            arm.name,
            outer,
            (
                Joint("R1", f"{prefix}.carrier_angle", description="Carrier to A-arm angle"),
                Turn(kingpin),
                Joint("R3", f"{prefix}.steer_angle", description="Angle about the kingpin"),
                Turn(kingpin.T),
            ),
        )
        return arm, carrier, self._wheel_body(carrier.name)

    def _wheel_body(self, carrier: str) -> Body:
        d, w = self.description, self.p.wheel
        role = "independent" if self.options.free_wheels else "driven"
        rate = self.options.speed / d.radius if self.options.free_wheels else 0.0
        return Body(
            self.wheel,
            carrier,
            self.from_ball(self.axle.hardpoints.wheel_centre),
            (Joint("R2", d.spin, role=role, start_rate=rate, description="Spin angle"),),
            mass=w.mass,
            inertia=(w.inertia_across, w.inertia_spin, w.inertia_across),
            spins_about=2,
        )

    def cuts(self) -> tuple[Cut, ...]:
        h = self.axle.hardpoints
        carrier = f"carrier_{self.name}"
        leaf = RodCut(
            f"leaf_{self.name}",
            CHASSIS,
            self.on_chassis(h.leaf_inner),
            carrier,
            self.from_ball(h.leaf_outer),
            _distance(h.leaf_inner, h.leaf_outer),
        )
        inner = self.on_chassis(h.tie_rod_inner)
        tie_rod = RodCut(
            f"tie_rod_{self.name}",
            "rack" if self.is_front else CHASSIS,
            inner,
            carrier,
            self.from_ball(h.tie_rod_outer),
            _distance(h.tie_rod_inner, h.tie_rod_outer) + self.axle.tie_rod_adjustment,
        )
        return leaf, tie_rod

    def parts(self) -> tuple[Part, ...]:
        h, s = self.axle.hardpoints, self.p.leaf_spring
        anchor = self.on_chassis((0.0, 0.0, s.anchor_height))
        carrier = f"carrier_{self.name}"
        leaf_end = Attachment(carrier, self.from_ball(h.leaf_outer))
        spring = PointForce(
            f"leaf_spring_{self.name}",
            Attachment(CHASSIS, anchor),
            leaf_end,
            lambda length, _: leaf_force(s, length),
            direction=(0.0, 0.0, 1.0),
        )
        shock = PointForce(
            f"shock_{self.name}",
            Attachment(CHASSIS, self.on_chassis(h.shock_upper)),
            Attachment(f"a_arm_{self.name}", self.from_arm(h.shock_lower)),
            lambda length, rate: shock_force(self.p.shock_absorber, length, rate),
        )
        angle = LeafAngle(
            f"leaf_spring_{self.name}.joint",
            Attachment(CHASSIS, self.on_chassis(h.leaf_inner)),
            leaf_end,
            is_left=self.is_left,
        )
        return (spring, shock, angle, self._road_wheel(), *self._spin())

    def _road_wheel(self) -> RoadWheel:
        tyre = self.options.front_tyre if self.is_front else self.options.rear_tyre
        return RoadWheel(
            self.wheel,
            body=self.wheel,
            spin=self.description.spin,
            tyre=tyre.mounted("left" if self.is_left else "right"),
            surface=self.options.surface,
            radius=self.axle.unloaded_radius,
            stiffness=self.p.wheel.vertical_stiffness,
            damping=self.p.wheel.vertical_damping,
            contact=self.options.contact,
            relaxation=self.options.relaxation,
        )

    def _spin(self) -> tuple[Part, ...]:
        if self.options.free_wheels:
            return ()
        rate = self.speed / self.axle.unloaded_radius
        return (ConstantRate(f"{self.wheel}.prescribed_spin", self.description.spin, rate),)


def _with_symbols(options: RoadOptions, table: ParameterTable) -> RoadOptions:
    """Return the options with tyres, road and relaxation entered in the table."""
    return replace(
        options,
        front_tyre=table.add_set("tyres.front", options.front_tyre),
        rear_tyre=table.add_set("tyres.rear", options.rear_tyre),
        surface=table.add_set("road", options.surface),
        relaxation=options.relaxation and table.add_set("relaxation", options.relaxation),
    )


def leaf_force(s: LeafSpring, length: Scalar) -> Scalar:
    """Return k (L - L0), and beyond the bump stop k_stop instead of k [N]; tension positive."""
    into_stop = ops.minimum(length - s.stop_length, 0.0)
    return s.stiffness * (length - s.free_length) + (s.stop_stiffness - s.stiffness) * into_stop


_MIDDLE = 7.0 / 16.0
"""Length of a shock absorber within its range of work, a number of few bits [m]."""


def _polynomial(c: tuple[Scalar, Scalar, Scalar, Scalar], length: Scalar) -> Scalar:
    """Return c₀ + c₁ z + c₂ z² + c₃ z³ in powers of z - middle.

    In powers of z terms of some 10⁷ N add up to some 10² N, which loses five digits at each
    evaluation; in powers of the distance from the middle they do not. The middle has so few bits
    that for coefficients of up to ten digits the new ones are exact.
    """
    middle = _MIDDLE
    near_square = c[2] + middle * c[3]
    near_linear = c[1] + middle * near_square
    square = near_square + middle * c[3]
    u = length - middle
    constant = c[0] + middle * near_linear
    linear = near_linear + middle * square
    return constant + u * (linear + u * (square + middle * c[3] + u * c[3]))


def shock_force(s: ShockAbsorber, length: Scalar, rate: Scalar) -> Scalar:
    """Return the polynomial spring force plus the damper force of three branches [N]."""
    v = rate
    spring = _polynomial((s.spring_c0, s.spring_c1, s.spring_c2, s.spring_c3), length)
    middle = v * (s.damping_c1 + v * (s.damping_c2 + v * (s.damping_c3 + v * s.damping_c4)))
    compression = s.compression_force + s.compression_slope * v
    rebound = s.rebound_force + s.rebound_slope * v
    damper = ops.where(
        v < s.compression_limit, compression, ops.where(v > s.rebound_limit, rebound, middle)
    )
    return spring + damper


def _arm_inertia(arm: AArm, outer: Point) -> tuple[Scalar, ...]:
    """Return the A-arm's inertia in chassis axes from that along and across the arm."""
    along = ops.vector(0.0, outer[1], outer[2])
    c, s = (component / ops.norm(along) for component in (outer[1], outer[2]))
    a, n = arm.inertia_along, arm.inertia_across
    return (arm.inertia_x, a * c * c + n * s * s, a * s * s + n * c * c, 0.0, 0.0, (a - n) * c * s)


def _frame_along(axis: Point) -> Mat:
    """Return the fixed rotation whose third axis lies along ``axis``, first axis nearest x."""
    third = ops.unit(ops.vector(*axis))
    second = ops.unit(ops.cross(third, rotations.axis_vector(1)))
    first = ops.cross(second, third)
    return rotations.columns(first, second, third)


def _minus(a: Point, b: Point) -> Point:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def _towards_origin(point: Point, distance: Scalar) -> Point:
    """Return the point that lies a distance nearer to the origin."""
    part = 1.0 - distance / ops.norm(ops.vector(*point))
    return (part * point[0], part * point[1], part * point[2])


def _distance(a: Point, b: Point) -> Scalar:
    return ops.norm(ops.vector(*_minus(a, b)))
