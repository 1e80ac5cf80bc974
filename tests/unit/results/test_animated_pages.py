"""Pages of animations in a real browser: they play, seek, turn, and load nothing."""

import io
import os
import shutil
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from animated_files import BODIES, DURATION, SPEED, WHEEL, write_car
from browser import Browser, find_browser
from matplotlib.image import imread

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.simulation.simulation import run_scenario
from vehicledyn.files.scenario import load_scenario
from vehicledyn.results.animation.animate import animate_result, read_scenes
from vehicledyn.results.store.animation_section import Pictures, Span
from vehicledyn.results.store.animation_stage import Stage
from vehicledyn.results.store.reader import open_result

pytestmark = pytest.mark.long  # in a browser

ROOT = Path(__file__).parents[3]
PICTURES = Path(__file__).parent / "pictures"
STATE = "animation.state()"
UNSAFE = "</script><script>window.wrong=1</script><img src=x onerror='window.wrong=1'>"


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    program = find_browser()
    if program is None:
        pytest.skip("no Chromium to open pages with")
    with Browser(program, tmp_path_factory.mktemp("profile")) as opened:
        yield opened


@pytest.fixture
def page(tmp_path):
    """Address of the page of a small car."""
    write_car(tmp_path / "car.h5")
    animate_result(tmp_path / "car.h5", tmp_path / "car.html")
    return (tmp_path / "car.html").as_uri()


def settled(browser):
    """Wait for the next picture and return what the page shows."""
    browser.evaluate("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r)))")
    return browser.evaluate(STATE)


def text_of(browser, name):
    return browser.evaluate(f"document.getElementById('{name}').textContent")


def test_opens_from_disk_alone(browser, page):
    browser.open(page)
    state = settled(browser)
    assert (state["begin"], state["end"], state["playing"]) == (0.0, DURATION, False)
    assert state["triangles"] > 1000
    assert browser.evaluate("document.title") == "A car drives a circle"
    assert text_of(browser, "title") == "A car drives a circle"
    assert browser.problems() == []
    assert browser.requests() == []


def test_play_moves_the_vehicle(browser, page):
    browser.open(page)
    before = settled(browser)
    browser.evaluate("document.getElementById('play').click()")
    browser.wait(f"{STATE}.time > 0.4")
    moving = browser.evaluate(STATE)
    assert moving["playing"]
    assert np.hypot(*np.subtract(moving["place"], before["place"])[:2]) > 0.3 * SPEED
    # The camera follows: it keeps its place to the vehicle.
    assert np.subtract(moving["camera"], moving["place"]) == pytest.approx(
        np.subtract(before["camera"], before["place"]), abs=1e-6
    )
    browser.press(" ")
    assert not settled(browser)["playing"]
    browser.wait(f"!{STATE}.playing")


def test_it_stops_at_the_end_and_begins_again(browser, page):
    browser.open(f"{page}#t={DURATION - 0.1}")
    browser.press(" ")
    browser.wait(f"!{STATE}.playing && {STATE}.time === {DURATION}")
    browser.press(" ")
    browser.wait(f"{STATE}.time > 0 && {STATE}.time < {DURATION / 2}")


def test_slider_and_keys_seek(browser, page):
    browser.open(page)
    slide = "s => { s.value = 2; s.dispatchEvent(new Event('input')); }"
    browser.evaluate(f"({slide})(document.getElementById('time'))")
    state = settled(browser)
    yaw = 0.5 * 2.0
    assert state["time"] == 2.0
    assert state["place"][:2] == pytest.approx([20 * np.sin(yaw), 20 * (1 - np.cos(yaw))], abs=2e-3)
    browser.press("ArrowRight")
    assert settled(browser)["time"] == pytest.approx(2.01, abs=1e-6)
    browser.press("Home")
    assert settled(browser)["time"] == 0.0


def test_plots_follow_and_seek(browser, page):
    browser.open(page)
    before = settled(browser)
    browser.evaluate("animation.seek(3)")
    after = settled(browser)
    box = "document.querySelector('.area').getBoundingClientRect()"
    area = browser.evaluate(f"(r => [r.left, r.top, r.width, r.height])({box})")
    assert after["marks"][0] - before["marks"][0] == pytest.approx(0.75 * area[2], rel=0.2)
    assert after["values"] == [["4.206"], ["85.94"]]  # 4 kN + 0.5 kN sin 9; 1.5 rad
    middle = (area[0] + 0.5 * area[2], area[1] + 0.5 * area[3])
    browser.drag(middle, middle)
    assert 1.5 < settled(browser)["time"] < 2.2


