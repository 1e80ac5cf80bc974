"""Killed commands lose nothing but the last second, and leave nothing that looks whole.

By hand with more of them: ``python tests/hostile/kills.py 200``.
"""

import pytest
from kills import VICTIMS, Campaign
from starting import start

pytestmark = pytest.mark.xdist_group("hostile")  # warmed up once


@pytest.fixture(scope="module")
def campaign(tmp_path_factory):
    return Campaign(tmp_path_factory.mktemp("kills"))


SLOW = ("hunt", "steady", "steady page", "handling", "rig", "export FMU", "eig along speeds",
        "sensitivity of a critical speed", "sensitivity of cycles", "sensitivity of kinematics",
        "kinematics", "inverse", "profiles")  # fmt: skip
ALIKE = ("drawn cam", "identify", "identify from figures", "uncertainty", "export C",
         "table", "schema", "init", "optimise-manoeuvre", "linearise", "track",
         "equilibrium", "tyre")  # fmt: skip
"""Write their files as others do that are killed here."""
CHEAP = [victim for victim in VICTIMS if victim.name not in (*SLOW, *ALIKE)]


@pytest.mark.parametrize("victim", CHEAP, ids=lambda victim: victim.name)
def test_kills(campaign, victim):
    faults = campaign.kill(victim, go_on=True) + campaign.kill(victim, go_on=False)
    assert not faults


def test_of_two_runs_on_one_output_one_is_refused(campaign, tmp_path):
    folder = campaign._copy()
    command = VICTIMS[0].command
    codes = sorted(process.wait() for process in [start(folder, command) for _ in range(2)])
    assert codes == [0, 2]
    assert start(folder, ["info", "r.h5"]).wait() == 0
    names = {path.name for path in folder.iterdir() if path.name.startswith(".")}
    assert not names
