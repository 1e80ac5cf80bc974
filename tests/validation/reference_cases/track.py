"""Tracks against closed forms, their irregularities against spectra, and what rides along."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from scipy.integrate import quad
from scipy.optimize import least_squares
from scipy.signal import welch
from scipy.special import fresnel

from reference_cases.comparison import Group, deviation, figure
from vehicledyn.files.building.construct import build_system
from vehicledyn.files.building.road_choice import RoadChoice
from vehicledyn.files.system.read import read_system
from vehicledyn.multibody import derive
from vehicledyn.rail.irregularities.erri_b176 import ErriB176, spectra
from vehicledyn.rail.track.alignment import Alignment
from vehicledyn.rail.track.pieces import Grade, TrackPiece
from vehicledyn.rail.track.track import Track
from vehicledyn.rail.track.track_tables import centre_line
from vehicledyn.symbolic import ops

DATA = Path(__file__).parents[1] / "data"
FRESNEL, HELIX, SPECTRUM = "Fresnel integrals", "helix", "integral of the spectrum"
STATICS, KLINGEL = "equilibrium on a circle", "Redtenbacher's formula"
BASE = 1.5
RADIUS, LENGTH = 300.0, 60.0


def compare():
    """Return the comparisons."""
    note = (
        "Bands: the error of the tables that is aimed at; of a wheelset 2 %, as a formula of "
        "first order has no contact that moves on the profiles. The spectrum is estimated from "
        "20 km by averages of 200 m: 2 % in the mean."
    )
    rows = (*_lines(), *_irregularities(), _rider(), _wheelset())
    return Group("Railway tracks", note, rows)


def _frames(line, places):
    s = ops.symbol("s")
    frame = line.frame(s)
    evaluate = ops.numeric([s], ops.stacked(frame.position, frame.rotation[:, 1]))
    return np.array([evaluate(place).ravel() for place in places])


def _lines():
    along = np.linspace(0.0, LENGTH, 121)
    pieces = [TrackPiece(17.3), TrackPiece(LENGTH, (0.0, 1.0 / RADIUS)), TrackPiece(9.0)]
    scale = math.sqrt(math.pi * RADIUS * LENGTH)
    sine, cosine = fresnel(along / scale)
    found = _frames(centre_line(Alignment(pieces, BASE))[0], 17.3 + along)
    wanted = np.stack([17.3 + scale * cosine, scale * sine], axis=1)
    yield deviation(
        FRESNEL,
        "clothoid to a curve of 300 m",
        reference="121 places",
        largest=np.abs(found[:, :2] - wanted).max(),
        band=1e-8,
        unit="m",
    )
    cant, slope, along = 0.15, 0.03, np.linspace(1.0, 399.0, 101)
    arc = TrackPiece(400.0, (1.0 / RADIUS,) * 2, (cant, cant))
    found = _frames(centre_line(Alignment([arc], BASE, [Grade(0.0, slope)]))[0], along)
    angle, lean, climb = along / RADIUS, math.asin(cant / BASE), math.atan(slope)
    wanted = [RADIUS * np.sin(angle), RADIUS * (1.0 - np.cos(angle)), slope * along]
    tilt = math.sin(climb) * math.sin(lean)
    wanted += [-np.sin(angle) * math.cos(lean) + np.cos(angle) * tilt]
    wanted += [np.cos(angle) * math.cos(lean) + np.sin(angle) * tilt]
    wanted += [np.full(along.shape, -math.cos(climb) * math.sin(lean))]
    yield deviation(
        HELIX,
        "graded and canted arc, places and axes",
        reference="101 places",
        largest=np.abs(found - np.array(wanted).T).max(),
        band=1e-8,
        unit="m or 1",
    )
    turn = math.pi * 250.0 - 40.0
    bend = 1.0 / 250.0
    half = [
        TrackPiece(123.456),
        TrackPiece(40.0, (0.0, bend), shape="bloss"),
        TrackPiece(turn, (bend, bend)),
        TrackPiece(40.0, (bend, 0.0), shape="bloss"),
    ]
    line, _ = centre_line(Alignment([*half, *half], BASE))
    yield deviation(
        "closed polygon",
        "end of an oval from its start",
        reference=f"{line.length:.0f} m",
        largest=np.abs(_frames(line, [line.length])[0, :3]).max(),
        band=1e-8,
        unit="m",
    )


def _irregularities():
    for level in ("low", "high"):
        record = ErriB176(level=level, seed=11, length=20_000.0, fade=0.0)
        values, step = record.records(), record.length / record.count
        band = 2.0 * math.pi / record.longest, 2.0 * math.pi / record.shortest
        for name, words in (("alignment", "alignment"), ("level", "level")):

            def density_of(w, level=level, name=name):
                return float(spectra(level, np.array(w))[name])

            variance, _ = quad(density_of, *band)
            yield figure(
                SPECTRUM,
                f"ERRI B 176, {level} level, {words}, root mean square",
                reference=1e3 * math.sqrt(variance),
                computed=1e3 * values[name].std(),
                band=1e-3 * 1e3 * math.sqrt(variance),
                unit="mm",
                digits=4,
            )
        frequency, density = welch(values["level"], 1.0 / step, nperseg=int(200.0 / step))
        omega = 2.0 * math.pi * frequency
        inside = (omega > 1.15 * band[0]) & (omega < 0.97 * band[1])
        ratio = density[inside] / (2.0 * math.pi) / spectra(level, omega[inside])["level"]
        yield figure(
            "Welch's estimate",
            f"ERRI B 176, {level} level, spectrum over that asked for",
            reference=1.0,
            computed=ratio.mean(),
            band=0.02,
            unit="",
            digits=3,
        )


def _equations(path, line, base=BASE):
    model, problems = read_system(path)
    if problems:
        raise ValueError("\n".join(map(str, problems)))
    track = Track(1.435, 0.014, math.atan(0.025), "60E1", line, (), base)
    return derive(build_system(model, RoadChoice(track=track)))


def _steady(equations, names, instant):
    """Return all channels where the named states make their accelerations vanish."""
    states = [state.name for state in equations.states]
    parameters = np.array([p.value for p in equations.parameters])
    inputs = [equations.time, equations.state, equations.parameter]
    start = np.array([state.start for state in equations.states])
    moved = [states.index(name) for name in names]
    rates = [k for k, name in enumerate(states) if name.endswith("_rate")]
    rate = equations.rate[rates]
    residual = ops.numeric(inputs, rate)
    slopes = ops.numeric(inputs, ops.jacobian(rate, equations.state)[:, moved])
    output = ops.numeric(inputs, equations.output)
    state = start.copy()

    def at(x):
        state[moved] = x
        return (instant, state, parameters)

    found = least_squares(
        lambda x: residual(*at(x)).ravel(),
        start[moved],
        jac=lambda x: slopes(*at(x)),
        x_scale=np.array([1.0 if n.endswith("_rate") else 1e-3 for n in names]),
        xtol=1e-15,
        ftol=1e-15,
        gtol=1e-15,
    )
    at(found.x)
    if not np.abs(found.fun).max() < 1e-6:
        raise ValueError(f"no steady running found, accelerations up to {np.abs(found.fun).max()}")
    values = output(instant, state, parameters).ravel()
    return dict(zip([c.name for c in equations.channels], values, strict=True))


def _rider():
    """A mass on a lateral spring, thrown out of a canted curve."""
    path = DATA / "rider_on_track.yaml"
    lean = math.asin(0.06)
    arc = TrackPiece(200.0, (1.0 / RADIUS,) * 2, (0.09, 0.09))
    found = _steady(
        _equations(path, centre_line(Alignment([arc], BASE))[0]), ["rider.y", "rider.z"], 5
    )
    y, z = 0.0, 1.0
    for _ in range(30):
        own = RADIUS - y * math.cos(lean) - z * math.sin(lean)
        thrown = (20.0 / RADIUS) ** 2 * own
        y = -(thrown * math.cos(lean) - 9.81 * math.sin(lean)) / 200.0
        z = 1.0 - (9.81 * math.cos(lean) + thrown * math.sin(lean)) / 200.0
    return figure(
        STATICS,
        "mass on a spring in a canted curve, shift",
        reference=1e3 * y,
        computed=1e3 * found["rider.y"],
        band=1e-5 * abs(1e3 * y),
        unit="mm",
        digits=6,
    )


def _wheelset():
    """A wheelset that nothing guides, in a curve whose cant balances its speed."""
    radius, speed = 1000.0, 20.0
    cant = BASE * math.sin(math.atan(speed**2 / (radius * 9.81)))
    arc = TrackPiece(400.0, (1.0 / radius,) * 2, (cant, cant))
    path = DATA / "curving_wheelset.yaml"
    equations = _equations(path, centre_line(Alignment([arc], BASE))[0])
    names = [f"wheelset.{n}" for n in ("x", "y", "z", "yaw", "roll")]
    found = _steady(equations, [*names, "wheelset.spin_rate"], 5.0)
    left, right = (
        {n: found[f"wheels.{side}.contact_1.{n}"] for n in ("rolling_radius", "place")}
        for side in ("left", "right")
    )
    across = 1.5 + left["place"] + right["place"]
    mean = 0.5 * (left["rolling_radius"] + right["rolling_radius"])
    difference = right["rolling_radius"] - left["rolling_radius"]
    return figure(
        KLINGEL,
        "elastic wheelset without guidance, curve of 1000 m, difference of rolling radii",
        reference=1e3 * across * mean / radius,
        computed=1e3 * difference,
        band=0.02 * 1e3 * across * mean / radius,
        unit="mm",
        digits=4,
    )
