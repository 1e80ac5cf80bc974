"""A steady start that is not found from the written one is found from the equilibrium at rest."""

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.analyses.preparation import prepare
from vehicledyn.base.errors import NumericalError

SPEED = "20 m/s"


@pytest.mark.long
def test_a_steady_start_is_found_from_rest_where_the_written_one_leads_nowhere(monkeypatch):
    """As a sedan's that is given wheels 50 mm larger, which then begin 60 mm in the ground."""
    wanted = vd.equilibrium("small_car", speed=SPEED)
    search, asked = prepare._balanced, []

    def fails_first(prepared, start, speed, slopes):
        asked.append(speed)
        if len(asked) == 1:
            raise NumericalError("not from here")
        return search(prepared, start, speed, slopes)

    monkeypatch.setattr(prepare, "_balanced", fails_first)
    found = vd.equilibrium("small_car", speed=SPEED)
    assert asked == [20.0, 0.0, 20.0]
    for name in wanted:
        assert np.asarray(found[name]) == pytest.approx(np.asarray(wanted[name]), abs=1e-6), name

    def fails(prepared, start, speed, slopes):
        raise NumericalError("at a speed" if speed else "at rest")

    monkeypatch.setattr(prepare, "_balanced", fails)
    with pytest.raises(NumericalError, match="at a speed"):
        vd.equilibrium("small_car", speed=SPEED)
