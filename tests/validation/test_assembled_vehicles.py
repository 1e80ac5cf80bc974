"""Vehicles put together from files move as the same vehicles written in one file."""

import re
from pathlib import Path

import numpy as np
import pytest

from vehicledyn.analyse.equilibrium import assemble
from vehicledyn.files.building.construct import build_system
from vehicledyn.files.system.read import read_system
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import derive

HERE = Path(__file__).parent
SYSTEMS = HERE.parents[1] / "systems"


LINKS = {
    "1": "upper_front_link",
    "2": "upper_rear_link",
    "3": "lower_front_link",
    "4": "lower_rear_joint",
    "5": "track_rod_link",
    "track_rod": "track_rod_link",
    **{
        f"{arm}_{leg}": f"{arm}_{leg}_leg"
        for arm in ("upper", "lower")
        for leg in ("front", "rear")
    },
}


def of_the_assembled_car(name):
    """Return the name in the assembled car of something of the car in one file."""
    name = re.sub(r"^(front|rear)_(wheel_left|wheel_right|left_wheel|right_wheel)", r"\1.\2", name)
    found = re.match(r"(front|rear)_(left|right)_(\w+)(.*)", name)
    if found is None:
        return name
    axle, side, part, rest = found.groups()
    return f"{axle}.{side}.{LINKS.get(part, part)}{rest}"


def of_the_assembled_coach(name):
    """Return the name in the assembled coach of something of the coach in one file."""

    def of_bogie(match):
        number = int(match[2])
        return f"bogie_{(number + 1) // 2}.{match[1]}_{(number - 1) % 2 + 1}"

    name = re.sub(r"^(wheelset|axle|primary)_(\d)", of_bogie, name)
    return re.sub(r"^(frame|secondary)_(\d)", r"bogie_\2.\1", name)


CASES = {
    "car": (HERE / "car_in_one_file.yaml", SYSTEMS / "assembled_car.yaml", of_the_assembled_car),
    "coach": (
        SYSTEMS / "manchester_vehicle_1.yaml",
        SYSTEMS / "coach_of_two_bogies.yaml",
        of_the_assembled_coach,
    ),
}


def motion(path, states, seed=7):
    """Return rates and channels by name, units and values, near the start; ``states`` renames."""
    model, problems = read_system(path)
    assert not problems
    equations = derive(build_system(model))
    kernel = compile_kernel(equations, backend="interpreted")
    names = [states(s.name) for s in equations.states]
    moved = dict(
        zip(sorted(names), np.random.default_rng(seed).normal(size=len(names)), strict=True)
    )
    x = np.array([s.start + 1e-4 * moved[n] for n, s in zip(names, equations.states, strict=True)])
    z = assemble(kernel, 0.1, x, np.array([u.start for u in equations.unknowns]))
    found = {
        f"d.{n}": (f"{s.unit}/s".replace("/s/s", "/s^2"), rate)
        for n, s, rate in zip(names, equations.states, kernel.rates(0.1, x, z), strict=True)
    }
    outputs = kernel.outputs(0.1, x, z)
    for channel, value in zip(equations.channels, outputs, strict=True):
        found[states(channel.name)] = (channel.unit, value)
    return found


@pytest.mark.validation
@pytest.mark.parametrize("case", CASES)
def test_an_assembled_vehicle_has_the_equations_of_the_one_in_one_file(case):
    flat, assembled, renamed = CASES[case]
    want, found = motion(flat, renamed), motion(assembled, str)
    extra = {n for n in found if n not in want}
    assert set(want) <= set(found)
    assert all(".wheel." in n for n in extra), extra
    sizes = scales(want)
    for name, (unit, value) in want.items():
        assert abs(found[name][1] - value) <= 1e-12 * sizes[unit], (name, value, found[name])


def scales(motion):
    """Return the size that rounding refers to by unit: the largest value, of lengths at least 1 m.

    Angles turn such lengths, moments and powers are made of the forces at them.
    """
    sizes = {"m": 1.0, "rad": 1.0}
    for unit, value in motion.values():
        sizes[unit] = max(sizes.get(unit, 0.0), abs(value))
    return sizes | {"N*m": max(sizes["N"], sizes.get("N*m", 0.0))}
