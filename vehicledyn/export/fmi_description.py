"""The model description of an FMU: its variables, units and structure, as FMI 3.0 wants them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from xml.etree import ElementTree as Xml

from vehicledyn.base.errors import InputError
from vehicledyn.base.units import parse_unit
from vehicledyn.base.version import VERSION
from vehicledyn.export.document import ExportedStart
from vehicledyn.symbolic.equations import Equations

_STRUCTURED = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*", re.ASCII)


@dataclass(frozen=True)
class RunDefaults:
    """What an importer runs by default: stop time [s], sampling interval [s], tolerance."""

    stop: float = 1.0
    interval: float = 0.01
    tolerance: float = 1e-6


@dataclass(frozen=True)
class FmiVariable:
    """A variable of the model description; ``attributes`` beside name and description.

    ``kind`` is "time", "state", "rate", "parameter", "channel" or "event".
    """

    kind: str
    name: str
    reference: int
    unit: str
    description: str
    attributes: dict[str, str]


def variables_of(equations: Equations, start: ExportedStart) -> list[FmiVariable]:
    """Return all variables in the order of their value references.

    A channel that repeats a state is left out, the state itself is an output then; other names
    that occur twice get a prefix.
    """
    e = equations
    channels = {c.name for c in e.channels}
    states = {v.name for v in e.states}
    found = [FmiVariable("time", "time", 0, "s", "Time", _attributes("independent", "continuous"))]

    def add(kind: str, name: str, unit: str, text: str, **attributes: str) -> None:
        found.append(FmiVariable(kind, name, len(found), unit, text, attributes))

    for variable, value in zip(e.states, start.state, strict=True):
        causality = "output" if variable.name in channels else "local"
        exact = _attributes(causality, "continuous", initial="exact", start=repr(float(value)))
        add("state", variable.name, variable.unit, variable.description, **exact)
    for k, variable in enumerate(e.states):
        rate = _attributes("local", "continuous", derivative=str(k + 1))
        unit, text = _per_second(variable.unit), f"Rate of: {variable.description}"
        add("rate", f"der({variable.name})", unit, text, **rate)
    for parameter, value in zip(e.parameters, start.parameters, strict=True):
        name = parameter.name
        if name in channels | states | {"time"}:
            name = f"parameters.{name}"
        tunable = _attributes("parameter", "tunable", initial="exact", start=repr(float(value)))
        add("parameter", name, parameter.unit, parameter.description, **tunable)
    for channel in e.channels:
        kind = "repeated" if channel.name in states else "channel"
        output = _attributes("output", "continuous")
        add(kind, channel.name, channel.unit, channel.description, **output)
    for event in e.events:
        mark = _attributes("local", "continuous")
        add("event", f"event_indicators.{event.name}", "1", f"Event {event.name}", **mark)
    return [variable for variable in found if variable.kind != "repeated"]


def model_description(
    equations: Equations, identifier: str, token: str, start: ExportedStart, experiment: RunDefaults
) -> str:
    """Return the text of modelDescription.xml."""
    variables = variables_of(equations, start)
    plain = [v.name for v in variables if v.kind != "rate"]
    structured = all(_STRUCTURED.fullmatch(name) for name in plain)
    root = Xml.Element(
        "fmiModelDescription",
        fmiVersion="3.0",
        modelName=equations.name,
        instantiationToken=token,
        generationTool=f"vehicledyn {VERSION}",
        variableNamingConvention="structured" if structured else "flat",
    )
    Xml.SubElement(
        root, "ModelExchange", modelIdentifier=identifier, canGetAndSetFMUState="true",
        needsCompletedIntegratorStep="true",
    )  # fmt: skip
    units = Xml.SubElement(root, "UnitDefinitions")
    for unit in dict.fromkeys(v.unit for v in variables):
        _add_unit(units, unit)
    Xml.SubElement(
        root, "DefaultExperiment", startTime="0.0", stopTime=repr(experiment.stop),
        tolerance=repr(experiment.tolerance), stepSize=repr(experiment.interval),
    )  # fmt: skip
    listed = Xml.SubElement(root, "ModelVariables")
    for v in variables:
        Xml.SubElement(
            listed, "Float64", {"name": v.name, "valueReference": str(v.reference), **v.attributes},
            description=v.description, unit=v.unit,
        )  # fmt: skip
    structure = Xml.SubElement(root, "ModelStructure")
    for tag, reference in _structure(variables):
        Xml.SubElement(structure, tag, valueReference=str(reference))
    return _text(root)


def build_description(identifier: str) -> str:
    """Return the text of buildDescription.xml, with which importers compile the source."""
    root = Xml.Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = Xml.SubElement(root, "BuildConfiguration", modelIdentifier=identifier)
    files = Xml.SubElement(configuration, "SourceFileSet", language="C11")
    Xml.SubElement(files, "SourceFile", name=f"{identifier}.c")
    return _text(root)


def _structure(variables: list[FmiVariable]) -> Iterator[tuple[str, int]]:
    for v in variables:
        if v.attributes["causality"] == "output":
            yield "Output", v.reference
    for v in variables:
        if v.kind == "rate":
            yield "ContinuousStateDerivative", v.reference
    for v in variables:
        if v.kind in ("rate", "channel"):
            yield "InitialUnknown", v.reference
    for v in variables:
        if v.kind == "event":
            yield "EventIndicator", v.reference


def _attributes(causality: str, variability: str, **more: str) -> dict[str, str]:
    return {"causality": causality, "variability": variability, **more}


def _per_second(unit: str) -> str:
    return "1/s" if unit == "1" else f"{unit}/s"


def _add_unit(units: Xml.Element, unit: str) -> None:
    """Add a unit with its exponents; those of a unit that is not mechanical are left open."""
    element = Xml.SubElement(units, "Unit", name=unit)
    try:
        factor, exponents = parse_unit(unit)
    except InputError:
        return
    powers = dict(zip(("m", "kg", "s", "rad"), exponents, strict=True))
    given = {name: str(power) for name, power in powers.items() if power}
    if factor != 1.0:
        given["factor"] = repr(factor)
    Xml.SubElement(element, "BaseUnit", given)


def _text(root: Xml.Element) -> str:
    Xml.indent(root)
    return Xml.tostring(root, encoding="unicode", xml_declaration=True) + "\n"