def test_camera_turns(browser, page):
    browser.open(page)
    before = settled(browser)
    browser.drag((300, 350), (420, 350))
    after = settled(browser)
    assert after["target"] == pytest.approx(before["target"], abs=1e-9)
    turned = [np.subtract(s["camera"], s["target"]) for s in (before, after)]
    assert np.linalg.norm(turned[0]) == pytest.approx(np.linalg.norm(turned[1]), rel=1e-6)
    angles = [np.arctan2(t[1], t[0]) for t in turned]
    assert abs(angles[1] - angles[0]) > 0.3
    browser.press("4")
    above = settled(browser)
    assert above["camera"][:2] == pytest.approx(above["target"][:2], abs=0.05)


def test_camera_rides_along(browser, page):
    browser.open(page)
    browser.press("c")
    before = settled(browser)
    browser.evaluate("animation.seek(2)")
    after = settled(browser)
    turned = [np.subtract(s["camera"], s["target"]) for s in (before, after)]
    angles = [np.arctan2(t[1], t[0]) for t in turned]
    assert (angles[1] - angles[0] + np.pi) % (2 * np.pi) - np.pi == pytest.approx(1.0, abs=1e-3)


def test_two_results(browser, tmp_path):
    paths = [tmp_path / "one.h5", tmp_path / "two.h5"]
    for path in paths:
        write_car(path, title=path.stem)
    animate_result(paths[0], tmp_path / "both.html", others=paths[1:])
    browser.open((tmp_path / "both.html").as_uri())
    both = settled(browser)
    assert browser.evaluate("document.getElementById('key').children.length") == 2
    assert [len(values) for values in both["values"]] == [2, 2]
    browser.evaluate("document.getElementById('other').click()")
    assert settled(browser)["triangles"] < both["triangles"]
    assert browser.problems() == []


def test_texts_are_never_run(browser, tmp_path):
    write_car(tmp_path / "car.h5", title=UNSAFE)
    animate_result(tmp_path / "car.h5", tmp_path / "car.html")
    browser.open((tmp_path / "car.html").as_uri())
    settled(browser)
    assert browser.evaluate("window.wrong") is None
    assert text_of(browser, "title") == UNSAFE
    assert browser.evaluate("document.images.length") == 0
    assert browser.problems() == []


def test_what_is_unknown_is_left_out(browser, tmp_path):
    def spoil(pictures):
        position = pictures.position.copy()
        position[200:, 1] = np.nan
        return replace(pictures, position=position)

    writer = write_car(tmp_path / "car.h5", spoil=spoil, close=False)
    writer.close("failed", "the step failed")
    animate_result(tmp_path / "car.h5", tmp_path / "car.html")
    browser.open((tmp_path / "car.html").as_uri())
    whole = settled(browser)["triangles"]
    browser.evaluate("animation.seek(3)")
    assert settled(browser)["triangles"] < whole - WHEEL
    told = text_of(browser, "warning")
    assert told.startswith("partial: failed at t = 4 s: the step failed; values from t = 2 s on")
    assert browser.problems() == []


def nothing(pictures):
    return replace(pictures, position=np.full_like(pictures.position, np.nan))


POOR = [{"count": 1}, {"spoil": nothing}, {"stage": Stage(BODIES[:1], [])}]


@pytest.mark.parametrize("changes", POOR)
def test_poor_results(browser, tmp_path, changes):
    """One picture, none that is a number, nothing to draw: a page all the same."""
    if "stage" in changes:
        changes = {**changes, "spoil": lambda p: Pictures(p.time, *(a[:, :1] for a in parts(p)))}
    write_car(tmp_path / "car.h5", **changes)
    animate_result(tmp_path / "car.h5", tmp_path / "car.html")
    browser.open((tmp_path / "car.html").as_uri())
    browser.press(" ")
    state = settled(browser)
    assert np.isfinite(
        [float(x) for key in ("camera", "target", "place") for x in state[key]]
    ).all()
    assert browser.problems() == []
    if "count" in changes:
        assert state["triangles"] > 1000


def parts(pictures):
    return pictures.position, pictures.quaternion, pictures.turn


def test_looks_as_it_did(browser, page):
    """The picture itself, without texts, which are drawn by fonts that differ."""
    browser.open(f"{page}#t=1.5")
    check_picture(browser, "small_car.png")


def run(name, path, *changes):
    """Run a scenario, or copy its result where tests/regression/check.py has the same."""
    kept = Path(os.environ.get("CHECKED_RESULTS", path.parent / "none"), name).with_suffix(".h5")
    if kept.is_file():
        with open_result(kept) as result:
            is_same = result.is_whole and (
                not changes or [f"duration={result.time[-1]:g} s"] == [*changes]
            )
        if is_same:
            shutil.copy(kept, path)
            return
    loaded = load_scenario(ROOT / "scenarios" / name, changes)
    run_scenario(loaded, output=path, backend="auto", progress=lambda *_: None)


