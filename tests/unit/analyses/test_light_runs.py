"""What a run loads: packages that take long to load stay away where they are not needed."""

import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.long

SCENARIOS = Path(__file__).parents[3] / "scenarios"
HEAVY = ("scipy", "pandas", "matplotlib")
SCRIPT = """
import sys
from vehicledyn.cli import main
sys.argv = ["vehicledyn", "run", *sys.argv[1:], "--no-plots", "-q"]
code = 0
try:
    main()
except SystemExit as end:
    code = end.code
print([name for name in {heavy} if name in sys.modules])
sys.exit(code)
"""


@pytest.mark.parametrize("name", ["four_bar", "four_bar_chain"])
def test_run_loads_no_heavy_package(name, tmp_path):
    """With DOP853, with fixed steps through singular configurations, with a summary."""
    scenario = SCENARIOS / "systems" / f"{name}.yaml"
    found = subprocess.run(
        [sys.executable, "-c", SCRIPT.format(heavy=HEAVY), str(scenario), "-o", "result.h5"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.returncode == 0, found.stderr
    assert found.stdout.splitlines()[-1] == "[]"
