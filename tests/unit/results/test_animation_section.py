"""Shapes and poses in a result: what was written comes back, thinned, also from a broken run."""

import h5py
import numpy as np
import pytest

from vehicledyn.results.store.animation_section import (
    Pictures,
    Span,
    Surroundings,
    read_animation,
    thinned,
)
from vehicledyn.results.store.animation_stage import Stage
from vehicledyn.results.store.layout import ResultHeader, SummaryEntry
from vehicledyn.results.store.reader import open_result
from vehicledyn.results.store.writer import ResultWriter

CAR = {"name": "car", "axis": 0, "axes_spin": True}
WHEEL = {"name": "wheel", "axis": 2, "axes_spin": False}
STAGE = Stage(
    [CAR, WHEEL],
    [{"kind": "ball", "name": "<b>", "at": {"body": "car", "point": [0, 0, 0]}, "radius": 0.1}],
)


def pictures(times):
    count = len(times)
    far = 1e5 + np.cumsum(np.ones((count, 2, 3)), axis=0) * 0.123456789
    quaternion = np.tile([1.0, 0.0, 0.0, 0.0], (count, 2, 1))
    return Pictures(times, far, quaternion, np.column_stack([0.0 * times, 1e4 * times]))


@pytest.fixture
def writer(tmp_path):
    header = ResultHeader(title="t", model="m")
    return ResultWriter(tmp_path / "r.h5", channels=[], header=header, stage=STAGE)


def fill(writer, blocks=3, size=700):
    for k in range(blocks):
        times = np.linspace(k, k + 1, size, endpoint=False)
        writer.append_pictures(pictures(times))
        writer.append(times, np.empty((size, 0)))


def test_round_trip(writer):
    with writer:
        fill(writer)
        surface, rails = (np.random.default_rng(0).normal(size=(4, k, 3)) for k in (3, 2))
        writer.close(
            summary=[SummaryEntry("a", 1.0, "m", "A")], surroundings=Surroundings(surface, rails)
        )
    with open_result(writer.path) as result:
        assert result.pictures == len(result.time)
        found = result.animation(Span(10_000))
        assert found.stage.shapes[0].items() >= STAGE.shapes[0].items()
        assert [body["name"] for body in found.stage.bodies] == ["car", "wheel"]
        whole = pictures(result.time)
        assert np.array_equal(found.pictures.time, result.time)
        # Single precision counts from the first body, so that far away nothing is lost.
        for k in range(3):
            block = slice(700 * k, 700 * k + 700)
            expected = pictures(result.time[block]).position
            assert np.abs(found.pictures.position[block] - expected).max() < 1e-7
        assert np.array_equal(found.pictures.turn, whole.turn)
        assert np.array_equal(found.ground, surface)
        assert np.array_equal(found.track, rails)
        few = result.animation(Span(50))
        assert len(few.pictures.time) == 50
        assert (few.pictures.time[0], few.pictures.time[-1]) == (result.time[0], result.time[-1])
        assert set(few.pictures.time) <= set(result.time)


def test_broken_run_keeps_its_pictures(writer, tmp_path):
    fill(writer, blocks=6, size=1000)
    copy = tmp_path / "copy.h5"
    copy.write_bytes(writer.path.read_bytes())
    with open_result(copy) as result:
        found = result.animation(Span(10_000))
        assert len(result.time) >= 4000
        assert len(found.pictures.time) >= len(result.time)
    writer.close()


def test_every_dataset_has_its_scales(writer):
    with writer:
        fill(writer)
        writer.close(surroundings=Surroundings(np.zeros((4, 3, 3)), np.zeros((5, 2, 3))))
    with h5py.File(writer.path) as file:
        group = file["animation"]
        for item in group.values():
            if item.ndim and not item.is_scale:
                assert all(len(dimension) == 1 for dimension in item.dims), item.name


def test_thinning():
    assert thinned(0, 5).tolist() == []
    assert thinned(4, 5).tolist() == [0, 1, 2, 3]
    assert thinned(1001, 3).tolist() == [0, 500, 1000]


def test_times_that_are_not_in_the_file_are_not_read(tmp_path):
    """A damaged size promises 8 TB, which no machine has."""
    with h5py.File(tmp_path / "a.h5", "w") as file:
        group = file.create_group("animation")
        group["description"] = "{}"
        group.create_dataset("picture_time", (10**12,), "f8", chunks=(1000,))
        with pytest.raises(ValueError, match="picture_time is not in the file"):
            read_animation(group, Span(10))
