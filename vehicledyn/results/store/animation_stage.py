"""What moves in an animation, as a result keeps it: bodies and shapes, checked when read."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

_SIZES: dict[str, tuple[str, ...]] = {
    "box": ("at", "size"),
    "extrusion": ("at", "profile", "width"),
    "ball": ("at", "radius"),
    "tube": ("a", "b", "radius"),
    "coil": ("a", "b", "radius"),
    "wheel": ("at", "axis", "radius", "width"),
    "hull": ("body", "outline", "bottom", "top"),
    "plane": ("point", "normal"),
    "force": ("at", "components"),
}
"""What a shape must say, by its kind; others are not drawn."""

_OPTIONS: dict[str, Any] = {
    "rotation": None,
    "direction": None,
    "style": "",
    "axes": "world",
    "body": None,
    "camber": None,
    "name": "",
    "coloured_by": "",
    "factors": [1.0, 1.0, 1.0],
}
_POINTS = ("size", "axis", "point", "normal", "direction", "factors")
_LISTS = ("outline", "rotation", "profile")
_NUMBERS = ("radius", "width", "bottom", "top")


@dataclass(frozen=True)
class Stage:
    """What moves in an animation: bodies and the shapes on them, plain data.

    ``bodies`` have a name, an axis (1 to 3, 0 for none) of their further turn, and
    ``axes_spin``, whether that turns the axes of the body or only its wheels. ``shapes`` are
    those of :mod:`vehicledyn.base.shapes`.
    """

    bodies: Sequence[Mapping[str, Any]]
    shapes: Sequence[Mapping[str, Any]]

    def as_json(self) -> str:
        """Return the stage as JSON."""
        names = ("name", "axis", "axes_spin")
        bodies = [{name: body[name] for name in names} for body in self.bodies]
        return json.dumps({"bodies": bodies, "shapes": list(self.shapes)}, default=float)


def read_stage(plain: Any) -> Stage:
    """Return the stage of plain data; shapes of kinds that are not known are left out.

    Raises
    ------
    ValueError
        If a body or shape lacks something or has something else in its place.
    """
    bodies = [_body(body) for body in _list(plain["bodies"])]
    shapes = [shape for shape in _list(plain["shapes"]) if shape["kind"] in _SIZES]
    return Stage(bodies, [_shape(shape, {body["name"] for body in bodies}) for shape in shapes])


def _body(body: Any) -> dict[str, Any]:
    name, axis, spins = body["name"], body["axis"], body["axes_spin"]
    if not isinstance(name, str) or axis not in (0, 1, 2, 3) or not isinstance(spins, bool):
        raise ValueError(f"animation: body {name!r} is not as expected")
    return {"name": name, "axis": axis, "axes_spin": spins}


def _shape(shape: Mapping[str, Any], bodies: set[str]) -> dict[str, Any]:
    whole = {**_OPTIONS, **shape}
    missing = [key for key in _SIZES[shape["kind"]] if key not in shape]
    wrong = [key for key, value in whole.items() if not _is_right(key, value, bodies)]
    if missing or wrong:
        words = ", ".join([*missing, *wrong])
        raise ValueError(f"animation: {shape['kind']} {whole['name']!r}: {words} not as expected")
    return whole


def _is_right(key: str, value: Any, bodies: set[str]) -> bool:
    if key in ("a", "b", "at") and isinstance(value, Mapping):
        known = value.get("body") == "ground" or value.get("body") in bodies
        return known and _is_point(value.get("point"))
    if key in ("at", "components"):
        texts = isinstance(value, list) and len(value) == 3
        return texts and all(item is None or isinstance(item, str) for item in value)
    if key in _POINTS:
        return _is_point(value) or (key == "direction" and value is None)
    if key in _LISTS:
        rows = isinstance(value, list) and all(isinstance(row, list) for row in value)
        width = 3 if key == "rotation" else 2
        right = rows and all(len(row) >= width and all(map(_is_number, row)) for row in value)
        return right or (key == "rotation" and value is None)
    if key in _NUMBERS:
        return _is_number(value)
    return value is None or isinstance(value, str)


def _is_point(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 3 and all(map(_is_number, value))


def _is_number(value: Any) -> bool:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return is_number and math.isfinite(value)


def _list(value: Any) -> list[Any]:
    if not isinstance(value, list):
        raise ValueError("animation: bodies and shapes are no lists")
    return value
