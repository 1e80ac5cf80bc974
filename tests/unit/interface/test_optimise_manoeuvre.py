"""Optimal manoeuvres against closed forms, and what is refused."""

import contextlib
import math

import numpy as np
import pytest
from crg_files import crg
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

import vehicledyn as vd
from vehicledyn.analyse.optimal_control import solve
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.road.surfaces.opencrg import OpenCrgRoad
from vehicledyn.studies.manoeuvre_optimisation.file import load_manoeuvre

CART = """\
title: A mass on a line
bodies:
  cart: {joints: [{kind: T1, name: place}], mass: 2 kg}
"""
PLANE = """\
title: A mass on a plane
bodies:
  mass: {joints: [{kind: T1, name: x}, {kind: T2, name: y}], mass: 1 kg}
"""
PUSH = """\
title: From rest to rest
model: cart.yaml
controls:
  push: {input: force:cart.place, from: -4 N, to: 4 N}
minimise: time
duration: {from: 0.5 s, to: 10 s}
end: {cart.place: 1 m, cart.place_rate: 0}
intervals: 10
"""
ROUND = """\
title: Round a closed circle
model: plane.yaml
controls:
  fx: {input: force:mass.x, from: -12 N, to: 12 N}
  fy: {input: force:mass.y, from: -12 N, to: 12 N}
minimise: time
duration: {from: 5 s, to: 60 s, guess: 25 s}
start: {path.distance: 0}
end: {path.distance: 314.1592653589793 m}
periodic: {mass.x: 0, mass.y: 0, mass.x_rate: 0, mass.y_rate: 0}
path: {arc: {radius: 50 m}, closed: true, right: 0 m, left: 1 m, place: [mass.x, mass.y]}
limits: {"norm(fx, fy)": {to: 9.81 N}}
intervals: 24
accuracy: 1e-3
"""


CROSSED = "{at: 2 m, from: 1 m, to: 0}"
GATES = "{at: 2 m, from: 0, to: 1 m}, {at: 1 m, from: 0, to: 1 m}"


def study(folder, text):
    """Write a study and its models; return the study's path."""
    (folder / "cart.yaml").write_text(CART, encoding="utf-8")
    (folder / "plane.yaml").write_text(PLANE, encoding="utf-8")
    path = folder / "study.yaml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.long
def test_the_quickest_way_is_bang_bang(tmp_path):
    """With ±F on a mass the way d takes 2 sqrt(d m / F), half of it braking."""
    found = vd.optimise_manoeuvre(study(tmp_path, PUSH))
    assert found.kind == "manoeuvre"
    assert found.attributes["duration"] == pytest.approx(2.0 * math.sqrt(0.5), rel=1e-7)
    force = found["control_value"].values[:, 0]
    part = found["time"].values / found.attributes["duration"]
    assert force[part < 0.49] == pytest.approx(4.0, abs=1e-5)
    assert force[part > 0.51] == pytest.approx(-4.0, abs=1e-5)
    assert found.attributes["simulation_error"] < 1e-8


@pytest.mark.long
def test_the_least_effort_is_a_straight_line(tmp_path):
    """∫u² for a way d from rest to rest in T is 12 m² d² / T³, with a linear force."""
    text = PUSH.replace("minimise: time", "minimise: {integral_of_square(push): 1}")
    text = text.replace("duration: {from: 0.5 s, to: 10 s}", "duration: 3 s")
    found = vd.optimise_manoeuvre(study(tmp_path, text.replace("to: 4 N", "to: 4 N, rate: 9 N/s")))
    assert found.attributes["objective"] == pytest.approx(12.0 * 4.0 / 27.0, rel=1e-8)
    force, time = found["control_value"].values[:, 0], found["time"].values
    assert force == pytest.approx(12.0 / 9.0 - 24.0 / 27.0 * time, abs=1e-5)


