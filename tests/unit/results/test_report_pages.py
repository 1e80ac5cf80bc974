"""Pages of results: complete, self-contained, deaf to what files say, bounded in memory."""

import base64
import re
import tracemalloc
from html.parser import HTMLParser
from time import monotonic as time_now

import h5py
import numpy as np
import pytest
from result_files import Quantity, header, slalom_values

from vehicledyn.base.errors import InputError
from vehicledyn.results.report import write_report
from vehicledyn.results.report.page import Facts, Page, Section, render
from vehicledyn.results.report.texts import change, reading
from vehicledyn.results.store.decimation import thinned
from vehicledyn.results.store.reader import open_result
from vehicledyn.results.store.writer import ResultWriter

pytestmark = pytest.mark.long

HOSTILE = '</title><script>alert(1)</script><img src=x onerror=alert(2)> $\\frac{$ "quoted" \x1b 🚗'


class Reader(HTMLParser):
    """Collects what a browser would see of a page."""

    def __init__(self, path):
        super().__init__()
        self.tags, self.ids, self.words, self.open = [], [], [], []
        self.feed(path.read_text(encoding="utf-8"))
        self.text = " ".join(" ".join(self.words).replace("\xa0", " ").split())

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        self.ids += [value for name, value in attrs if name == "id"]
        if tag not in ("meta", "img", "link", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if "style" not in self.open:
            self.words.append(data)

    def all(self, tag):
        return [attributes for name, attributes in self.tags if name == tag]


def page(source, **options):
    return Reader(write_report(source, **options))


def test_a_page_needs_nothing_but_itself(make_result):
    read = page(make_result())
    assert read.open == [] and len(set(read.ids)) == len(read.ids)
    assert not read.all("script") and not read.all("link")
    (policy,) = [m["content"] for m in read.all("meta") if m.get("http-equiv")]
    assert policy.startswith("default-src 'none'") and "script" not in policy
    for image in read.all("img"):
        kind, _, data = image["src"].partition(";base64,")
        assert kind == "data:image/svg+xml" and base64.b64decode(data).startswith(b"<?xml")
        assert len(image["alt"]) > 40
        assert image["decoding"] == "sync"  # a page that is printed at once shows its figures
    for link in read.all("a"):
        assert link["href"].startswith("#") and link["href"][1:] in read.ids


def test_key_figures_parts_and_text_alternatives(make_result):
    told = {"part": "tyre linear", "does": "Forces grow with slip.", "source": "A book (1900)"}
    read = page(make_result(sources=[told]))
    for text in ("Smallest clearance 0.25 m", "All cones left standing yes", "Driver preview",
                 "tyre linear Forces grow with slip. A book (1900)", "Steps 22000"):  # fmt: skip
        assert text in read.text
    path, loads = (image["alt"] for image in read.all("img"))
    assert path.startswith("Path.")
    # 3.8 kN with an amplitude of 0.9 kN/m times 1.5 m.
    front = slalom_values()[1]["wheel_fl.tyre.normal_force"][1] / 1e3
    assert f"front left from {front.min():.4g} to {front.max():.4g}" in loads
    assert "against Time [s]" in loads


def test_texts_of_files_are_shown_and_never_executed(make_result):
    path = make_result(
        title=HOSTILE, model=HOSTILE, scenario_text=HOSTILE, status="failed", message=HOSTILE,
        sources=[{"part": HOSTILE, "does": HOSTILE, "source": HOSTILE}],
        configuration={HOSTILE: HOSTILE, "solver": {"kind": HOSTILE}},
    )  # fmt: skip
    read = page(path)
    assert not read.all("script")
    assert all(image["src"].startswith("data:") for image in read.all("img"))
    assert "<script>alert(1)</script>" in read.text
    assert "\x1b" not in read.text
    two = page(path, against=path, output=path.with_name("two.html"))
    folder = page(path.parent)
    assert not two.all("script") and not folder.all("script")


def test_a_partial_run_and_values_that_are_none(make_result):
    time, values = slalom_values(50)
    values["chassis.roll"][1][10:13] = np.nan
    values["chassis.yaw"][1][:] = np.inf
    stopped = make_result(time=time, values=values, status="interrupted", message="by the user")
    read = page(stopped)
    assert "Not complete. partial: interrupted at t = 22 s: by the user" in read.text
    assert "chassis.yaw (50), chassis.roll (3)" in read.text
    empty = make_result("empty.h5", time=np.empty(0), values={"x": ("m", np.empty(0))}, plots=[])
    assert "there is nothing to draw" in page(empty).text
    before_killed = ResultWriter(
        empty.with_name("killed.h5"), channels=[Quantity("x", "m")], header=header(plots=[])
    )
    before_killed.append(np.arange(3.0), np.ones((3, 1)))
    before_killed._flush(before_killed._container)
    assert "still running at t = 2 s" in page(empty.with_name("killed.h5")).text
    before_killed.close()


@pytest.mark.parametrize("share", [0.03, 0.3, 0.6, 0.9, 0.99])
def test_a_killed_run_that_is_cut_off_does_not_keep_us_waiting(tmp_path, share):
    """HDF5 itself would wait minutes for a writer to mend it."""
    path = tmp_path / "killed.h5"
    names = [Quantity(f"part_{k}.x", "m") for k in range(20)]
    with ResultWriter(path, channels=names, header=header(plots=[])) as writer:
        for k in range(5):
            writer.append(k + np.arange(0.0, 1.0, 0.01), np.full((100, 20), float(k)))
            writer._flush(writer._container)
        left = path.read_bytes()
    path.write_bytes(left)
    assert "broken off at t = 4.99 s" in page(path).text
    path.write_bytes(left[: int(share * len(left))])
    begun = time_now()
    try:
        assert "Not complete" in page(path).text
    except InputError as error:
        assert "is damaged" in str(error)
    assert time_now() - begun < 10.0


def _newer(path):
    with h5py.File(path, "a") as file:
        file.attrs["format_version"] = 99


def _promising(path):
    """Give a column of a terabyte that is not there."""
    with h5py.File(path, "a") as file:
        for name in ("time", "chassis/x"):
            file[name].resize((1 << 37,))


def _elsewhere(path):
    with h5py.File(path, "a") as file:
        size = len(file["time"])
        del file["chassis/x"]
        place = [("/dev/zero", 0, 8 * size)]
        file.create_dataset("chassis/x", (size,), "f8", external=place)


def _cut(path):
    path.write_bytes(path.read_bytes()[:3000])


def _replaced(path, place, **data):
    with h5py.File(path, "a") as file:
        kept = dict(file[place].attrs)
        del file[place]
        file.create_dataset(place, **data)
        for name in ("units", "long_name"):
            if name in kept:
                file[place].attrs[name] = kept[name]


def _configuration_of_lists(path):
    _replaced(path, "scenario/configuration", data="[1, 2]")


def _plots_of_numbers(path):
    _replaced(path, "plots/descriptions", data="[1, 2]")


def _complex_channel(path):
    _replaced(path, "chassis/x", data=np.ones(221, complex))


def _without_titles(path):
    with h5py.File(path, "a") as file:
        del file.attrs["title"], file["chassis/x"].attrs["units"]


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda path: path.unlink(), "no such file"),
        (lambda path: path.write_text("title: no"), "is not an HDF5 file"),
        (lambda path: h5py.File(path, "w").close(), "not a result of this program"),
        (_newer, "format version 99"),
        (_promising, "they are not in the file"),
        (_elsewhere, "they are not in the file"),
        (_cut, "is damaged"),
        (_without_titles, "is damaged"),
        (_configuration_of_lists, "its configuration is none"),
        (_plots_of_numbers, "is no list of records"),
        (_complex_channel, "is no column of numbers"),
    ],
)
def test_unusable_files_are_told_of_and_leave_no_page(make_result, damage, message):
    path = make_result()
    damage(path)
    with pytest.raises(InputError, match=message):
        write_report(path)
    assert not list(path.parent.glob("*.html"))
    if path.exists():
        make_result("good.h5")
        read = page(path.parent)
        assert "1 results, 1 unusable files" in read.text
        assert re.search(f"run.h5 .*{message}", read.text)


