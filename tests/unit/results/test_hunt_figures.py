"""The bifurcation diagram: where the line of the equilibrium changes from solid to dashed."""

import numpy as np
import pytest

from vehicledyn.results.hunt_figures import hunt_figures
from vehicledyn.results.hunt_table import HuntTable, Quantity


@pytest.mark.parametrize(("figures", "place"), [({"linear_critical": 57.5}, 57.5), ({}, 56.0)])
def test_equilibrium_is_dashed_from_the_critical_value_on(figures, place):
    """Between coarse values growth is -3 and 2 1/s: linearly none at three fifths of the way."""
    growth = np.array([-10.0, -3.0, 2.0, 4.0])
    table = HuntTable(
        title="t",
        model="m",
        parameter=Quantity("speed", "m/s", "Speed"),
        channels=(Quantity("y", "m", "Shift"),),
        locus_values=np.array([40.0, 50.0, 60.0, 70.0]),
        eigenvalues=np.stack([growth + 5.0j, growth - 5.0j], axis=1),
        cycles=(),
        simulated=(),
        figures=figures,
        status="ok",
        message="",
    )
    diagram = dict(hunt_figures(table))["bifurcation"]
    lines = {line.get_linestyle(): line.get_xdata() for line in diagram.axes[0].get_lines()}
    assert lines["-"] == pytest.approx([40.0, 50.0, place], abs=1e-4)
    assert lines["--"] == pytest.approx([place, 60.0, 70.0], abs=1e-4)
