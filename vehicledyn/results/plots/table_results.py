"""What the files of tables hold: describe them, draw them again."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vehicledyn.results.plots.cams.cam_figures import cam_figures
from vehicledyn.results.plots.contact_figures import contact_figures
from vehicledyn.results.plots.handling.test_figures import handling_figures
from vehicledyn.results.plots.hunt_figures import hunt_figures
from vehicledyn.results.plots.linear.bode import bode_figures
from vehicledyn.results.plots.linear.mode_figures import mode_figures
from vehicledyn.results.plots.manoeuvre_figures import manoeuvre_figures
from vehicledyn.results.plots.parameter_figures import (
    identification_figures,
    optimum_figures,
    uncertainty_figures,
)
from vehicledyn.results.plots.sensitivity_figures import sensitivity_figures
from vehicledyn.results.plots.track_figures import track_figures
from vehicledyn.results.plots.tyres.tyre_figures import tyre_figures
from vehicledyn.results.store.linear_file import format_of
from vehicledyn.results.tables import (
    cam_table,
    contact_table,
    equilibrium_table,
    handling_table,
    hunt_table,
    identification_table,
    manoeuvre_table,
    mode_table,
    optimum_table,
    response_table,
    sensitivity_table,
    track_table,
    tyre_table,
    uncertainty_table,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class TableKind:
    """What is said of a kind of file, ``facts`` by name, and what is drawn of it."""

    facts: Callable[[Path], dict[str, Any]]
    figures: Callable[[Path], Iterator[tuple[str, Figure]]]


@dataclass(frozen=True)
class TableDescription:
    """Facts of a file by name, for people and programs."""

    path: str
    facts: dict[str, Any]

    def as_dict(self) -> dict[str, Any]:
        """Return plain data that JSON can hold."""
        return {"path": self.path, **self.facts}

    def as_text(self) -> str:
        """Return lines for a person."""
        rows = []
        for name, value in self.facts.items():
            listed = ", ".join(map(str, value)) if isinstance(value, list) else value
            rows.append(f"  {name:12}  {listed}")
        return "\n".join([self.path, *rows])


def holds_table(path: Path) -> bool:
    """Return whether a file holds the table of an analysis, neither a run nor a sweep."""
    return format_of(path) in TABLES


def describe_table(path: Path) -> TableDescription:
    """Return what the file of a table holds."""
    return TableDescription(str(path), TABLES[format_of(path)].facts(path))


def table_figures(path: Path) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure of all there is to draw of the file of a table."""
    return TABLES[format_of(path)].figures(path)


def _mode_facts(path: Path) -> dict[str, Any]:
    modes = mode_table.read_modes(path)
    return {
        "holds": "eigenmodes and mode shapes",
        "title": modes.title,
        "model": modes.model,
        "cases": [case.label or "as given" for case in modes.cases],
        "modes": [len(case.kind) for case in modes.cases],
        "states": len(modes.states),
        "channels": len(modes.channels),
    }


def _response_facts(path: Path) -> dict[str, Any]:
    table = response_table.read_response(path)
    first, last = table.frequency[0], table.frequency[-1]
    return {
        "holds": "frequency responses",
        "title": table.title,
        "model": table.model,
        "speed": f"{table.speed:g} m/s",
        "frequencies": f"{len(table.frequency)} frequencies from {first:g} to {last:g} Hz",
        "inputs": [f"{item.name} [{item.unit}]" for item in table.inputs],
        "outputs": [f"{item.name} [{item.unit}]" for item in table.outputs],
    }


def _equilibrium_facts(table: equilibrium_table.EquilibriumTable) -> dict[str, Any]:
    """Return what a file of an equilibrium holds."""
    return {
        "holds": "an equilibrium",
        "title": table.title,
        "model": table.model,
        "speed": f"{table.speed:g} m/s",
        "residual": f"{table.residual:.1e}",
        "stability": table.stability,
        "coordinates": len(table.coordinates),
        "forces": len(table.forces),
        "other channels": len(table.channels),
    }


def _sensitivity_facts(table: sensitivity_table.SensitivityTable) -> dict[str, Any]:
    """Return what a file of derivatives holds."""
    return {
        "holds": "derivatives by parameters",
        "title": table.title,
        "model": table.model,
        "parameters": len(table.parameters),
        "figures": [f"{item.name} [{item.unit}]" for item in table.figures],
        "channels": [f"{item.name} [{item.unit}]" for item in table.channels],
        "notes": list(table.notes),
    }


def _contact_facts(path: Path) -> dict[str, Any]:
    contacts = contact_table.read_contacts(path)
    first, last = 1e3 * contacts.shift[0], 1e3 * contacts.shift[-1]
    return {
        "holds": "contact geometry of wheel and rail",
        "title": contacts.title,
        "wheel": contacts.wheel,
        "rail": contacts.rail,
        "settings": [f"{name} {value:.6g}" for name, value in contacts.settings.items()],
        "shifts": f"{len(contacts.shift)} shifts from {first:g} to {last:g} mm",
        "jumps": len(contacts.jumps),
        "amplitudes": len(contacts.amplitude),
        "notes": list(contacts.notes),
    }