@pytest.mark.long
def test_the_smoothest_force_has_the_least_jerk(tmp_path):
    """∫(u'/r)² from rest to rest without force at the ends is 720 m² d² / T⁵ r², u a cubic.

    The force is straight within an interval: above that by some 5 / n² of it, which is the
    best that steps of its rate can do.
    """
    text = PUSH.replace("minimise: time", "minimise: smoothness\nstart: {push: 0}")
    text = text.replace("duration: {from: 0.5 s, to: 10 s}", "duration: 3 s\nrefinements: 0")
    text = text.replace("rate: 0}", "rate: 0, push: 0}").replace("to: 4 N", "to: 4 N, rate: 9 N/s")
    text = text.replace("intervals: 10", "intervals: 40")
    found = vd.optimise_manoeuvre(study(tmp_path, text))
    least = 720.0 * 4.0 / 3.0**5 / 81.0
    assert 1.0 < found.attributes["objective"] / least < 1.0 + 6.0 / 40.0**2
    part = found["time"].values / 3.0
    force = 2.0 * (60.0 * part - 180.0 * part**2 + 120.0 * part**3) / 9.0
    assert found["control_value"].values[:, 0] == pytest.approx(force, abs=9e-3)  # h² u'' / 6


@pytest.mark.long
def test_the_energy_between_rests_is_that_lost(tmp_path):
    """Without friction the work of the force between two rests is zero, at a limit of the rate."""
    text = PUSH.replace("minimise: time", "minimise: {energy: 1, effort: 1e-3, time: 1}")
    limited = text + "limits: {cart.place_rate: {to: 0.5 m/s}}\n"
    found = vd.optimise_manoeuvre(study(tmp_path, limited))
    rate = found["state_value"].values[:, 1]
    assert rate.max() == pytest.approx(0.5, abs=1e-5)
    # 0.25 s to 0.5 m/s and from it at 2 m/s², the rest of the way at that speed
    assert found.attributes["duration"] == pytest.approx(2.25, rel=2e-3)


@pytest.mark.long
def test_a_friction_circle_round_a_circle(tmp_path):
    """The inner side of the corridor, at v² / r = the force over the mass, is quickest."""
    found = vd.optimise_manoeuvre(study(tmp_path, ROUND))
    assert found.attributes["duration"] == pytest.approx(
        2 * math.pi * math.sqrt(49 / 9.81), rel=1e-5
    )
    assert found["path_offset"].values == pytest.approx(1.0, abs=1e-3)
    first, last = found["state_value"].values[[0, -1]]
    assert last == pytest.approx(first, abs=1e-6)
    assert found.attributes["simulation_error"] < 1e-4


@pytest.mark.long
def test_a_moved_coordinate_is_a_control(tmp_path):
    """A trolley's place is driven; its load swings, and rests at the end as it should."""
    (tmp_path / "crane.yaml").write_text(
        "title: A crane\nbodies:\n"
        "  trolley: {joints: [{kind: T1, name: place, role: driven}], mass: 1 kg}\n"
        "  load: {parent: trolley, joints: [{kind: R2, name: angle}], mass: 1 kg, "
        "com: [0, 0, -1 m]}\n",
        encoding="utf-8",
    )
    text = """\
title: Move a load
model: crane.yaml
controls:
  place: {input: trolley.place, from: -0.1 m, to: 1 m, rate: 1 m/s, acceleration: 2 m/s^2}
minimise: time
duration: {from: 1 s, to: 5 s}
end: {place: 1 m, load.angle: 0, load.angle_rate: 0}
intervals: 16
refinements: 1
"""
    found = vd.optimise_manoeuvre(study(tmp_path, text))
    assert found["control_value"].values[-1, 0] == pytest.approx(1.0, abs=1e-6)
    assert np.abs(found["state_simulated"].values[-1]).max() < 1e-3
    assert found.attributes["duration"] > 2.0 * math.sqrt(0.5)  # the trolley alone


