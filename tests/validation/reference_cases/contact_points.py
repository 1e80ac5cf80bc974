"""Contact points of a disc on flat, inclined and wavy ground."""

from __future__ import annotations

import math

import numpy as np
from contact_search import find_contact

from reference_cases.comparison import Group, deviation
from reference_cases.tables import read_rows
from vehicledyn.road.surfaces.flat import Flat
from vehicledyn.road.surfaces.plane import Plane
from vehicledyn.road.surfaces.sine import Sine

ROADS = {
    "flat": Flat(),
    "plane": Plane(slope_x=0.05, slope_y=-0.08),
    "wavy": Sine(amplitude_x=0.05, wavelength_x=2.0, amplitude_y=0.03, wavelength_y=3.0),
}
RADIUS = 0.33  # m
BAND = 1e-8  # m, asked of the program; the table has ten digits
VECTORS = {"position": "disc_P", "longitudinal": "ex_", "lateral": "elat_", "normal": "n_"}
SCALARS = {"loaded_radius": "disc_r", "deflection": "disc_defl"}


CROWN = 0.1  # m


def rows(shape="disc"):
    """Return the rows of the table of a disc or a torus as texts."""
    return read_rows(f"contact_point_{shape}.csv")


def deviations_of_torus(row):
    """Return the deviations of a row's contact point and deflection [m]."""
    contact = find_contact(ROADS[row["road"]], *pose(row), RADIUS, crown=CROWN)
    wanted = [float(row[f"torus_P{k}"]) for k in "xyz"]
    return {
        "position": float(np.abs(np.array(contact.position) - wanted).max()),
        "deflection": abs(contact.deflection - float(row["torus_pen"])),
    }


def pose(row):
    """Return wheel centre [m] and spin axis of a row."""
    yaw, camber = math.radians(float(row["yaw_deg"])), math.radians(float(row["camber_deg"]))
    axis = [
        -math.sin(yaw) * math.cos(camber),
        math.cos(yaw) * math.cos(camber),
        math.sin(camber),
    ]
    return [float(row[f"C{k}"]) for k in "xyz"], axis


def deviations(row):
    """Return the deviation of each quantity of a row: lengths [m], directions [1], camber [deg]."""
    contact = find_contact(ROADS[row["road"]], *pose(row), RADIUS)
    found = {
        name: float(
            np.abs(np.array(getattr(contact, name)) - [float(row[column + k]) for k in "xyz"]).max()
        )
        for name, column in VECTORS.items()
    }
    for name, column in SCALARS.items():
        found[name] = abs(getattr(contact, name) - float(row[column]))
    found["camber"] = abs(math.degrees(contact.camber) - float(row["road_camber_deg"]))
    return found


def compare():
    """Return the comparisons, by road."""
    found = []
    for road in ROADS:
        chosen = [deviations(row) for row in rows() if row["road"] == road]
        for name in ("position", "deflection"):
            found.append(
                deviation(
                    "independent root finder, 1e-13",
                    f"{road} road: {name}",
                    reference=f"{len(chosen)} poses of a disc",
                    largest=max(item[name] for item in chosen),
                    band=BAND,
                    unit="m",
                )
            )
    return Group("Road: contact point of a disc", "Band: as asked of the program.", tuple(found))
