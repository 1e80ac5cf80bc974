"""Figures of vehicles on rails."""

from vehicledyn.analyses.preparation.rail_figures import MOST_PANELS, is_of_rails, rail_figures


def units_of(axles):
    forces = {"Q": "N", "Y": "N", "X": "N", "wear_number": "N"}
    units = {"floor.lateral": "m/s^2", "floor.vertical": "m/s^2", "car.curvature": "1/m"}
    for k in range(axles):
        units |= {f"axle_{k}.lateral_shift": "m", f"axle_{k}.angle_of_attack": "rad"}
        for side in ("left", "right"):
            units |= {f"axle_{k}.{side}.{name}": unit for name, unit in forces.items()}
    return units


def test_forces_have_a_panel_an_axle_and_lines_named_by_the_side():
    figures = {figure["name"]: figure for figure in rail_figures(units_of(2))}
    assert list(figures) == ["running", "wheel_loads", "guiding_forces", "wear", "accelerations"]
    first, second = figures["wheel_loads"]["panels"]
    assert (first["label"], second["label"], first["unit"]) == ("Q, axle_0", "Q, axle_1", "kN")
    assert first["channels"] == ["axle_0.left.Q", "axle_0.right.Q"]
    assert first["labels"] == ["left", "right"]
    labels = [panel["label"] for panel in figures["running"]["panels"]]
    assert labels == ["Lateral shift", "Angle of attack", "Curvature"]
    assert figures["running"]["panels"][0]["labels"] == ["axle_0", "axle_1"]
    assert figures["accelerations"]["panels"][0]["labels"] == ["lateral", "vertical"]


def test_many_axles_have_several_figures():
    figures = {figure["name"]: figure for figure in rail_figures(units_of(10))}
    parts = [figures[f"wheel_loads_{k}"] for k in (1, 2)]
    assert [len(part["panels"]) for part in parts] == [MOST_PANELS, 2]
    assert parts[1]["title"].endswith("(2 of 2)")


def test_a_road_vehicle_has_none():
    assert not list(rail_figures({"chassis.x": "m", "wheel.tyre.normal_force": "N"}))


def test_details_of_contacts_and_frames_are_known():
    assert is_of_rails("axle.left.contact_1.spin_moment") and is_of_rails("frame_1.track_x_force")
    assert not is_of_rails("box_1_left.force_x")


def test_lone_wheels_share_panels_in_pairs():
    units = {f"front_{side}.{side}.{word}": "N" for side in ("left", "right") for word in "QY"}
    units |= {f"front_{side}.lateral_shift": "m" for side in ("left", "right")}
    figures = {figure["name"]: figure for figure in rail_figures(units)}
    (panel,) = figures["wheel_loads"]["panels"]
    assert panel["label"] == "Q, front" and panel["labels"] == ["front_left", "front_right"]
    assert figures["running"]["arranged"]
