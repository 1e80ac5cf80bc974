"""Pages, pictures and films of results: what they hold, and what they say of bad files."""

import json
import re
import time
import tracemalloc
from dataclasses import replace

import h5py
import numpy as np
import pytest
from animated_files import BODIES, DURATION, SHAPES, motion, write_car
from matplotlib import animation as film_writers
from matplotlib.image import imread

from vehicledyn.base.errors import InputError, MissingPartError
from vehicledyn.cli.commands.animate import animate
from vehicledyn.results.animation.animate import (
    animate_result,
    film_of_result,
    picture_of_result,
    read_scenes,
)
from vehicledyn.results.animation.frame_state import SceneState
from vehicledyn.results.animation.packed_columns import PackedColumns, unpack
from vehicledyn.results.animation.still import figure_of
from vehicledyn.results.store import study_reader
from vehicledyn.results.store.animation_section import Span
from vehicledyn.results.store.animation_stage import Stage
from vehicledyn.results.tables import mode_table

UNSAFE = "</script><script>document.title='wrong'</script> @PACKED@ <!-- \u2028 \"'&"


@pytest.fixture
def car(tmp_path):
    path = tmp_path / "car.h5"
    write_car(path)
    return path


def content(page):
    """Data and columns that a page holds, read back."""
    text = page.read_text(encoding="utf-8")
    data = re.search(r'<script id="data" type="application/json">(.*?)</script>', text).group(1)
    packed = re.search(r'<script id="packed" type="text/plain">(.*?)</script>', text).group(1)
    plain = json.loads(data)
    return plain, unpack(plain["columns"], packed)


def test_page_holds_the_motion(car, tmp_path):
    page = tmp_path / "page.html"
    written = animate_result(car, page)
    assert (written.path, written.pictures, written.messages) == (page, 401, ())
    assert written.size == page.stat().st_size
    plain, columns = content(page)
    scene = plain["scenes"][0]
    time_axis = np.linspace(0.0, DURATION, 401)
    pictures, channels = motion(time_axis)
    assert columns[scene["time"]] == pytest.approx(time_axis, abs=1e-8)
    origin = np.column_stack([columns[k] for k in scene["origin"]])
    for k, body in enumerate(scene["bodies"]):
        place = np.column_stack([columns[c] for c in body["position"]]) + origin
        assert np.abs(place - pictures.position[:, k]).max() < 1e-4
        turned = np.column_stack([columns[c] for c in body["quaternion"]])
        assert np.abs(turned - pictures.quaternion[:, k]).max() < 1e-4
    assert columns[scene["bodies"][1]["turn"]] == pytest.approx(pictures.turn[:, 1], abs=1e-6)
    shown = {c["name"]: columns[c["column"]] * c["factor"] for c in scene["channels"]}
    assert shown["car.yaw"] == pytest.approx(np.degrees(channels["car.yaw"][1]), abs=0.01)
    assert shown["wheel.load"] == pytest.approx(channels["wheel.load"][1] / 1e3, abs=1e-3)
    assert scene["panels"][0] == {"title": "Load", "channels": ["wheel.load"]}


def test_forces_stand_on_the_ground(car):
    arrow = read_scenes([car])[0].arrows[0]
    _, channels = motion(np.linspace(0.0, DURATION, 401))
    yaw, side = channels["car.yaw"][1], channels["wheel.side"][1]
    expected = np.column_stack([-np.sin(yaw) * side, np.cos(yaw) * side, channels["wheel.load"][1]])
    assert arrow.force == pytest.approx(expected, abs=1e-3)


def test_a_force_without_its_channels_is_left_out(tmp_path):
    path = tmp_path / "car.h5"
    other = {**SHAPES[-1], "components": [None, None, "wheel.absent"]}
    write_car(path, stage=Stage(BODIES, [*SHAPES[:-1], other]))
    assert read_scenes([path])[0].arrows == []


def test_texts_of_files_are_no_code(tmp_path):
    path, page = tmp_path / "car.h5", tmp_path / "page.html"
    write_car(path, title=UNSAFE)
    animate_result(path, page)
    text = page.read_text(encoding="utf-8")
    assert text.count("<script") == text.count("</script>") == 4
    assert content(page)[0]["scenes"][0]["title"] == UNSAFE


