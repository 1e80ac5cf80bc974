"""Beams coloured by stress in pages and pictures of animations."""

import numpy as np
import pytest
from browser import Browser, find_browser

import vehicledyn as vd
from vehicledyn.base.errors import InputError
from vehicledyn.results.animation.animate import animate_result
from vehicledyn.results.animation.levels import RAMP, level_colour, level_words
from vehicledyn.results.animation.scene import scene_of
from vehicledyn.results.animation.solids import faces_of
from vehicledyn.results.store.animation_section import Span
from vehicledyn.results.store.reader import open_result

pytestmark = pytest.mark.long

STRIP = """
title: A strip swings
elements:
  strip:
    kind: beam
    body: ground
    length: 1 m
    section: {shape: rectangle, width: 20 mm, height: 5 mm}
    material: {density: 7850 kg/m^3, young: 210 GPa}
    modes: {z: 3}
    stresses: true
"""


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    folder = tmp_path_factory.mktemp("strip")
    (folder / "strip.yaml").write_text(STRIP)
    vd.simulate(
        folder / "strip.yaml", duration="40 ms", solver={"kind": "rk4", "step": "0.1 ms"},
        output={"interval": "2 ms"}, backend="interpreted", save_to=folder / "strip.h5",
    )  # fmt: skip
    return folder / "strip.h5"


def test_pieces_have_the_colour_of_their_stress(result):
    with open_result(result) as opened:
        scene = scene_of(opened, Span(100))
        names = [f"strip.piece_{k}.stress" for k in range(1, 9)]
        assert sorted(scene.levels) == names
        most = max(float(opened.channel(name).values.max()) for name in names)
        assert scene.highest_level == pytest.approx(most, rel=0.05)
        last = opened.time[-1]
        colours = [level_colour(float(opened.channel(n).values[-1]), scene.highest_level)
                   for n in names]  # fmt: skip
    drawn = {face.colour for face in faces_of(scene, last, 1.0)}
    assert set(colours) <= drawn
    assert len(set(colours)) > 4
    assert level_words(scene) == f"stress 0 to {1e-6 * scene.highest_level:.3g} MPa"


def test_the_scale_goes_from_nothing_to_the_highest():
    assert level_colour(0.0, 5.0) == RAMP[0]
    assert level_colour(-5.0, 5.0) == RAMP[-1]
    assert level_colour(np.nan, 5.0) == "#808080"


def test_the_page_colours_them(result, tmp_path):
    program = find_browser()
    if program is None:
        pytest.skip("no Chromium to open pages with")
    animate_result(result, tmp_path / "strip.html")
    with Browser(program, tmp_path / "profile") as browser:
        browser.open((tmp_path / "strip.html").as_uri() + "#t=0.04")
        browser.evaluate("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)))")
        colours = browser.evaluate("animation.state()")["colours"]
        words = browser.evaluate("document.getElementById('levels').textContent")
        assert browser.problems() == []
    assert len(set(colours)) > 4 and len(colours) == 8
    assert words.startswith("stress 0 to ") and words.endswith(" MPa")


def test_beams_without_a_section_have_no_stress(tmp_path):
    text = STRIP.replace("    section:", "    stiffness: {mass_per_length: 1 kg/m, z: 1 N*m^2}\n#")
    text = text.replace("    material:", "#")
    (tmp_path / "strip.yaml").write_text(text)
    with pytest.raises(InputError, match="stresses: follow from a section and assumed modes"):
        vd.simulate(tmp_path / "strip.yaml", duration="1 ms", backend="interpreted")