@pytest.mark.parametrize("length", [1, 7, 100, 101, 1000, 1003])
def test_thinning_keeps_every_peak(tmp_path, length):
    values = np.random.default_rng(length).normal(size=length)
    values[length // 3] = np.nan
    with h5py.File(tmp_path / "x.h5", "w") as file:
        dataset = file.create_dataset("x", data=values)
        counted = file.create_dataset("t", data=np.arange(length))
        chosen = thinned(length, 100)
        shown, times = chosen.values(dataset), chosen.times(counted)
    assert len(shown) == len(times) <= max(102, length if length <= 100 else 0)
    if length > 1:
        assert np.nanmin(shown) == np.nanmin(values) and np.nanmax(shown) == np.nanmax(values)
    assert times[-1] == length - 1 and np.all(np.diff(times) >= 0.0)
    if length > 100:
        # Every block shows its own extremes.
        first = values[: chosen.block]
        assert set(shown[:2]) == {np.nanmin(first), np.nanmax(first)}


def test_memory_does_not_grow_with_the_file(tmp_path):
    count = 3_000_000
    writer = ResultWriter(
        tmp_path / "long.h5", channels=[Quantity("x", "m")], header=header(plots=[]),
        expected_samples=count,
    )  # fmt: skip
    values = np.zeros((count, 1))
    values[1_234_567] = 7.0
    writer.append(0.001 * np.arange(count), values)
    writer.close()
    del values
    write_report(tmp_path / "long.h5")  # what is loaded once
    tracemalloc.start()
    read = page(tmp_path / "long.h5")
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 20e6 < 8 * count
    assert "from 0 to 7" in read.all("img")[0]["alt"]
    assert "envelope of 3000000 samples" in read.text


def test_two_results_share_their_figures(make_result):
    time, values = slalom_values()
    values["wheel_fl.tyre.normal_force"][1][100] += 270.0
    other = make_result("other.h5", time=time, values=values)
    path = make_result()
    read = page(path, against=other)
    assert "Quantity run other Difference" in read.text
    assert "Smallest clearance 0.25 m 0.25 m equal" in read.text
    force = slalom_values()[1]["wheel_fl.tyre.normal_force"][1]
    share = 100.0 * 270.0 / np.ptp(values["wheel_fl.tyre.normal_force"][1])
    row = f"wheel_fl.tyre.normal_force {force[100]:.4g} N {force[100] + 270.0:.4g} N {share:.3g} %"
    assert f"{row} 10 s" in read.text
    images = [image["alt"] for image in read.all("img")]
    assert len(images) == 2
    assert images[1].count("front left from") == 1
    with pytest.raises(InputError, match="only results of one kind"):
        positions = make_result("swept.h5")
        with h5py.File(positions, "a") as file:
            file["time"].attrs["units"] = "1"
        write_report(path, against=positions)


def test_an_animation_beside_the_result_is_linked(make_result):
    path = make_result("a #1.h5")
    (path.parent / "a #1_animation.html").write_text("moves", encoding="utf-8")
    links = [link["href"] for link in page(path).all("a")]
    assert "./a%20%231_animation.html" in links


def test_only_reports_are_written_over(make_result):
    path = make_result()
    target = write_report(path)
    assert write_report(path) == target
    target.write_text("my own notes", encoding="utf-8")
    with pytest.raises(InputError, match="is no report, so it is kept"):
        write_report(path)
    with pytest.raises(InputError, match="does not exist"):
        write_report(path, path.parent / "no" / "page.html")
    with pytest.raises(InputError, match="holds no result files"):
        (path.parent / "empty").mkdir()
        write_report(path.parent / "empty")


def test_equal_results_give_equal_pages(make_result):
    path = make_result()
    first = write_report(path).read_bytes()
    assert write_report(path).read_bytes() == first
    with open_result(path) as result:
        assert result.title.encode() in first


def test_long_tables_and_texts_are_cut_and_say_so():
    rows = [("a", "b" * 5000)]
    text = render(Page("t", "s", [Section("One", [Facts(rows)])]))
    assert "(5000 signs in all)" in text


def test_numbers_for_readers():
    assert reading(0.05, "rad") == "2.865\u00a0deg"
    assert reading(4.2, "m/s^2") == "4.2\u00a0m/s²"
    assert (reading(True, "1"), reading(float("nan"), "m")) == ("yes", "not a number")
    assert change(1.1, 1.0, "m") == "+0.1\u00a0m (+10 %)"
    assert (change(1.0, 1.0, "m"), change("a", "b", "1")) == ("equal", "different")


def test_complex_key_figures_are_compared_as_equal_or_different():
    assert change(1.0 + 2.0j, 1.0 + 2.0j, "1/s") == "equal"
    assert change(1.0 + 2.0j, 3.0, "1/s") == "different"
