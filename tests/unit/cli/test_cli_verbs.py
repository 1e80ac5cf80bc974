"""The verbs with the functions that they call replaced, and how every error ends."""

import itertools
import json
import math
import re
import sys
import warnings
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import vehicledyn
from vehicledyn.analyses.simulation.run_outcome import RunOutcome, ShownEntry
from vehicledyn.base.errors import InputError, MissingPartError, NumericalError, StoppedError
from vehicledyn.cli import main
from vehicledyn.cli.foreign_warnings import plain_foreign_warnings
from vehicledyn.cli.progress_bar import Progress
from vehicledyn.cli.terminal import emit, show_progress, to_json


@pytest.fixture
def call(monkeypatch, capsys):
    """Run the command line in this process; return exit code, standard output and error."""

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["vehicledyn", *map(str, arguments)])
        with pytest.raises(SystemExit) as end:
            main()
        captured = capsys.readouterr()
        return end.value.code, captured.out, captured.err

    return run


@pytest.fixture
def pipeline(monkeypatch):
    """Stand in for the pipeline; remember what it was asked and answer or raise."""
    asked = {}
    entry = ShownEntry(float("nan"), "m/s^2", "6.1 m/s^2 at 3.2 s")
    outcome = RunOutcome(Path("cart.h5"), "ok", {"acceleration": entry}, ["compiled in 3 s"])
    data = SimpleNamespace(status="ok", kind="run", path=Path("cart.h5"), report=outcome)

    def answer(name):
        def function(target, **options):
            asked.update(options, function=name, target=target)
            if isinstance(asked.get("raise"), BaseException):
                raise asked["raise"]
            return data if name == "simulate" else SimpleNamespace(status="ok", report=report)

        return function

    report = SimpleNamespace(as_text=lambda: "text", as_dict=lambda: {"modes": [1 + 2j]})
    for name in ("simulate", "equilibrium", "modes"):
        monkeypatch.setattr(vehicledyn, name, answer(name))

    def describe_model(target, **options):
        return answer("describe_model")(target, **options).report

    described = SimpleNamespace(describe_model=describe_model, write_system=None)
    monkeypatch.setitem(sys.modules, "vehicledyn.analyses", described)

    def draw(path, folder):
        asked["plots"] = folder
        return ["yaw.png"]

    monkeypatch.setattr("vehicledyn.results.plots.run_plots.draw_described", draw)
    return SimpleNamespace(asked=asked, data=data)


def test_validate_several_files(call, write, tmp_path):
    good, bad = write(("  channels: [chassis.*]\n", "")), tmp_path / "bad.yaml"
    bad.write_text("title: 1")
    code, out, err = call("validate", good, bad)
    assert code == 2
    assert out == f"{good}: ok\n"
    assert f"problems in {bad}" in err
    assert call("validate", good, "--set", "speed=30 m/s") == (0, f"{good}: ok\n", "")


def test_validate_reads_a_cam_with_its_table(call, tmp_path):
    cam, table = tmp_path / "cam.yaml", tmp_path / "law.csv"
    cam.write_text(
        "title: A cam\nmotion: [{kind: table, over: 360 deg, file: law.csv}]\n"
        "base_radius: 30 mm\nfollower: {kind: roller, radius: 9 mm}\n"
    )
    code, _, err = call("validate", cam)
    assert code == 2
    assert "cam.yaml:2:10: motion[0]:" in err and "law.csv: there is no such file" in err
    lifts = (2.0 * (1.0 - math.cos(math.radians(10 * k))) for k in range(37))
    rows = "".join(f"{10 * k},{lift:.9f}\n" for k, lift in enumerate(lifts))
    table.write_text(f"angle [deg],lift [mm]\n{rows}")
    assert call("validate", cam) == (0, f"{cam}: ok\n", "")


def test_run_names_its_files_after_the_scenario(call, write, pipeline):
    code, out, err = call("run", write(), "--set", "speed=3 m/s")
    assert (code, err) == (0, "compiled in 3 s\n1 figures in cart_plots\n")
    assert out == "cart.h5: ok\n  acceleration  6.1 m/s^2 at 3.2 s\n"
    assert pipeline.asked["target"].scenario.speed == 3.0
    assert pipeline.asked["save_to"] == Path("cart.h5")
    assert pipeline.asked["plots"] == Path("cart_plots")
    assert pipeline.asked["backend"] == "auto"


def test_run_with_everything_chosen(call, write, pipeline, tmp_path):
    output = tmp_path / "a.b.h5"
    options = ("-o", output, "--plots", "figures", "--backend", "interpreted", "--json")
    code, out, _ = call("run", write(), *options)
    assert code == 0
    assert json.loads(out) == {
        "result": "cart.h5",
        "status": "ok",
        "summary": {"acceleration": {"value": None, "unit": "m/s^2",
                                     "text": "6.1 m/s^2 at 3.2 s"}},
        "messages": ["compiled in 3 s", "1 figures in figures"],
    }  # fmt: skip
    assert pipeline.asked["save_to"] == output
    assert pipeline.asked["plots"] == Path("figures")
    assert pipeline.asked["backend"] == "interpreted"