def test_pages_load_nothing(car, tmp_path):
    page = tmp_path / "page.html"
    animate_result(car, page)
    text = page.read_text(encoding="utf-8")
    assert "default-src 'none'" in text
    assert "Permission is hereby granted, free of charge" in text  # the library's licence
    assert not re.search(r"""(src|href)\s*=\s*["'](?!data:)""", text)
    assert page.stat().st_size < 900_000


def test_partial_and_spoilt_results_say_so(tmp_path):
    path = tmp_path / "car.h5"

    def spoil(pictures):
        position = pictures.position.copy()
        position[200:, 1] = np.nan
        return replace(pictures, position=position)

    writer = write_car(path, spoil=spoil, close=False)
    writer.close("interrupted", "stopped by the user")
    written = animate_result(path, tmp_path / "page.html")
    assert [message.partition(": ")[2] for message in written.messages] == [
        "partial: interrupted at t = 4 s: stopped by the user",
        "poses from t = 2 s on are not all numbers; what is unknown is left out",
    ]
    scene = content(tmp_path / "page.html")[0]["scenes"][0]
    assert (scene["whole"], scene["bad"]) == (False, 2.0)
    picture_of_result(path, tmp_path / "still.png", time=3.0, view="side")


def test_long_titles_and_endings_stay_inside_of_pictures(car):
    scene = read_scenes([car], span=Span(100), plots=False)[0]
    state = (
        "derailed at t = 2.1396012 s, 32.99 m along the track: " + 9 * "the wheel left its rail; "
    )
    figure = figure_of(
        replace(scene, title=5 * "A tram in a curve ", state=state, is_whole=False), 1.0, "angle"
    )
    width, height = figure.canvas.get_width_height()
    boxes = [t.get_window_extent() for t in figure.axes[0].texts]
    assert len(boxes) == 2 and boxes[1].y1 < boxes[0].y0
    assert all(b.x0 > 0.0 and b.x1 < width and b.y1 < height for b in boxes)


def test_nothing_but_not_a_number(tmp_path):
    path = tmp_path / "car.h5"

    def spoil(pictures):
        nothing = np.full_like(pictures.position, np.nan)
        return replace(pictures, position=nothing, quaternion=0.0 * pictures.quaternion)

    write_car(path, spoil=spoil)
    assert animate_result(path, tmp_path / "page.html").messages
    picture_of_result(path, tmp_path / "still.png", time=None, view="top")


def test_a_run_that_was_killed(tmp_path):
    path = tmp_path / "car.h5"
    writer = write_car(path, close=False, count=5000)
    copy = tmp_path / "copy.h5"
    copy.write_bytes(path.read_bytes())
    writer.close()
    written = animate_result(copy, tmp_path / "page.html")
    assert written.messages[0].startswith("copy.h5: partial: broken off at t = 4 s")


def no_shapes(path):
    with h5py.File(path, "a") as file:
        del file["animation"]


def no_pictures(path):
    with h5py.File(path, "a") as file:
        for name in ("picture_time", "origin", "position", "quaternion", "turn"):
            file["animation"][name].resize(0, axis=0)


def newer(path):
    with h5py.File(path, "a") as file:
        file.attrs["format_version"] = 99


def torn(path):
    path.write_bytes(path.read_bytes()[:-20_000])


def bad_description(path):
    with h5py.File(path, "a") as file:
        file["animation/description"][()] = '{"bodies": [{"name": "car"}], "shapes": [{"kind": 3}]}'


def bad_length(path):
    with h5py.File(path, "a") as file:
        file["animation/turn"].resize(7, axis=0)


def times_with_a_gap(path):
    with h5py.File(path, "a") as file:
        file["animation/picture_time"][50:60] = np.nan


def times_that_fall(path):
    with h5py.File(path, "a") as file:
        file["animation/picture_time"][50] = 3.9


def other_hdf5(path):
    path.unlink()
    with h5py.File(path, "w") as file:
        file["a"] = 1.0


def text(path):
    path.write_text("time, x\n0, 1\n")


def study(path):
    other_hdf5(path)
    with h5py.File(path, "a") as file:
        file.attrs["format"] = study_reader.FORMAT


def modes(path):
    other_hdf5(path)
    with h5py.File(path, "a") as file:
        file.attrs["format"] = mode_table.FORMAT


