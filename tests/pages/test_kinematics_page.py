"""Every command of the page on kinematics and inverse dynamics works."""

import re
from pathlib import Path

import numpy as np
import pytest
from programs import run

from vehicledyn.results.store.reader import open_result

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "kinematics.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
COMMANDS = [
    line for kind, body in BLOCK.findall(PAGE) if kind == "sh" for line in body.splitlines()
]


def listing(name):
    bodies = [body for kind, body in BLOCK.findall(PAGE) if kind == "yaml"]
    return next(body for body in bodies if body.startswith(f"# {name}\n"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The folder in which all commands have run, with the repository's files in reach."""
    place = tmp_path_factory.mktemp("page")
    for name in ("systems", "scenarios"):
        (place / name).symlink_to(ROOT / name)
    text = listing("turn.yaml").replace("SYSTEMS", str(ROOT / "systems"))
    (place / "turn.yaml").write_text(text, encoding="utf-8")
    for line in COMMANDS:
        run(line, place)
    return place


def columns(path, *names):
    with open_result(path) as result:
        assert result.is_whole
        return [result.channel(name).values for name in names]


def test_the_grid_is_complete(folder):
    heights, racks = columns(folder / "grid.h5", "wheel.z", "rack.displacement")
    assert len({round(z, 9) for z in heights}) * len({round(r, 9) for r in racks}) == 45
    assert len(heights) == 45


def test_figures_are_drawn(folder):
    assert (folder / "five_link_suspension_kinematics_plots" / "wheel_1.png").is_file()
    assert (folder / "turn_inverse_plots" / "forces.png").is_file()


def test_a_turn_brings_back_what_it_took(folder):
    """The crank turns once from rest to rest against a spring: the work adds up to nothing."""
    (power,) = columns(folder / "turn_inverse.h5", "crank.angle_power")
    time = np.linspace(0.0, 0.4, len(power))
    assert np.abs(power).max() > 1.0
    assert np.trapezoid(power, time) == pytest.approx(0.0, abs=1e-5 * np.abs(power).max())


def test_a_free_motion_needs_no_forces(folder):
    (free,) = columns(folder / "again.h5", "crank.angle_force")
    (steady,) = columns(folder / "slider_crank_inverse.h5", "crank.angle_force")
    assert np.abs(free).max() < 1e-3 * np.abs(steady).max()


def test_links_lead_to_files():
    links = re.findall(r"\]\(([^)#:]+)[^)]*\)", PAGE)
    assert links
    assert [link for link in links if not (ROOT / "docs" / link).exists()] == []
