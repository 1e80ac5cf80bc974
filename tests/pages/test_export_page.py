"""Every command and listing of the page on exporting works, and all languages agree."""

import re
import shutil
import sys
from pathlib import Path

import pytest
from programs import run

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "export.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"^(?:#|//|%) (use\S*)\n")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The folder in which all files were exported, with the listings beside them."""
    place = tmp_path_factory.mktemp("page")
    for name in ("systems", "scenarios"):
        (place / name).symlink_to(ROOT / name)
    for kind, body in BLOCK.findall(PAGE):
        if kind == "sh":
            for line in body.splitlines():
                if line.startswith("vehicledyn"):
                    run(line, place)
        elif name := FILE.match(body):
            (place / name[1]).write_text(body, encoding="utf-8")
    return place


@pytest.fixture(scope="module")
def angle(folder):
    """The crank's angle after half a second, by the Python listing with the file's own mass."""
    text = (folder / "use.py").read_text(encoding="utf-8")
    (folder / "own.py").write_text(text.replace("crank_mass=2.5", ""), encoding="utf-8")
    return float(run(f"{sys.executable} own.py", folder, PYTHONPATH=str(folder)))


def test_listing_in_python(folder, angle):
    """The crank turns about its centre of mass: its mass changes nothing."""
    assert float(run(f"{sys.executable} use.py", folder, PYTHONPATH=str(folder))) == pytest.approx(
        angle, rel=1e-7
    )


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_listing_in_c(folder, angle):
    compile_line = next(line for line in PAGE.splitlines() if line.startswith("cc "))
    run(f"{compile_line} -Wall -Wextra -Werror", folder)
    assert float(run("./use", folder)) == pytest.approx(angle, rel=1e-5)


@pytest.mark.skipif(shutil.which("octave") is None, reason="no Octave")
def test_listing_in_matlab(folder):
    rate, acceleration = map(float, run("octave --no-gui --quiet use.m", folder).split())
    assert rate == pytest.approx(60.0)
    assert abs(acceleration) > 1.0


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_listing_of_the_fmu(folder, angle):
    pytest.importorskip("fmpy", reason="fmpy, which simulates FMUs, is not installed")
    assert float(
        run(f"{sys.executable} use_fmu.py", folder, PYTHONPATH=str(folder))
    ) == pytest.approx(angle, rel=1e-5)


def test_the_page_tells_of_every_function(folder):
    defined = re.findall(r"^def (\w+)\((.*)\):", (folder / "slider_crank.py").read_text(), re.M)
    assert {f"`{name}({arguments})`" for name, arguments in defined} == set(
        re.findall(r"^\| (`\w+\(.*?\)`) \|", PAGE, re.MULTILINE)
    )
