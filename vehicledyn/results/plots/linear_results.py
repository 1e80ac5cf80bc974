"""What files of modes, responses and contact geometry hold: describe them, draw them again."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.results.plots.contact_figures import contact_figures
from vehicledyn.results.plots.hunt_figures import hunt_figures
from vehicledyn.results.plots.linear.bode import bode_figures
from vehicledyn.results.plots.linear.mode_figures import mode_figures
from vehicledyn.results.plots.parameter_figures import (
    identification_figures,
    optimum_figures,
    uncertainty_figures,
)
from vehicledyn.results.plots.picture_files import save_figures
from vehicledyn.results.plots.plot_style import STYLE
from vehicledyn.results.plots.sensitivity_figures import sensitivity_figures
from vehicledyn.results.store.linear_file import format_of
from vehicledyn.results.tables import (
    contact_table,
    equilibrium_table,
    hunt_table,
    identification_table,
    mode_table,
    optimum_table,
    response_table,
    sensitivity_table,
    uncertainty_table,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = (
    mode_table.FORMAT,
    response_table.FORMAT,
    contact_table.FORMAT,
    hunt_table.FORMAT,
    equilibrium_table.FORMAT,
    sensitivity_table.FORMAT,
    optimum_table.FORMAT,
    identification_table.FORMAT,
    uncertainty_table.FORMAT,
)


@dataclass(frozen=True)
class LinearDescription:
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
            told = ", ".join(map(str, value)) if isinstance(value, list) else value
            rows.append(f"  {name:12}  {told}")
        return "\n".join([self.path, *rows])


def is_linear(path: Path) -> bool:
    """Return whether a file holds eigenmodes, frequency responses or contact geometry."""
    return format_of(path) in FORMATS


def describe_linear(path: Path) -> LinearDescription:
    """Return what a file of eigenmodes, frequency responses or contact geometry holds."""
    facts: dict[str, Callable[[Path], dict[str, Any]]] = {
        contact_table.FORMAT: _contact_facts,
        mode_table.FORMAT: _mode_facts,
        optimum_table.FORMAT: optimum_table.describe_optimum,
        identification_table.FORMAT: identification_table.describe_identification,
        uncertainty_table.FORMAT: uncertainty_table.describe_uncertainty,
        sensitivity_table.FORMAT: lambda p: _sensitivity_facts(
            sensitivity_table.read_sensitivity(p)
        ),
        hunt_table.FORMAT: lambda p: _hunt_facts(hunt_table.read_hunt(p)),
        equilibrium_table.FORMAT: lambda p: _equilibrium_facts(
            equilibrium_table.read_equilibrium(p)
        ),
    }
    return LinearDescription(str(path), facts.get(format_of(path), _response_facts)(path))


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


def draw_linear(
    path: Path,
    folder: Path,
    names: Sequence[str] | None = None,
    formats: Sequence[str] = ("png", "svg"),
) -> list[Path]:
    """Draw the figures of such a file, all or those of some names; return where they are.

    Raises
    ------
    InputError
        If the file cannot be read, a name is unknown or a picture cannot be written.
    """
    import matplotlib

    with matplotlib.rc_context(STYLE):
        figures = dict(linear_figures(path))
    for name in names or ():
        if name not in figures:
            raise InputError(f"{path}: {unknown_name('figure', name, figures)}")
    if not figures:
        raise InputError(f"{path}: holds numbers only, there is nothing to draw")
    chosen = [(name, figures[name]) for name in names or figures]
    return save_figures(chosen, folder, formats)


def linear_figures(path: Path) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure of all there is to draw of such a file."""
    if format_of(path) == mode_table.FORMAT:
        yield from mode_figures(mode_table.read_modes(path))
    elif format_of(path) == hunt_table.FORMAT:
        yield from hunt_figures(hunt_table.read_hunt(path))
    elif format_of(path) == contact_table.FORMAT:
        yield from contact_figures(contact_table.read_contacts(path))
    elif format_of(path) == sensitivity_table.FORMAT:
        yield from sensitivity_figures(sensitivity_table.read_sensitivity(path))
    elif format_of(path) == identification_table.FORMAT:
        yield from identification_figures(identification_table.read_identification(path))
    elif format_of(path) == uncertainty_table.FORMAT:
        yield from uncertainty_figures(uncertainty_table.read_uncertainty(path))
    elif format_of(path) == optimum_table.FORMAT:
        yield from optimum_figures(optimum_table.read_course(path))
    elif format_of(path) != equilibrium_table.FORMAT:
        yield from bode_figures(response_table.read_response(path))
