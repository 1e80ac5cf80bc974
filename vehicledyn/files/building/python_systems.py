"""Write systems that were built in Python as system files, as far as these can say the same."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

from vehicledyn.files.building.write import SCHEMA_LINE, dump
from vehicledyn.multibody.elements.drives import ConstantRate
from vehicledyn.multibody.elements.motion_sensors import (
    Accelerometer,
    BodySensor,
    FloorSensor,
    SeatSensor,
    SequenceSensor,
)
from vehicledyn.multibody.model.bodies import Body, Joint, Turn
from vehicledyn.multibody.model.cuts import BallCut, BodyCut, RodCut
from vehicledyn.multibody.model.system import System
from vehicledyn.symbolic import ops, rotations

_SMALL = 1e-15
_KINDS = {BallCut: "ball", RodCut: "rod", BodyCut: "body"}


def system_as_yaml(system: System) -> str:
    """Return a system file of a system's bodies, joints and cuts, with numbers and their units.

    Parameters are replaced by their values. What a file cannot say, such as a force law that is
    a Python function, is listed in comments at the end.
    """
    return _Writer(system).text()


def with_unit(value: float, unit: str) -> str | float:
    """Return a number as files write it; zero and pure numbers have no unit.

    >>> with_unit(-9.81, "m/s^2"), with_unit(0.0, "m"), with_unit(0.5, "1")
    ('-9.81 m/s^2', 0.0, 0.5)
    """
    return value if value == 0.0 or unit in ("", "1") else f"{value!r} {unit}"


def _units_of_settings(of: Any) -> dict[str, str]:
    """Return the SI units of the settings of a type of joint that are numbers."""
    declared = fields(of) if is_dataclass(of) else ()
    return {f.name: f.metadata["unit"] for f in declared if "unit" in f.metadata}


@dataclass
class _Writer:
    """One system on its way into a file, and what was left out."""

    system: System
    left_out: list[str] = field(default_factory=list)

    def text(self) -> str:
        data: dict[str, Any] = {
            "title": self.system.name,
            "description": "Written from a Python model, with the values of its parameters.",
            "gravity": self._measured(self.system.gravity, "m/s^2"),
            "bodies": {body.name: self._body(body) for body in self.system.bodies},
        }
        if self.system.constraint_method != "auto":
            data["constraint_method"] = self.system.constraint_method
        sections: dict[str, dict[str, Any]] = {"cuts": {}, "drives": {}, "sensors": {}}
        for cut in self.system.cuts:
            self._cut(cut, sections["cuts"])
        self._parts(sections)
        for constraint in self.system.constraints:
            self._leave(constraint)
        data |= {name: entries for name, entries in sections.items() if entries}
        notes = [f"# not expressed: {words}" for words in self.left_out]
        return SCHEMA_LINE + "\n".join([dump(data).rstrip(), *notes, ""])

    def _body(self, body: Body) -> dict[str, Any]:
        written: dict[str, Any] = {"parent": body.parent}
        at = self._measured(body.at, "m")
        if any(at):
            written["at"] = at
        joints = [entry for item in body.joints for entry in self._joint(item, body.joints)]
        if joints:
            written["joints"] = joints
        if body.mass is None:
            return written
        written["mass"] = self._one(body.mass, "kg")
        com = self._measured(body.com, "m")
        inertia = self._measured(body.inertia, "kg*m^2")
        if any(com):
            written["com"] = com
        written["inertia"] = inertia if any(inertia[3:]) else inertia[:3]
        if body.spins_about is not None:
            written["spins_about"] = body.spins_about
        if body.apparent_inertia:
            written["apparent_inertia"] = True
        return written

    def _joint(self, item: Joint | Turn, joints: tuple[Joint | Turn, ...]) -> list[dict[str, Any]]:
        if isinstance(item, Turn):
            angles = rotations.tait_bryan(item.rotation, (3, 2, 1))
            pairs = zip((3, 2, 1), self._numbers(angles), strict=True)
            return [
                {"kind": "turn", "axis": k, "angle": with_unit(a, "rad")}
                for k, a in pairs
                if abs(a) > _SMALL
            ]
        if item.siblings:
            return self._elements(item, joints)
        written: dict[str, Any] = {"kind": item.kind, "name": item.name}
        units = _units_of_settings(item.type)
        for name, value in item.settings.items():
            written[name] = self._one(value, units[name]) if name in units else value
        start, rate = item.start, item.start_rate
        written |= {"start": with_unit(start, item.unit)} if start else {}
        written |= {"start_rate": with_unit(rate, f"{item.unit}/s")} if rate else {}
        if not ops.is_structurally_zero(item.reflected_inertia):
            reflected = self._numbers([item.reflected_inertia])[0]
            if reflected > 0.0:
                unit = "kg*m^2" if item.unit == "rad" else "kg"
                written["reflected_inertia"] = with_unit(reflected, unit)
            else:
                self.left_out.append(f"the reflected inertia {reflected:g} of '{item.name}'")
        written |= {"role": item.role} if item.role != "auto" else {}
        return [written | ({"description": item.description} if item.description else {})]

    def _elements(self, item: Joint, joints: tuple[Joint | Turn, ...]) -> list[dict[str, Any]]:
        """Return a joint with several coordinates, written where the first of them stands."""
        if item.type.element > 0:
            return []
        own = {j.name: j for j in joints if isinstance(j, Joint) and j.siblings == item.siblings}
        start = [with_unit(own[n].start, own[n].unit) for n in item.positions]
        rates = [with_unit(own[n].start_rate, own[n].unit) for n in item.speeds]
        return [{"kind": item.kind, "start": start, "start_rate": rates}]

    def _cut(self, cut: Any, written: dict[str, Any]) -> None:
        kind = _KINDS.get(type(cut))
        if kind is None:
            self._leave(cut)
            return
        ends = {
            "a": {"body": cut.body_a, "point": self._measured(cut.point_a, "m")},
            "b": {"body": cut.body_b, "point": self._measured(cut.point_b, "m")},
        }
        length = {"length": self._one(cut.length, "m")} if isinstance(cut, RodCut) else {}
        written[cut.name] = {"kind": kind, **ends, **length}

    def _parts(self, sections: dict[str, dict[str, Any]]) -> None:
        sensors = sections["sensors"]
        units = {joint.name: joint.unit for joint in self.system.joints()}
        for part in self.system.parts:
            if isinstance(part, ConstantRate):
                rate = self._one(part.rate, f"{units[part.coordinate]}/s")
                law = {"kind": "constant_rate", "rate": rate}
                sections["drives"][part.name] = {"coordinate": part.coordinate, "law": law}
            elif isinstance(part, BodySensor):
                sensors[part.name] = {"kind": "body", "body": part.body}
            elif isinstance(part, Accelerometer):
                point = self._measured(part.point, "m")
                sensors[part.name] = {"kind": "accelerometer", "body": part.body, "point": point}
            elif isinstance(part, FloorSensor | SeatSensor):
                kind, point = "seat" if part.is_seat else "floor", self._measured(part.point, "m")
                sensors[part.name] = {"kind": kind, "body": part.body, "point": point}
            elif isinstance(part, SequenceSensor):
                sequence = list(part.sequence)
                sensors[part.name] = {"kind": "angles", "body": part.body, "sequence": sequence}
            else:
                self._leave(part)

    def _leave(self, part: Any) -> None:
        self.left_out.append(f"'{part.name}', a {type(part).__name__} written in Python")

    def _one(self, item: Any, unit: str) -> str | float:
        """Return the value of a scalar with its unit, see :func:`with_unit`."""
        return self._measured([item], unit)[0]

    def _measured(self, items: Any, unit: str) -> list[str | float]:
        """Return the values of scalars with their unit, see :func:`with_unit`."""
        return [with_unit(value, unit) for value in self._numbers(items)]

    def _numbers(self, items: Any) -> list[float]:
        """Return the values of scalars with the system's parameters."""
        entries = self.system.table.entries
        symbols = ops.column([entry.symbol for entry in entries])
        values = ops.numeric([symbols], ops.column(list(items)))([e.value for e in entries])
        return [float(v) for v in values[:, 0]]
