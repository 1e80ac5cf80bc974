"""Figures drawn by a process of their own: the same files, and what happens where it fails."""

import sys

import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.results.plots import drawing_process as module
from vehicledyn.results.plots.drawing_process import drawing_process
from vehicledyn.results.plots.run_plots import draw_described


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture
def beside(monkeypatch):
    """Draw in another process, though this one has the plotting library already."""
    monkeypatch.setattr(module, "_is_faster", lambda: True)


@pytest.fixture
def here(monkeypatch):
    """List the results that this process draws."""
    drawn = []
    monkeypatch.setattr(module, "draw_here", lambda path, folder: drawn.append(path) or 7)
    return drawn


def test_the_pictures_are_the_same_to_the_bit(make_result, tmp_path, beside, here):
    path, folder = make_result(), tmp_path / "beside"
    with drawing_process(wanted=True) as draw:
        assert draw(path, folder) == 4
    assert here == []
    draw_described(path, tmp_path / "here")
    assert contents(folder) == contents(tmp_path / "here")


def test_a_process_that_fails_leaves_drawing_and_its_errors_to_this_one(
    make_result, tmp_path, beside
):
    with drawing_process(wanted=True) as draw:
        with pytest.raises(InputError, match=r"gone\.h5"):
            draw(tmp_path / "gone.h5", tmp_path / "plots")
        draw(make_result(), tmp_path / "plots")
    assert len(contents(tmp_path / "plots")) == 4


def test_a_process_that_cannot_start_is_done_without(monkeypatch, tmp_path, beside, here):
    monkeypatch.setattr(sys, "executable", str(tmp_path / "nowhere"))
    with drawing_process(wanted=True) as draw:
        assert draw(tmp_path / "a.h5", tmp_path) == 7
    assert here == [tmp_path / "a.h5"]


def test_an_interrupted_process_leaves_no_half_pictures(monkeypatch, make_result, tmp_path, beside):
    folder, stopped = tmp_path / "plots", []
    with pytest.raises(KeyboardInterrupt), drawing_process(wanted=True) as draw:
        worker = draw.__self__
        stopped.append(worker.process)

        class Interrupted:
            def readline(self):
                raise KeyboardInterrupt

            def close(self):
                pass

        with worker.process.stdout:
            monkeypatch.setattr(worker.process, "stdout", Interrupted())
            draw(make_result(), folder)
    assert stopped[0].returncode is not None
    assert not folder.exists() or not [n for n in contents(folder) if n.startswith(".")]


def test_nothing_starts_without_need(monkeypatch, tmp_path, here):
    monkeypatch.setattr(module, "start_module", lambda *_: pytest.fail("started"))
    with drawing_process(wanted=False), drawing_process(wanted=True):
        pass
