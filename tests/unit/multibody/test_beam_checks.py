"""What no beam can be: sections inside out, axes without direction, turns without inertia."""

import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.files.system.read import read_system
from vehicledyn.multibody import GROUND, ParameterTable, System, derive
from vehicledyn.multibody.bodies.beam_properties import Material, Stiffness
from vehicledyn.multibody.bodies.beam_sections import Section
from vehicledyn.multibody.elements.flexible.beam import Beam, Modes

BAR = {"mass_per_length": 1.0, "y": 1.0, "z": 1.0, "twist": 1.0, "shear_y": 1.0}
ROD = {"section": Section(shape="circle", radius=0.1), "material": Material(density=1.0, young=1.0)}


@pytest.mark.parametrize(
    ("sizes", "words"),
    [
        ({"shape": "tube", "radius": 0.03, "thickness": 0.04}, "its thickness of 0.04 m is more"),
        ({"shape": "i_section", "width": 0.05, "height": 0.1, "web": 0.06, "flange": 0.01},
         "its web of 0.06 m is more than the width"),
        ({"shape": "i_section", "width": 0.05, "height": 0.1, "web": 0.01, "flange": 0.06},
         "its flange of 0.06 m is more than half of the height"),
    ],
)  # fmt: skip
def test_a_wall_is_not_thicker_than_the_section(sizes, words):
    with pytest.raises(InputError, match=words):
        Section(**sizes)


def test_a_tube_may_be_solid():
    """A wall as thick as the radius is a circle."""
    tube = Section(shape="tube", radius=0.03, thickness=0.03).numbers
    circle = Section(shape="circle", radius=0.03).numbers
    assert (tube.area, tube.torsion) == pytest.approx((circle.area, circle.torsion))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"upwards": (2.0, 0.0, 0.0)}, "upwards: is along the beam"),
        ({"direction": (0.0, 0.0, 0.0)}, "direction: is zero"),
        ({"modes": Modes(twist=2)}, "stiffness.polar: the beam has modes of twist"),
        ({"model": "exact", "modes": Modes(y=2, shear_y=2)}, "stiffness.rotary_y: sections"),
        ({"model": "exact", "curvature": (0.0, 0.0, 12.0), "stiffness": None, **ROD},
         "curvature: about z its radius of 0.0833333 m"),
    ],
)  # fmt: skip
def test_what_contradicts_itself_is_refused(change, words):
    settings = {"length": 1.0, "stiffness": Stiffness(**BAR), "modes": Modes(z=2)} | change
    with pytest.raises(InputError, match=words):
        Beam("beam", body=GROUND, **settings)


def test_no_material_has_this_poisson_ratio():
    with pytest.raises(InputError, match=r"material.poisson: 0.7 is of no material"):
        Material(density=1.0, young=1.0, poisson=0.7)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"length": -1.0}, "beam: length: must be greater than 0 m, is -1"),
        ({"stiffness": Stiffness(**{**BAR, "mass_per_length": 0.0})}, "must be greater than 0"),
        ({"damping_ratio": float("nan")}, "beam: damping_ratio: is no number"),
    ],
)
def test_numbers_given_in_python_have_the_bounds_of_files(change, words):
    settings = {"length": 1.0, "stiffness": Stiffness(**BAR), "modes": Modes(z=2)} | change
    parts = (Beam("beam", body=GROUND, **settings),)
    with pytest.raises(InputError, match=words):
        derive(System("rod", ParameterTable(), (), parts=parts))


FILE = """\
title: a rod
parameters: {wall: 40 mm}
elements:
  rod:
    kind: beam
    body: ground
    length: 1 m
    section: {shape: tube, radius: 30 mm, thickness: wall}
    material: {density: 2700 kg/m^3, young: 70 GPa, poisson: 0.3}
    modes: {z: 2}
"""


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("wall}", "wall}", "rod.yaml:8:14: elements.rod.section: its thickness of 0.04 m"),
        ("wall}", "2 mm}\n    direction: [0, 0, 1]", "rod.yaml:4:3: elements.rod.upwards: is"),
        ("wall}\n", "2 mm}\n    upwards: [1, 0, 0]\n", "rod.yaml:9:14: elements.rod.upwards: is"),
        (
            "wall}\n",
            "2 mm}\n    curvature: [0, 40 / (1 m), 0]\n    model: exact\n",
            "curvature: about y its",
        ),
        ("poisson: 0.3", "poisson: 0.6", "elements.rod.material.poisson: 0.6 is of no material"),
    ],
)
def test_files_are_told_the_line(tmp_path, old, new, words):
    path = tmp_path / "rod.yaml"
    text = FILE if "thickness" in words else FILE.replace("40 mm", "4 mm")
    path.write_text(text.replace(old, new))
    _, found = read_system(path)
    assert words in "\n".join(map(str, found))