BAD = {
    study: "holds the cases of a study",
    modes: "holds no motion but a table",
    no_shapes: "holds no shapes and poses",
    no_pictures: "holds no pictures",
    newer: "format version 99",
    torn: "is damaged",
    bad_description: "is damaged",
    bad_length: "is damaged",
    times_with_a_gap: "is damaged",
    times_that_fall: "is damaged",
    other_hdf5: "not a result of this program",
    text: "is not an HDF5 file",
}


@pytest.mark.parametrize("spoil", BAD, ids=lambda spoil: spoil.__name__)
def test_bad_files(car, tmp_path, spoil):
    spoil(car)
    page = tmp_path / "page.html"
    with pytest.raises(InputError, match=BAD[spoil]):
        animate_result(car, page)
    assert not page.exists()


def test_unknown_wishes(car, tmp_path):
    page = tmp_path / "page.html"
    with pytest.raises(InputError, match=r"'wheel\.lode' matches no channel; did you mean"):
        animate_result(car, page, channels=["wheel.lode"])
    with pytest.raises(InputError, match="outside of 0 to 4 s"):
        picture_of_result(car, tmp_path / "a.png", time=5.0, view="angle")
    with pytest.raises(InputError, match="view 'up'"):
        picture_of_result(car, tmp_path / "a.png", time=1.0, view="up")
    with pytest.raises(InputError, match="no picture format"):
        picture_of_result(car, tmp_path / "a.bmp", time=1.0, view="angle")
    with pytest.raises(InputError, match="does not exist"):
        animate_result(car, tmp_path / "absent" / "page.html")


def test_only_animations_are_written_over(car, tmp_path):
    kept, page = car.read_bytes(), tmp_path / "page.html"
    for _ in range(2):
        animate_result(car, page)
    with pytest.raises(InputError, match="is no animation, so it is kept"):
        animate_result(car, car)
    assert car.read_bytes() == kept
    page.write_text("my own notes", encoding="utf-8")
    with pytest.raises(InputError, match="is no animation, so it is kept"):
        animate_result(car, page)


def test_two_results_and_chosen_channels(car, tmp_path):
    other, page = tmp_path / "other.h5", tmp_path / "page.html"
    write_car(other, title="Another")
    animate_result(car, page, others=[other], channels=["wheel.*"])
    scenes = content(page)[0]["scenes"]
    assert [scene["title"] for scene in scenes] == ["A car drives a circle", "Another"]
    assert {channel["name"].split(".")[0] for channel in scenes[0]["channels"]} == {"wheel"}


@pytest.mark.parametrize("tidy", [True, False])
def test_what_only_rises_hides_no_oscillation(tmp_path, tidy):
    panel = {"label": "Value", "unit": "", "channels": ["car.yaw", "wheel.load"]}
    plot = {"name": "all", "kind": "time", "title": "All", "panels": [panel], "arranged": tidy}
    write_car(tmp_path / "car.h5", plots=[plot])
    found = {p.title: p.channels for p in read_scenes([tmp_path / "car.h5"])[0].panels}
    apart = {"Value: wheel.load": ("wheel.load",), "Value: car.yaw": ("car.yaw",)}
    expected = apart if tidy else {"Value": ("car.yaw", "wheel.load")}
    assert list(found.items()) == list(expected.items())


def test_long_results_are_thinned_in_bounded_memory(tmp_path):
    """A result of a gigabyte on paper: what is not written reads as not a number."""
    path = tmp_path / "long.h5"
    write_car(path, count=2000)
    rows = 2_000_000
    with h5py.File(path, "a") as file:
        del file["checksums"]
        file["time"].resize(rows, axis=0)
        file["time"][:] = np.linspace(0.0, DURATION, rows)
        for name in file.attrs["channels"]:
            file[name.replace(".", "/")].resize(rows, axis=0)
        for k in range(60):
            copy = file.create_dataset(f"more/c{k}", (rows,), "f8", chunks=(4096,))
            copy.attrs.update({"units": "m", "long_name": "More"})
        names = [*file.attrs["channels"], *(f"more.c{k}" for k in range(60))]
        file.attrs["channels"] = np.array(names, dtype=h5py.string_dtype())
        group = file["animation"]
        for name in ("picture_time", "origin", "position", "quaternion", "turn"):
            group[name].resize(500_000, axis=0)
        group["picture_time"][:] = np.linspace(0.0, DURATION, 500_000)
    begun = time.perf_counter()
    tracemalloc.start()
    written = animate_result(path, tmp_path / "page.html", span=Span(1000))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert written.pictures == 1000
    assert peak < 150e6
    assert time.perf_counter() - begun < 60.0