@pytest.mark.parametrize(
    ("old", "new", "match"),
    [
        ("force:cart.place", "force:cart.plaice", "controls.push.input.*did you mean 'cart.place'"),
        ("from: -4 N, to: 4 N", "from: 4 N, to: -4 N", r"yaml:4:9: controls.push: .* crossed"),
        ("from: -4 N, to: 4 N", "from: -4 m, to: 4 N", "wrong unit"),
        ("minimise: time", "minimise: fun", "'fun' is unknown"),
        ("minimise: time", "minimise: final(cart.plaice)", "did you mean 'cart.place'"),
        ("{cart.place: 1 m,", "{cart.plaice: 1 m,", r"study.yaml:7:20: end.cart.plaice: .*did you"),
        ("from: 0.5 s, to: 10 s", "from: 5 s, to: 1 s", "crossed"),
        ("intervals: 10", "intervals: 1", "at least 2"),
        ("intervals: 10", "colour: 10", "unknown key"),
        ("intervals: 10", "limits: {cart.place: {from: 2 m}}", "start.cart.place: is outside"),
        ("model: cart.yaml", "model: cart.yaml\nscenario: other.yaml", "either a model or"),
        ("cart.place_rate: 0}", "cart.place_rate: 0, push: 0}", "only controls with a rate"),
        ("intervals: 10", "periodic: [nothing]", "no state named 'nothing'"),
        ("from: -4 N, to: 4 N", "from: -4, to: 4 N", "4:9: controls.push: -4 has no unit"),
        ("from: -4 N, to: 4 N", "from: 4 N, to: 4 N", "4:9: .*nothing is left to choose"),
        ("to: 4 N", "to: 4 N, rate: .nan", "4:9: controls.push: rate: must be above zero"),
        ("input: force:cart.place", "input: {force:cart.place: .nan}", "4:17: .*must be finite"),
        ("push: {", "cart.place: {", "4:15: controls.cart.place: is a name of the model"),
        ("minimise: time", "minimise: {time: .nan}", "5:18: minimise.time: .* must be finite"),
        ("minimise: time", "minimise: {time: 0}", "5:11: minimise: all weights are zero"),
        ("to: 10 s", "to: 10 s, guess: 11 s", "6:11: duration: .*with the guess 11 s"),
        ("1 m,", ".nan,", "7:19: end.cart.place: nan is no number"),
        ("1 m,", "{},", "7:19: end.cart.place: needs from, to or both"),
        ("intervals: 10", "limits: {push: {from: 9 N}}", "8:16: limits.push: .*of the control"),
        ("intervals: 10", "step: .nan", "8:7: step: must be finite"),
        ("intervals: 10", "tolerance: 0", "8:12: tolerance: must be above zero"),
    ],
)  # fmt: skip
def test_what_means_nothing_is_refused(tmp_path, old, new, match):
    with pytest.raises(InputError, match=match):
        vd.optimise_manoeuvre(study(tmp_path, PUSH.replace(old, new)))


@pytest.mark.parametrize(
    ("new", "match"),
    [
        ("path: {straight: {length: -1 m}", "above zero"),
        ("path: {straight: {length: 9 m}, right: -2 m, left: 1 m", "no width"),
        ("path: {straight: {length: 9 m}, right: -2 m, left: 3 m", "outside the corridor"),
        ("path: {file: nothing.csv", "nothing.csv"),
        ("end: {path.distance: 30 m}\npath: {straight: {length: 9 m}", "8:22: .* 30 m is too far"),
        (f"path: {{straight: {{length: 9 m}}, gates: [{GATES}]", "order"),
        (f"path: {{straight: {{length: 9 m}}, gates: [{CROSSED}]", "8:41: path.gates.*crossed"),
        ("path: {straight: {length: 9}", "8:18: path.straight: 9 has no unit"),
        ("path: {straight: {length: 9 m}, left: 1 s", "8:39: path.left: '1 s' has the wrong unit"),
        ("path: {straight: {length: 9 m}, left: .nan", "8:39: path.left: .*finite"),
        ("path: {straight: {length: 9 m}, closed: no thanks", "8:41: path.closed: .*true or false"),
        ("path: {opencrg: {file: road.crg}", "8:17: path.opencrg: expected the name of a file"),
        ("end: {path.distance: -1 m}\nstart: {path.distance: 0}\npath: {straight: {length: 9 m}",
         "8:22: end.path.distance: is not beyond the start at 0 m"),
    ],
)  # fmt: skip
def test_paths_that_cannot_be_followed_are_refused(tmp_path, new, match):
    text = ROUND[: ROUND.index("start:")] + new + ", place: [mass.x, mass.y]}\n"
    with pytest.raises(InputError, match=match):
        vd.optimise_manoeuvre(study(tmp_path, text))


