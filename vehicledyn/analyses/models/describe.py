"""The verb "models show": structure, coordinates and operation counts of a model."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from typing import Any, cast

from vehicledyn.analyses.models.assembly_tree import assemblies_as_data, assembly_lines
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.prepare import prepare
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.files.building.python_systems import system_as_yaml
from vehicledyn.files.building.write import model_as_yaml
from vehicledyn.files.scenario.target import Target
from vehicledyn.files.system.assemblies.read import Assembly
from vehicledyn.files.system.read import SystemModel
from vehicledyn.kernel.kernel import KernelReport
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.symbolic.equations import Equations, ParameterValue


@dataclass(frozen=True)
class ModelReport:
    """What a model is made of and what its equations cost."""

    summary: str
    equations: Equations
    kernel: str
    report: KernelReport
    assemblies: tuple[Assembly, ...] = ()

    def as_text(self) -> str:
        """Return the report as text."""
        s = self.equations.structure
        parts = [
            f"{self.equations.name}: {self.summary}",
            "",
            f"{s['degrees_of_freedom']} degrees of freedom, {len(s['bodies'])} bodies, "
            f"{len(s['cuts'])} loop cuts, {len(self.equations.parameters)} parameters, "
            f"{len(self.equations.channels)} channels",
            "",
            *assembly_lines(self.assemblies),
            "bodies",
            *(_body_line(b) for b in s["bodies"]),
            "",
            *_listed("independent coordinates", s["independent"]),
            *_listed("dependent coordinates", s["dependent"]),
            *_listed("driven coordinates", s["driven"]),
            *_listed("loops, in the order of solution", [", ".join(c) for c in s["loops"]], "; "),
            *_listed("redundant constraints", s["redundant"]),
            *_listed(
                "loops without freedom",
                [", ".join(r["constraints"]) for r in s["rigid_loops"]],
                "; ",
            ),
            *_listed("forces of constraints that are not unique", s["undetermined"]),
            *_listed("parts", s["parts"]),
            *_table("parameters", [_parameter_row(p) for p in self.equations.parameters]),
            *_table("channels", [(c.name, c.unit, c.description) for c in self.equations.channels]),
            f"operations ({self.kernel})",
            *(f"  {name:12} {count}" for name, count in self.report.operations.items()),
        ]
        return "\n".join(parts)

    def as_dict(self) -> dict[str, Any]:
        """Return the report as plain data."""
        e = self.equations
        return {
            "name": e.name,
            "summary": self.summary,
            **e.structure,
            "assemblies": assemblies_as_data(self.assemblies),
            "states": [{"name": v.name, "unit": v.unit, "start": v.start} for v in e.states],
            "parameters": {
                p.name: {"value": p.value, "unit": p.unit, "description": p.description}
                for p in e.parameters
            },
            "channels": {
                c.name: {"unit": c.unit, "description": c.description, "frame": c.frame}
                for c in e.channels
            },
            "kernel": self.kernel,
            "operations": self.report.operations,
            "generation_seconds": self.report.generation_seconds,
            "compilation_seconds": self.report.compilation_seconds,
        }


def describe_model(target: Target, *, backend: Backend, progress: Progress) -> ModelReport:
    """Return what a model is made of, of the catalogue with its standard parts."""
    prepared = prepare(target, backend=backend, progress=progress)
    kernel, written = prepared.kernel, target.written
    return ModelReport(
        written.title, prepared.equations, kernel.description, kernel.report, written.assemblies
    )


def write_system(target: Target) -> str:
    """Return a model as the text of a system file; of models in Python what can be expressed."""
    if target.written.file is not None:
        return model_as_yaml(cast(SystemModel, target.written))
    return system_as_yaml(build_subject(target).system)


def _body_line(body: dict[str, Any]) -> str:
    joints = ", ".join(body["joints"]) or "fixed"
    massless = " (massless)" if body["massless"] else ""
    return f"  {body['name']}{massless} on {body['parent']}: {joints}"


def _parameter_row(parameter: ParameterValue) -> tuple[str, str, str]:
    unit = "" if parameter.unit == "1" else f" {parameter.unit}"
    return parameter.name, f"{parameter.value:.8g}{unit}", parameter.description


def _table(title: str, rows: list[tuple[str, str, str]]) -> list[str]:
    """Return a title and lines of three columns, empty where there is nothing."""
    if not rows:
        return []
    name, value = (max(len(row[k]) for row in rows) for k in (0, 1))
    lines = [f"  {row[0]:{name}}  {row[1]:{value}}  {row[2]}".rstrip() for row in rows]
    return [title, *lines, ""]


def _listed(title: str, names: list[str], separator: str = ", ") -> list[str]:
    if not names:
        return []
    text = textwrap.fill(separator.join(names), 96, initial_indent="  ", subsequent_indent="  ")
    return [title, text, ""]