def test_the_slalom(browser, tmp_path, needs_compiler):
    run("iltis_slalom.yaml", tmp_path / "slalom.h5")
    begun = time.process_time()
    written = animate_result(tmp_path / "slalom.h5", tmp_path / "slalom.html")
    assert time.process_time() - begun < 2.0
    assert written.size < 1.5e6
    browser.open((tmp_path / "slalom.html").as_uri() + "#t=11")
    assert len(settled(browser)["values"]) == 2
    assert browser.problems() == []
    assert browser.requests() == []
    check_picture(browser, "iltis_slalom.png")


def test_a_wheelset_on_rails(browser, tmp_path, needs_compiler):
    run("systems/rail_wheelset.yaml", tmp_path / "rail.h5", "duration=0.1 s")
    with open_result(tmp_path / "rail.h5") as result:
        found = result.animation(Span(100))
    assert found.track[:, 0, 1] == pytest.approx(0.7175, abs=1e-9)
    assert found.track[:, 1, 1] == pytest.approx(-0.7175, abs=1e-9)
    assert found.track[0, 0, 0] < 0.0 < 2.0 < found.track[-1, 0, 0]
    (load, _) = read_scenes([tmp_path / "rail.h5"])[0].arrows
    assert load.force[-1, 2] == pytest.approx(50e3, rel=0.1)  # half of the load
    assert load.foot[:, 1:] == pytest.approx(np.tile([0.75, 0.0], (len(load.foot), 1)), abs=0.01)
    animate_result(tmp_path / "rail.h5", tmp_path / "rail.html")
    browser.open((tmp_path / "rail.html").as_uri() + "#t=0.05")
    check_picture(browser, "rail_wheelset.png")


def test_a_wheelset_hunts(browser, tmp_path, needs_compiler):
    """Above its critical speed; the plots show the oscillation and not the way travelled."""
    run("wheelset_limit_cycle.yaml", tmp_path / "hunting.h5", "duration=0.4 s")
    animate_result(tmp_path / "hunting.h5", tmp_path / "hunting.html")
    browser.open((tmp_path / "hunting.html").as_uri() + "#t=0.3&view=front")
    state = settled(browser)
    assert browser.evaluate("document.querySelectorAll('.plot li').length") == 2
    assert "Lateral shift" in text_of(browser, "plots")
    assert all(len(ticks) > 1 for ticks in state["ticks"])
    assert browser.problems() == []
    check_picture(browser, "wheelset_hunting.png")


def test_the_tram_in_the_curve(browser, tmp_path, needs_compiler):
    """The front bogie is in the arc; the rails below it are bent, the wheels stand on them."""
    run("tram2000_curve.yaml", tmp_path / "tram.h5", "duration=4 s")
    written = animate_result(tmp_path / "tram.h5", tmp_path / "tram.html")
    still = animate_result(tmp_path / "tram.h5", tmp_path / "still.html", span=Span(2))
    assert still.size + 60.0 / 4.0 * (written.size - still.size) < 5e6  # a minute of it
    browser.open((tmp_path / "tram.html").as_uri() + "#t=4")
    settled(browser)
    assert browser.problems() == []
    assert browser.requests() == []
    check_picture(browser, "tram_curve.png")


def test_controls_leave_room_on_a_phone(browser, page):
    """In a window 390 wide the vehicle is not hidden behind the buttons, which can be reached."""
    phone = {"width": 390, "height": 844, "deviceScaleFactor": 1, "mobile": False}
    browser.call("Emulation.setDeviceMetricsOverride", **phone)
    try:
        browser.open(page)
        heights = "['views', 'stage'].map(n => document.getElementById(n).clientHeight)"
        views, stage = browser.evaluate(heights)
        assert views < 0.15 * stage
        assert browser.evaluate("document.documentElement.scrollWidth") == 390
        last = "document.getElementById('forces-choice')"
        browser.evaluate(f"{last}.scrollIntoView()")
        assert browser.evaluate(f"{last}.getBoundingClientRect().right") <= 390
    finally:
        wide = {"width": 1280, "height": 720, "deviceScaleFactor": 1, "mobile": False}
        browser.call("Emulation.setDeviceMetricsOverride", **wide)


def check_picture(browser, name):
    """Compare the moving picture with a stored one: few pixels may differ, and little."""
    hide = "element => { element.style.display = 'none'; }"
    browser.evaluate(f"document.querySelectorAll('header, #views, #key').forEach({hide})")
    picture = browser.screenshot(x=0, y=0, width=880, height=660)
    stored = PICTURES / name
    if not stored.exists():  # a new one is kept to be looked at, and the test fails
        stored.parent.mkdir(exist_ok=True)
        stored.write_bytes(picture)
        pytest.fail(f"{stored} is new; look at it and run again")
    found, expected = (imread(io.BytesIO(d))[:, :, :3] for d in (picture, stored.read_bytes()))
    difference = np.abs(found - expected).max(axis=2)
    assert (difference > 0.1).mean() < 0.01
    assert difference.mean() < 0.01
