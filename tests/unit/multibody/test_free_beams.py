"""Shapes of beams whose start is free, against closed forms of free and of clamped beams."""

import numpy as np
import pytest
from beam_kernels import BENDING, LENGTH, MASS, PACE, at_rest, frequencies, kernel_of

from vehicledyn.multibody import Body, Joint
from vehicledyn.multibody.bodies.beam_shapes import free_shapes, quadrature
from vehicledyn.multibody.elements.flexible.beam import Modes

LOOSE = (Joint("T3", "lift"), Joint("R2", "pitch"))
FREE = [22.3732854480613, 61.6728228679202, 120.903391727124]
CLAMPED = [3.51601526850015, 22.0344915646668, 61.6972144135491]


def test_modes_of_a_free_beam():
    found = frequencies(kernel_of(hub=LOOSE, basis="free", modes=Modes(z=8)))
    assert found[2:5] / PACE == pytest.approx(FREE, rel=2e-6)


@pytest.mark.parametrize("direction", ["y", "z"])
def test_modes_of_a_clamped_beam(direction):
    kernel = kernel_of(basis="free", modes=Modes(**{direction: 8}))
    assert frequencies(kernel)[:3] / PACE == pytest.approx(CLAMPED, rel=4e-6)


def test_sag_under_its_weight_and_a_load():
    g, load = 1e-6, 3.0
    tip = Body("load", "beam.tip", mass=load)
    seen = at_rest(kernel_of(tip, gravity=(0.0, 0.0, -g), basis="free", modes=Modes(z=8)))
    sag = MASS * g * LENGTH**4 / (8 * BENDING) + load * g * LENGTH**3 / (3 * BENDING)
    assert seen["beam.tip_z"] == pytest.approx(-sag, rel=1e-6)


def test_rotation_stiffens_it_as_any():
    """Hub radius zero, Ω = 12: the shortening of these shapes too is integrated exactly."""
    found = frequencies(kernel_of(speed=12.0 * PACE, basis="free", modes=Modes(z=8)))[:3] / PACE
    assert found == pytest.approx([13.170150, 37.603112, 79.614478], rel=2e-5)


@pytest.mark.parametrize("count", [1, 2, 5, 8, 12])
def test_they_are_clamped_and_orthonormal(count):
    shapes = free_shapes(count)
    slope = np.abs(shapes.at(np.array([0.0, 1.0]), 1)).max(axis=1)
    assert np.abs(shapes.values(0.0)).max() < 1e-11
    assert slope[0] < 1e-9 * slope[1]
    places, weights = quadrature(shapes.points)
    values, bent = shapes.at(places), shapes.at(places, 2)
    assert (values.T * weights) @ values == pytest.approx(np.eye(count), abs=1e-7)
    stiff = (bent.T * weights) @ bent
    assert stiff == pytest.approx(np.diag(shapes.stiffness), abs=1e-6 * shapes.stiffness[-1])
