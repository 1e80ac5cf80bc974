"""Small result files for the tests of this folder."""

from __future__ import annotations

import numpy as np
import pytest
from result_files import Quantity, header, slalom_values

from vehicledyn.results.store.layout import SummaryEntry
from vehicledyn.results.store.writer import ResultWriter


@pytest.fixture
def make_result(tmp_path):
    """Return a function that writes a result file and returns its path."""

    def make(
        name="run.h5", *, time=None, values=None, status="ok", message="", notes=(), **changes
    ):
        given_time, given_values = slalom_values()
        time = given_time if time is None else time
        values = given_values if values is None else values
        quantities = [Quantity(name, unit) for name, (unit, _) in values.items()]
        table = (
            np.array([column for _, column in values.values()]).reshape(len(values), len(time)).T
        )
        path = tmp_path / name
        writer = ResultWriter(
            path,
            channels=quantities,
            states=[Quantity("chassis.x", "m"), Quantity("chassis.vx", "m/s")],
            header=header(**changes),
            expected_samples=len(time),
        )
        states = np.stack([time, time + 1.0], axis=1)
        writer.append(time, table, states)
        writer.close(
            status,
            message,
            summary=[
                SummaryEntry("cones.cleared", 9, "1", "Cones cleared"),
                SummaryEntry("cones.clearance", 0.25, "m", "Smallest clearance"),
                SummaryEntry("cones.clean", True, "1", "All cones left standing"),
                SummaryEntry("driver", "preview", "1", "Driver"),
            ],
            solver={"method": "rk4", "step": 1e-3, "steps": 22000, "warm": True},
            notes=notes,
        )
        return path

    return make