@pytest.mark.parametrize("length", [252, 5000])
def test_names_too_long_for_files_are_refused(tmp_path, length):
    name = length * "x"
    for given in (name, study(tmp_path, PUSH.replace("cart.yaml", name))):
        with pytest.raises(InputError, match="names no file: File name too long"):
            vd.optimise_manoeuvre(given)
    with pytest.raises(InputError, match="names no file: File name too long"):
        vd.simulate(name)


def test_what_cannot_be_done_in_time_fails_and_is_kept(tmp_path):
    """One metre in half a second is too much for the force; the last point stays in the file."""
    path = study(tmp_path, PUSH.replace("to: 10 s", "to: 1 s"))
    with pytest.raises(NumericalError, match=r"no optimum was found.*holds the last point"):
        vd.optimise_manoeuvre(path, save_to=tmp_path / "out.h5")
    kept = vd.open_result(tmp_path / "out.h5")
    assert (kept.status, kept.is_whole) == ("failed", False)
    assert "cannot all be kept" in kept.status_message
    assert np.isnan(kept["state_simulated"].values).all()


DRY = (
    CART
    + """\
forces:
  dry: {coordinate: cart.place, force: "-min(1 N, max(-1 N, 1e3 N*s/m * cart.place_rate))"}
"""
)


@pytest.mark.long
def test_a_search_that_is_stopped_again_and_again_finds_the_same(tmp_path, monkeypatch):
    """It is stopped behind each mesh, the last time while the motion is simulated."""
    text = PUSH.replace(
        "intervals: 10", "intervals: 4\nrefinements: 2\naccuracy: 2e-3\nmost_iterations: 60"
    )
    path = study(tmp_path, text)
    (tmp_path / "cart.yaml").write_text(DRY, encoding="utf-8")
    whole = vd.optimise_manoeuvre(path, save_to=tmp_path / "whole.h5")
    out, searches, searched = tmp_path / "out.h5", [], solve._searched
    kept = tmp_path / "out.h5.checkpoint"

    def stop(text, _):
        if len(searches) > 1 or (searches and "simulating" in text):
            raise KeyboardInterrupt

    def counted(*given):
        searches.append(given)
        return searched(*given)

    monkeypatch.setattr(solve, "_searched", counted)
    for number in range(50):
        searches.clear()
        with contextlib.suppress(KeyboardInterrupt):
            found = vd.optimise_manoeuvre(path, save_to=out, resume=number > 0, progress=stop)
            break
        assert kept.is_file() and not out.exists()
    assert number == 3
    assert not kept.exists()
    for name in ("state_value", "control_value", "state_simulated", "iteration_objective", "time"):
        assert np.array_equal(found[name].values, whole[name].values), name
    assert found.attributes.keys() == whole.attributes.keys()
    for name in ("duration", "objective", "violation", "simulation_error"):
        assert found.attributes[name] == whole.attributes[name]
    assert found.notes == whole.notes


def test_a_search_goes_on_along_the_same_path_only(tmp_path):
    text = PUSH + "path: {file: way.csv, place: [cart.place, cart.place]}\n"
    path, way = study(tmp_path, text), tmp_path / "way.csv"
    rows = "x [m], y [m]\n0, 0\n1, 1\n2, 2\n3, 3\n"

    def stop(text, _):
        if text.startswith("iteration"):
            raise KeyboardInterrupt

    way.write_text(rows)
    with pytest.raises(KeyboardInterrupt):
        vd.optimise_manoeuvre(path, save_to=tmp_path / "out.h5", progress=stop)
    way.write_text(rows.replace("3, 3", "3, 4"))
    with pytest.raises(InputError, match="belongs to another computation"):
        vd.optimise_manoeuvre(path, save_to=tmp_path / "out.h5", resume=True)


