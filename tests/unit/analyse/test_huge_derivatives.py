"""A linearisation whose numbers overflow in the search for eigenvalues is refused."""

import pytest

import vehicledyn as vd
from vehicledyn.base.errors import NumericalError


def test_a_spring_of_1e200_has_no_eigenvalues():
    stiff = {"parameters.lateral_stiffness": "1e200 N/m"}
    with pytest.raises(NumericalError, match="too large to compute with"):
        vd.modes("simple_wheelset", set=stiff, backend="interpreted")
