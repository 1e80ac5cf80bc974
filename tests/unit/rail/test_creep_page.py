"""The page on creep forces: its listing runs, its table names laws of the catalogue."""

import re
import subprocess
import sys
from pathlib import Path

import vehicledyn.rail.creep  # noqa: F401
from vehicledyn.base.registry import kinds

PAGE = (Path(__file__).parents[3] / "docs" / "creep.md").read_text(encoding="utf-8")


def test_listing():
    (listing,) = re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
    done = subprocess.run(
        [sys.executable, "-c", listing], capture_output=True, text=True, check=True, timeout=120
    )
    forces = dict(line.split(": ") for line in done.stdout.splitlines())
    assert set(forces) == {"fastsim", "polach", "shen_hedrick_elkins"}
    for text in forces.values():
        along, across = (float(part.removesuffix(" N")) for part in text.split(", "))
        assert -15e3 < along < -5e3
        assert -15e3 < across < 0.0


def test_laws_of_the_table_exist():
    """The reference, which is generated, has all."""
    named = set(re.findall(r"^\| `(\w+)` \|", PAGE, re.MULTILINE))
    assert named
    assert named <= set(kinds("creep"))


def test_links_lead_to_files():
    for link in re.findall(r"\]\(([^)#:]+)\)", PAGE):
        assert (Path(__file__).parents[3] / "docs" / link).exists()