def test_quiet_run_without_figures(call, write, pipeline):
    assert call("run", write(), "-q", "--no-plots") == (0, "", "")
    assert "plots" not in pipeline.asked


def test_failed_run_passes_its_exit_code_and_messages_on(call, write, pipeline):
    pipeline.data.status = "failed"
    pipeline.data.report.messages[:] = ["loop front_left opened at 3.1 s"]
    code, _, err = call("run", write(), "-q", "--no-plots")
    assert (code, err) == (3, "loop front_left opened at 3.1 s\n")


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (InputError("no such channel"), 2, "no such channel\n"),
        (NumericalError("no equilibrium"), 3, "no equilibrium\n"),
        (MissingPartError("no compiler"), 4, "no compiler\n"),
        (PermissionError(13, "Permission denied", "a.h5"), 2, "a.h5: Permission denied\n"),
        (MemoryError(), 2, "out of memory\n"),
        (ZeroDivisionError("float division by zero"), 3, "the computation failed on numbers ("),
        (ValueError("array must not contain infs or NaNs"), 3, "the computation failed on numb"),
        (RecursionError("maximum depth"), 2, "what is given is nested too deeply ("),
        (ValueError("no definite answer"), 70, "this is a bug of vehicledyn: ValueError: "),
        (KeyError("wheel\nbase"), 70, "this is a bug of vehicledyn: KeyError: "),
    ],
)
def test_every_error_is_one_message_and_an_exit_code(call, write, pipeline, error, code, words):
    pipeline.asked["raise"] = error
    got, out, err = call("run", write())
    assert (got, out) == (code, "")
    assert err.startswith(words)
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize(
    ("code", "words"),
    [
        ("np.float64(1e308) * 10.0", "warning: numbers left the range that a computer's numbers"),
        ("warnings.warn('odd', UserWarning)", "warning of "),
        ("raise SystemExit(2)", ""),
    ],
)
def test_what_libraries_warn_of_is_one_sentence(capsys, code, words):
    with warnings.catch_warnings(), pytest.raises(SystemExit), plain_foreign_warnings():
        warnings.simplefilter("default")
        np.float64(-1e308) * 10.0 if "Exit" in code else None
        exec(code)
        sys.exit(0)
    told = capsys.readouterr().err
    assert told.startswith(words)
    assert len(told.splitlines()) == bool(words)


def test_no_text_of_a_file_steers_the_terminal(call, write, pipeline, capsys):
    pipeline.asked["raise"] = InputError("\x1b]0;owned\x07 \x9b31m name")
    assert call("run", write()) == (2, "", "\\u001b]0;owned\\u0007 \\u009b31m name\n")
    emit(to_json({"a": "\x9b"}))
    assert json.loads(capsys.readouterr().out) == {"a": "\x9b"}


def test_interrupt_exits_with_130(call, write, pipeline):
    pipeline.asked["raise"] = KeyboardInterrupt()
    assert call("run", write()) == (130, "", "interrupted\n")


def test_interrupt_says_where():
    with (
        pytest.raises(StoppedError, match="interrupted at: compiling 9 operations"),
        show_progress() as progress,
    ):
        progress("compiling 9 operations")
        raise KeyboardInterrupt


def test_traceback_on_request(call, write, pipeline, monkeypatch):
    monkeypatch.setenv("VEHICLEDYN_TRACEBACK", "1")
    pipeline.asked["raise"] = KeyError("wheel")
    with pytest.raises(KeyError):
        call("run", write())


def test_equilibrium_of_a_model(call, catalogue, pipeline, tmp_path):
    file = tmp_path / "report.json"
    options = ("--speed", "36 km/h", "-o", file, "--set", "parameters.wheel_radius=31 cm")
    assert call("equilibrium", "cart", *options) == (0, "text\n", "")
    assert pipeline.asked["function"] == "equilibrium"
    assert pipeline.asked["speed"] == "36 km/h"
    assert pipeline.asked["target"].name == "cart"
    assert pipeline.asked["target"].written.parameters.wheel_radius == pytest.approx(0.31)
    assert json.loads(file.read_text()) == {"modes": [{"real": 1.0, "imaginary": 2.0}]}


def test_equilibrium_of_a_scenario_takes_its_speed(call, write, pipeline):
    assert call("equilibrium", write())[0] == 0
    assert pipeline.asked["speed"] is None
    assert pipeline.asked["target"].scenario.speed == pytest.approx(10.0, rel=1e-15)