def _hunt_facts(table: hunt_table.HuntTable) -> dict[str, Any]:
    """Return what a hunting study holds."""
    return {
        "holds": "limit cycles along a parameter",
        "title": table.title,
        "model": table.model,
        "status": f"{table.status} {table.message}".strip(),
        "parameter": f"{table.parameter.name} [{table.parameter.unit}]",
        "equilibria": len(table.locus_values),
        "cycles": [f"branch {n}: {len(table.branch(n))}" for n in table.branches],
        "channels": [f"{item.name} [{item.unit}]" for item in table.channels],
        **{
            name: " ".join(
                filter(None, (f"{value:.6g}", table.figure_unit(name), table.means.get(name)))
            )
            for name, value in table.figures.items()
        },
    }


def _handling_facts(path: Path) -> dict[str, Any]:
    table = handling_table.read_handling(path)
    return {
        "holds": "handling of a road vehicle",
        "title": table.title,
        "model": table.model,
        "curves": [name.replace("_", " ") for name in table.sheets],
        **{figure.key: f"{figure.value:.6g} {figure.unit}".strip() for figure in table.figures},
        "notes": list(table.notes),
    }


def _cam_facts(path: Path) -> dict[str, Any]:
    table = cam_table.read_cam(path)
    listed = {name: f"{value:.6g} {unit}" for name, (value, unit, _) in table.figures.items()}
    return {
        "holds": "a cam over a turn",
        "title": table.title,
        "follower": table.follower,
        "angles": len(table.angle),
        "columns": [f"{name} [{column.unit}]" for name, column in table.columns.items()],
        **listed,
        "notes": list(table.notes),
    }


def _tyre_facts(path: Path) -> dict[str, Any]:
    tables = tyre_table.read_tyres(path)
    return {
        "holds": "forces of tyres",
        "title": ", ".join(table.title for table in tables),
        "loads": [f"{load:g} N" for load in tables[0].loads],
        "curves": list(tables[0].sweeps),
    }


def _track_facts(path: Path) -> dict[str, Any]:
    table = track_table.read_track_table(path)
    return {
        "holds": "a railway track along its chainage",
        "title": table.title,
        "track": list(table.facts),
        "places": len(table["s"]),
        "columns": [f"{name} [{column.unit}]" for name, column in table.columns.items()],
    }


def _of(read: Callable[[Path], Any], do: Callable[[Any], Any]) -> Callable[[Path], Any]:
    """Return a function of a file that does something with what is read from it."""
    return lambda path: do(read(path))


TABLES = {
    mode_table.FORMAT: TableKind(_mode_facts, _of(mode_table.read_modes, mode_figures)),
    response_table.FORMAT: TableKind(
        _response_facts, _of(response_table.read_response, bode_figures)
    ),
    contact_table.FORMAT: TableKind(
        _contact_facts, _of(contact_table.read_contacts, contact_figures)
    ),
    hunt_table.FORMAT: TableKind(
        _of(hunt_table.read_hunt, _hunt_facts), _of(hunt_table.read_hunt, hunt_figures)
    ),
    equilibrium_table.FORMAT: TableKind(
        _of(equilibrium_table.read_equilibrium, _equilibrium_facts), lambda _: iter(())
    ),
    sensitivity_table.FORMAT: TableKind(
        _of(sensitivity_table.read_sensitivity, _sensitivity_facts),
        _of(sensitivity_table.read_sensitivity, sensitivity_figures),
    ),
    optimum_table.FORMAT: TableKind(
        optimum_table.describe_optimum, _of(optimum_table.read_course, optimum_figures)
    ),
    manoeuvre_table.FORMAT: TableKind(
        _of(manoeuvre_table.read_manoeuvre, manoeuvre_table.describe_manoeuvre),
        _of(manoeuvre_table.read_manoeuvre, manoeuvre_figures),
    ),
    identification_table.FORMAT: TableKind(
        identification_table.describe_identification,
        _of(identification_table.read_identification, identification_figures),
    ),
    uncertainty_table.FORMAT: TableKind(
        uncertainty_table.describe_uncertainty,
        _of(uncertainty_table.read_uncertainty, uncertainty_figures),
    ),
    handling_table.FORMAT: TableKind(
        _handling_facts, lambda path: handling_figures([handling_table.read_handling(path)])
    ),
    cam_table.FORMAT: TableKind(_cam_facts, _of(cam_table.read_cam, cam_figures)),
    tyre_table.FORMAT: TableKind(_tyre_facts, _of(tyre_table.read_tyres, tyre_figures)),
    track_table.FORMAT: TableKind(_track_facts, _of(track_table.read_track_table, track_figures)),
}
"""What is said and drawn of the files of tables, by their format."""