@pytest.mark.long
@pytest.mark.parametrize("kind", ["file", "opencrg"])
def test_paths_of_files(tmp_path, kind):
    """A straight of 9 m in a file, 1 m wide to both sides: it ends as far left as may be."""
    if kind == "file":
        rows = "".join(f"{k}, 0, 1, 1\n" for k in range(10))
        (tmp_path / "road.csv").write_text("x [m], y [m], right [m], left [m]\n" + rows)
        path = "file: road.csv"
    else:
        (tmp_path / "road.crg").write_bytes(crg(np.zeros((10, 5))))
        path = "opencrg: road.crg"
    text = f"""\
title: Keep to the left
model: plane.yaml
controls:
  fx: {{input: force:mass.x, from: -12 N, to: 12 N}}
  fy: {{input: force:mass.y, from: -12 N, to: 12 N}}
minimise: {{effort: 1, final(mass.y): -100}}
duration: 3 s
end: {{path.distance: 8 m}}
path: {{{path}, place: [mass.x, mass.y]}}
intervals: 6
"""
    found = vd.optimise_manoeuvre(study(tmp_path, text))
    left = found["path_left_side"].values[-1]
    assert left == pytest.approx(1.0, abs=1e-9)
    assert found["path_offset"].values[-1] == pytest.approx(left, abs=1e-6)
    assert found["path_distance"].values[-1] == pytest.approx(8.0, abs=1e-6)
    at = list(found["state_value"].coords["state"]).index("mass.y")
    assert found["state_value"].values[-1, at] == pytest.approx(left, abs=1e-6)


@pytest.mark.parametrize("origin", ["reference_line", "file"])
def test_an_opencrg_path_lies_where_the_road_of_the_scenario_lies(tmp_path, origin):
    """Not with its first right corner at zero, as files without modifiers do."""
    phi = np.linspace(0.3, 0.6, 20)
    (tmp_path / "road.crg").write_bytes(crg(np.zeros((21, 5)), phi=np.append(phi, phi[-1])))
    (tmp_path / "car.yaml").write_text(
        f"title: A car\nmodel: small_car\nmanoeuvre: {{kind: straight}}\nspeed: 9 m/s\n"
        f"duration: 1 s\nroad: {{kind: opencrg, file: road.crg, origin: {origin}}}\n"
        "solver: {kind: rk4, step: 1 ms}\noutput: {interval: 10 ms}\n"
    )
    controls = "drive: {input: force:rear_left_wheel.spin, from: -1 N*m, to: 1 N*m}"
    text = PUSH.replace("model: cart.yaml", "scenario: car.yaml").split("controls:")[0]
    text += f"controls: {{{controls}}}\nminimise: time\nduration: {{from: 1 s, to: 3 s}}\n"
    text += "end: {path.distance: end}\npath: {opencrg: road.crg, left: 0.4 m}\n"
    loaded = load_manoeuvre(study(tmp_path, text))
    road, track = OpenCrgRoad.read(tmp_path / "road.crg", origin, "linear").road, loaded.track
    inside = (track.distance > 0.0) & (track.distance < track.length)
    u, v = road.road_place(track.x[inside], track.y[inside])
    assert np.abs(v).max() < 2e-3
    assert u == pytest.approx(track.distance[inside], abs=2e-2)
    assert (track.right.max(), track.left.max()) == (1.0, 0.4)
    assert float(loaded.end["path.distance"].split()[0]) == track.length


def test_long_paths_keep_their_bends(tmp_path):
    """240 rows for three kilometres with bends of 40 m missed places by a metre."""
    turned = np.linspace(0.0, 2.0 * np.pi, 2001)[:-1]
    radius = 400.0 * (1.0 + 0.25 * np.cos(3.0 * turned) + 0.03 * np.cos(23.0 * turned))
    places = radius[:, None] * np.column_stack([np.cos(turned), np.sin(turned)])
    rows = "".join(f"{x!r}, {y!r}\n" for x, y in places.tolist())
    (tmp_path / "track.csv").write_text("x [m], y [m]\n" + rows)
    road = "path: {file: track.csv, closed: true, place: [mass.x, mass.y]}"
    track = load_manoeuvre(study(tmp_path, f"{ROUND.split('path:', maxsplit=1)[0]}{road}\n")).track
    curve = CubicSpline(track.distance, np.column_stack([track.x, track.y]))
    fine = curve(np.linspace(0.0, track.length, 300_000))
    assert cKDTree(fine).query(places)[0].max() < 0.02
