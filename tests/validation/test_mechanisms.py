"""Published mechanisms with loops: Andrews' squeezing mechanism and the car axis."""

from dataclasses import dataclass
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from vehicledyn.analyses.simulation.partitions.repartitioning import simulate_monitored
from vehicledyn.base.registry import find
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import (
    GROUND,
    Attachment,
    BallCut,
    BasePart,
    Body,
    Joint,
    Loads,
    ParameterTable,
    PointForce,
    RodCut,
    System,
    TimeLaw,
    UserConstraint,
    derive,
)
from vehicledyn.symbolic import ops

DATA = Path(__file__).parent / "data"

pytestmark = pytest.mark.validation


def read(name):
    return YAML(typ="safe").load((DATA / f"{name}.yaml").read_text(encoding="utf-8"))


def end_of(system, duration, tolerance=1e-13):
    """Channels at the end of a run, by name."""
    equations = derive(system)
    found = []
    simulate_monitored(
        system,
        compile_kernel(equations, backend="interpreted"),
        find("solver", "dop853")(relative_tolerance=tolerance, absolute_tolerance=tolerance),
        start=0.0,
        stop=duration,
        state=[s.start for s in equations.states],
        unknowns=[u.start for u in equations.unknowns],
        interval=duration / 60.0,
        sink=lambda t, x, z, y: found.append((t[-1], y[-1])),
        progress=lambda what, part: None,
        happened=lambda name, time: None,
    )
    assert found[-1][0] == pytest.approx(duration)
    return dict(zip((c.name for c in equations.channels), found[-1][1], strict=True))


@dataclass(frozen=True)
class Torque(BasePart):
    size: float

    def loads(self, situation):
        return Loads(joint_forces={"beta": self.size})


def andrews(case):
    n, start = case["lengths"], dict(zip(case["names"], case["start"], strict=True))
    solids = [{"mass": m, "inertia": (i, i, i)} for m, i in zip(case["m"], case["I"], strict=True)]

    def body(number, parent, at, angle, com):
        joint = Joint("R3", angle, start[angle], "independent" if angle == "beta" else "auto")
        place = (*at, 0.0)
        return Body(f"K{number}", parent, place, (joint,), com=(*com, 0.0), **solids[number - 1])

    at_a, at_b = (n["xa"], n["ya"]), (n["xb"], n["yb"])
    bodies = (
        body(1, GROUND, (0.0, 0.0), "beta", (n["ra"], 0.0)),
        body(2, "K1", (n["rr"], 0.0), "theta", (-n["da"], 0.0)),
        body(3, GROUND, at_b, "gamma", (n["sa"], n["sb"])),
        body(5, GROUND, at_a, "delta", (n["ta"], n["tb"])),
        body(4, "K5", (n["zt"], 0.0), "phi", (0.0, n["ea"] - n["e"])),
        body(7, GROUND, at_a, "epsilon", (n["ua"], n["ub"])),
        body(6, "K7", (0.0, -n["u"]), "omega", (n["zf"] - n["fa"], 0.0)),
    )
    tips = {"K3": (0.0, -n["ss"], 0.0), "K4": (0.0, -n["e"], 0.0), "K6": (n["zf"], 0.0, 0.0)}
    cuts = tuple(
        BallCut(f"E{k}", "K2", (-n["d"], 0.0, 0.0), name, tip)
        for k, (name, tip) in enumerate(tips.items())
    )
    spring = PointForce(
        "spring",
        Attachment(GROUND, (n["xc"], n["yc"], 0.0)),
        Attachment("K3", (n["sd"], -n["sc"], 0.0)),
        lambda length, rate: case["stiffness"] * (length - n["l0"]),
    )
    parts = (spring, Torque("motor", case["torque"]))
    return System("andrews", ParameterTable(), bodies, cuts, parts, (0.0, 0.0, 0.0))


def test_andrews_mechanism():
    case = read("andrews")
    found = end_of(andrews(case), case["time"]["value"])
    for name, value in zip(case["names"], case["end"], strict=True):
        assert found[name] == pytest.approx(value, rel=1e-9), name


def car_axis(p):
    mass = 0.5 * p["eps"] ** 2 * p["M"]

    def lift(time):
        return p["r"] * ops.sin(p["w"] * time)

    def wheel(name, x, rate):
        joints = (Joint("T1", f"{name}.x", x, start_rate=rate), Joint("T2", f"{name}.y", p["L0"]))
        return Body(name, GROUND, joints=joints, mass=mass)

    base = Body(
        "base",
        GROUND,
        joints=(Joint("T1", "base.x", role="driven"), Joint("T2", "base.y", role="driven")),
    )

    def across(geometry):
        left, base = geometry.position("left"), geometry.position("base")
        return left[0] * base[0] + left[1] * base[1]

    origin = (0.0, 0.0, 0.0)
    springs = tuple(
        PointForce(
            f"spring_{name}",
            Attachment(to, origin),
            Attachment(name, origin),
            lambda z, v: z - p["L0"],
        )
        for name, to in (("left", GROUND), ("right", "base"))
    )
    drives = (
        TimeLaw("x", "base.x", lambda t: ops.sqrt(p["L"] ** 2 - lift(t) ** 2)),
        TimeLaw("y", "base.y", lift),
    )
    return System(
        "car axis",
        ParameterTable(),
        (wheel("left", 0.0, -0.5), wheel("right", 1.0, -0.5), base),
        (RodCut("axis", "left", origin, "right", origin, p["L"]),),
        (*springs, *drives),
        (0.0, -1.0, 0.0),
        constraints=(UserConstraint("guide", across, "m^2", "N/m"),),
    )


def test_car_axis():
    case = read("car_axis")
    found = end_of(car_axis(case["parameters"]), case["time"]["value"])
    names = ("left.x", "left.y", "right.x", "right.y")
    for name, q, v in zip(names, case["positions"], case["velocities"], strict=True):
        assert found[name] == pytest.approx(q, rel=1e-8), name
        assert found[f"{name}_rate"] == pytest.approx(v, rel=1e-8), name