def test_a_part_of_a_result(car, tmp_path):
    part = read_scenes([car], span=Span(11, begin=1.0, end=2.0))[0]
    assert part.time == pytest.approx(np.linspace(1.0, 2.0, 11), abs=1e-9)
    near = read_scenes([car], span=Span(3, instant=1.234))[0]
    assert near.time == pytest.approx([0.0, 1.23, 1.24, 1.25, 2.0, 4.0], abs=1e-9)
    with pytest.raises(InputError, match="no pictures to animate between these times"):
        animate_result(car, tmp_path / "page.html", span=Span(11, begin=7.0))


def test_poses_between_pictures(car):
    scene = read_scenes([car])[0]
    moment = SceneState(scene, 1.2345)
    pictures, _ = motion(np.array([1.2345]))
    assert moment.position == pytest.approx(pictures.position[0], abs=1e-3)
    top = moment.places("wheel", [0.0, 0.0, 0.3], spins=True)[0] - moment.position[1]
    angle = pictures.turn[0, 1]
    yaw = 0.5 * 1.2345
    ahead = 0.3 * np.sin(angle)
    expected = [ahead * np.cos(yaw), ahead * np.sin(yaw), 0.3 * np.cos(angle)]
    assert top == pytest.approx(expected, abs=1e-3)


@pytest.mark.parametrize("view", ["angle", "side", "front", "top"])
def test_still_picture(car, tmp_path, view):
    target = tmp_path / "still.png"
    picture_of_result(car, target, time=1.0, view=view)
    picture = imread(target)[:, :, :3]
    assert picture.shape == (720, 1280, 3)
    middle = picture[180:560, 320:960].reshape(-1, 3)
    blue = (middle[:, 2] - middle[:, 0] > 0.12).mean()
    assert blue > 0.03  # the hull
    red = (picture[:, :, 0] - picture[:, :, 1] > 0.4).mean()
    assert red > 1e-4  # the force


@pytest.mark.long
def test_film(car, tmp_path):
    target = tmp_path / "film.gif"
    told = []
    written = film_of_result(
        car, target, view="side", rate=4, speed=2.0, progress=lambda *a: told.append(a)
    )
    assert written.pictures == len(told) == 9
    assert target.read_bytes()[:6] == b"GIF89a"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["car.h5", "film.gif"]


def test_films_that_nothing_here_writes(car, tmp_path, monkeypatch):
    monkeypatch.setattr(film_writers.writers, "is_available", lambda name: name == "pillow")
    wish = {"view": "side", "rate": 4, "speed": 1.0, "progress": lambda *_: None}
    with pytest.raises(MissingPartError, match="needs ffmpeg"):
        film_of_result(car, tmp_path / "film.mp4", **wish)
    with pytest.raises(InputError, match="ends with"):
        film_of_result(car, tmp_path / "film.avi", **wish)


def test_columns():
    rng = np.random.default_rng(0)
    walk = np.cumsum(rng.normal(size=5000))
    gaps = walk.copy()
    gaps[::7] = np.nan
    given = [
        (walk, 0.0), (gaps, 0.0), (np.full(3, 2.5), 0.0), (np.full(3, np.nan), 0.0),
        (1e6 + walk, 1e-7), (np.empty(0), 0.0), (np.array([-4.0]), 0.0),
        (np.array([1e300, -1e300]), 0.0),
    ]  # fmt: skip
    columns = PackedColumns()
    for k, (values, finest) in enumerate(given):
        assert columns.add(values, finest=finest) == k
    found = unpack(json.loads(json.dumps(columns.describe)), columns.packed)
    for (values, finest), column in zip(given, found, strict=True):
        assert np.array_equal(np.isnan(column), np.isnan(values))
        known = values[np.isfinite(values)]
        step = finest or (np.ptp(known) / 65533 if len(known) else 0.0)
        assert np.allclose(column[np.isfinite(values)], known, rtol=1e-15, atol=step)


@pytest.mark.parametrize(("name", "option"), [("a.png", "--picture"), ("a.MP4", "--film")])
def test_page_is_not_written_under_the_name_of_a_picture(tmp_path, name, option):
    with pytest.raises(InputError, match=f"give {option} "):
        animate(tmp_path / "any.h5", output=tmp_path / name)
    assert not list(tmp_path.iterdir())
