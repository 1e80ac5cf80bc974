"""Descriptions of the standard figures of a road vehicle, drawn from the result file later."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from vehicledyn.road.vehicle import RoadVehicle


def standard(vehicle: RoadVehicle, *, path_title: str = "Path") -> list[dict[str, Any]]:
    """Return path, steering, yaw rate with lateral acceleration, wheel loads, roll."""
    drawn = _steering(vehicle), _yaw(vehicle), _loads(vehicle), _roll(vehicle)
    return [_path(vehicle, path_title), *drawn]


def answers(title: str) -> dict[str, Any]:
    """Return steering-wheel angle, yaw rate, lateral acceleration and side-slip angle by time."""
    return _time(
        "answers",
        title,
        _panel("Steering wheel", "deg", ["steering_angle.angle"], ["steering-wheel angle"]),
        _panel("Yaw rate", "deg/s", ["body.yaw_rate"], ["yaw rate"]),
        _panel("Acceleration", "m/s^2", ["accelerometer.lateral"], ["lateral acceleration"]),
        _panel("Side-slip angle", "deg", ["body.sideslip_angle"], ["side-slip angle"]),
    )


def along(title: str, vehicle: RoadVehicle) -> dict[str, Any]:
    """Return speed, longitudinal acceleration, longitudinal slip and pitch by time."""
    return _time(
        "along",
        title,
        _panel("Speed", "km/h", ["body.forward_speed"], ["forward speed"]),
        _panel("Acceleration", "m/s^2", ["accelerometer.longitudinal"], ["longitudinal"]),
        _panel("Longitudinal slip", "%", *_wheels(vehicle, "tyre.longitudinal_slip")),
        _panel("Pitch angle", "deg", [f"{vehicle.chassis}.pitch"], ["pitch"]),
    )


def _path(vehicle: RoadVehicle, title: str) -> dict[str, Any]:
    return {
        "name": "path",
        "title": title,
        "kind": "path",
        "x": f"{vehicle.chassis}.x",
        "y": f"{vehicle.chassis}.y",
        "heading": f"{vehicle.chassis}.yaw",
        "cones": True,
    }


def _time(name: str, title: str, *panels: dict[str, Any]) -> dict[str, Any]:
    return {"name": name, "title": title, "kind": "time", "panels": list(panels)}


def _panel(label: str, unit: str, channels: list[str], labels: list[str]) -> dict[str, Any]:
    return {"label": label, "unit": unit, "channels": channels, "labels": labels}


def _wheels(vehicle: RoadVehicle, channel: str) -> tuple[list[str], list[str]]:
    words = {True: "front", False: "rear"}, {True: "left", False: "right"}
    names = [f"{c.name}.{channel}" for c in vehicle.corners]
    labels = [f"{words[0][c.is_front]} {words[1][c.is_left]}" for c in vehicle.corners]
    return names, labels


def _steering(vehicle: RoadVehicle) -> dict[str, Any]:
    rack = _panel("Rack displacement", "mm", [vehicle.rack], ["rack, along +y"])
    slip = _panel("Slip angle", "deg", *_wheels(vehicle, "tyre.slip_angle"))
    return _time("steering", "Steering and slip angles", rack, slip)


def _yaw(vehicle: RoadVehicle) -> dict[str, Any]:
    yaw = _panel("Yaw rate", "deg/s", ["body.yaw_rate"], ["yaw rate"])
    acceleration = _panel(
        "Lateral acceleration", "m/s^2", ["accelerometer.lateral"], ["lateral acceleration"]
    )
    return _time("yaw", "Yaw rate and lateral acceleration", yaw, acceleration)


def _loads(vehicle: RoadVehicle) -> dict[str, Any]:
    panel = _panel("Wheel load", "kN", *_wheels(vehicle, "tyre.normal_force"))
    return _time("wheel_loads", "Wheel loads", panel)


def _roll(vehicle: RoadVehicle) -> dict[str, Any]:
    body = vehicle.chassis
    angles = _panel("Angle", "deg", [f"{body}.roll", f"{body}.pitch"], ["roll", "pitch"])
    height = _panel("Height", "mm", [f"{body}.z"], ["centre of mass"])
    return _time("roll", "Roll, pitch and height", angles, height)