def test_modes_at_several_speeds(call, write, pipeline):
    code, out, _ = call("eig", write(), "--speed", "5 m/s", "--speed", "72 km/h", "--json")
    assert code == 0
    assert pipeline.asked["speed"] == pytest.approx([5.0, 20.0])
    assert json.loads(out) == {"modes": [{"real": 1.0, "imaginary": 2.0}]}


def test_show_model(call, catalogue, pipeline):
    assert call("models", "show", "cart", "--backend", "compiled") == (0, "text\n", "")
    assert (pipeline.asked["target"].name, pipeline.asked["backend"]) == ("cart", "compiled")


def test_list_models(call, catalogue):
    _, out, _ = call("models", "list")
    listed = dict(line.split(maxsplit=1) for line in out.splitlines())
    assert listed["cart"] == "A cart whose parameters are kept in this file."
    assert listed["quarter_car"] == "A quarter car on a shaker"
    assert list(listed) == sorted(listed)


def test_compare_passes_everything_on(call, monkeypatch, tmp_path):
    asked = {}
    comparison = SimpleNamespace(
        verdict="different", as_text=lambda: "different", as_junit=lambda: "<testsuite/>"
    )

    def compare(result, reference, **options):
        asked.update(options)
        return comparison

    monkeypatch.setattr(vehicledyn, "compare", compare)
    junit = tmp_path / "report.xml"
    options = ("--relative", "1e-3", "--tolerance", "a=b.*=0.1", "--channel", "x.*")
    code, out, _ = call("compare", "a.h5", "b.h5", *options, "--junit", junit)
    assert (code, out) == (1, "different\n")
    assert asked["relative"] == 1e-3
    assert asked["tolerances"] == {"a=b.*": 0.1}
    assert asked["channels"] == ["x.*"]
    assert junit.read_text() == "<testsuite/>\n"


def test_plot_prints_what_it_wrote(call, monkeypatch):
    def save_requested(data, folder, *, patterns, against, formats):
        assert (list(data), folder) == (["a", "b"], Path("runs/a_and_b_plots"))
        assert (patterns, against) == (["yaw"], "chassis.x")
        return [folder / f"yaw.{end}" for end in formats]

    here = "vehicledyn.results.labelled."
    requested = SimpleNamespace(save_requested=save_requested)
    monkeypatch.setitem(sys.modules, f"{here}requested", requested)
    monkeypatch.setitem(sys.modules, f"{here}data", SimpleNamespace(open_result=str))
    options = ("--only", "yaw", "--against", "chassis.x", "--format", "svg")
    code, out, _ = call("plot", "runs/a.h5", "runs/b.h5", *options)
    assert (code, out) == (0, "runs/a_and_b_plots/yaw.svg\n")
    assert call("plot", "a.h5", "--against", "chassis.x")[0] == 2


class Stream:
    """A standard error that says whether it is a terminal."""

    def __init__(self, *, terminal):
        self.terminal, self.text = terminal, ""

    def isatty(self):
        return self.terminal

    def write(self, text):
        self.text += text

    def flush(self):
        pass


@pytest.mark.parametrize(
    ("terminal", "options", "shown"),
    [
        (True, {}, "\r\x1b[2Kderive ...\r\x1b[2K"),
        (True, {"quiet": True}, ""),
        (False, {}, ""),
        (False, {"verbose": True}, "derive\n"),
    ],
)
def test_progress_is_shown_on_a_terminal_only(monkeypatch, terminal, options, shown):
    stream = Stream(terminal=terminal)
    monkeypatch.setattr(sys, "stderr", stream)
    progress = Progress(**options)
    progress("derive")
    progress("derive")
    progress.clear()
    assert stream.text == shown


def test_progress_with_a_known_part_is_a_bar_with_the_time_left(monkeypatch):
    """Each phase has a bar of its own, also one whose text changes as it goes on."""
    stream = Stream(terminal=True)
    clock = itertools.count(step=1.0)
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setattr("time.monotonic", lambda: float(next(clock)))
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "90")
    progress = Progress()
    for done in (0.1, 0.3, 0.5):
        progress(f"case {10 * done:.0f} of 10", done)
    first = stream.text
    assert "case 5 of 10" in first and "\u2501" in first and " 50%" in first
    assert re.search(r"0:\d\d:\d\d", first)
    progress("draw")
    progress("simulate", 0.2)
    progress.clear()
    second = stream.text[len(first) :]
    assert "draw ..." in second and " 20%" in second and "-:--:--" in second
    assert "\x1b[?25l" not in second[second.rindex("\x1b[?25h") :]


def test_json_has_no_numbers_that_json_lacks():
    assert json.loads(to_json({"a": [float("inf"), (1, 2.5)], 3: Path("x")})) == {
        "a": [None, [1, 2.5]],
        "3": "x",
    }
