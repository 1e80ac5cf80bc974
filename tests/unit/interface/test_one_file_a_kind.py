"""One file of the user's own is all that a new kind needs: files, schema and reference know it."""

import importlib
import json
import sys
from pathlib import Path

import pytest

import vehicledyn as vd
import vehicledyn.catalogue
from vehicledyn.base import plugins, registry
from vehicledyn.base.registry import families, find, kinds
from vehicledyn.files.system.kinds import load_kinds
from vehicledyn.files.system.schema import system_schema

pytestmark = pytest.mark.long
vehicledyn.catalogue.counts()
DOCS = Path(__file__).parents[3] / "docs"
APART = {"model", "model_file", "element", "deformation_type"}
"""Models, for which a system file is enough; what elements make; and what beams bring along."""
FAMILIES = [family for family in families() if family not in APART]
BODY = "mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]"
BAR = f"title: t\nbodies: {{b: {{joints: [R2 q], {BODY}}}}}\n"
SLED = f"title: t\nbodies: {{b: {{joints: [T1 x, T2 y], {BODY}}}}}\n"
LOOP = f"title: t\nbodies: {{b: {{joints: [T1 x, T3 z, R2 q], {BODY}}}}}\n"
DRIVE = """\
title: t
model: iltis
tyres: {kind: calspan}
road: {kind: flat}
wheel_spin: free
speed: 15 m/s
manoeuvre: {kind: straight}
duration: 1 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""
STEERED = "{kind: pure_pursuit, distance: 5 m, lag_frequency: 20 rad/s, lag_damping: 0.8, "
STEERED += "rack_stop: 60 mm, rack_acceleration: 20 m/s^2}"
SLALOM = "{kind: slalom, cones: 1, spacing: 18 m, first_cone: 4 m, cone_radius: 0.1 m, "
SLALOM += f"path_offset: 1 m, driver: {STEERED}}}"
USES = {
    "joint_type": ("R2", BAR.replace("R2 q", "{kind: R2, name: q}")),
    "element_type": (
        "wrench",
        BAR + "elements: {e: {kind: wrench, body: b, force: [1 N, 0, 0]}}\n",
    ),
    "sensor_type": ("body", BAR + "sensors: {s: {kind: body, body: b}}\n"),
    "constraint_type": (
        "knife_edge",
        SLED + "constraints: {c: {kind: knife_edge, body: b, across: [0, 1, 0]}}\n",
    ),
    "joint": ("turn", BAR.replace("R2 q", "{kind: turn, axis: 1, angle: 1 rad}, R2 q")),
    "sensor": ("expression", BAR + "sensors: {s: {kind: expression, value: b.q, unit: rad}}\n"),
    "constraint": (
        "expression",
        SLED + "constraints: {c: {kind: expression, zero: b.x - 2 * b.y}}\n",
    ),
    "cut": ("ball", LOOP + "cuts: {c: {kind: ball, a: b, b: {body: ground, point: [0, 0, 0]}}}\n"),
    "force_law": (
        "constant",
        BAR + "springs: {s: {coordinate: b.q, law: {kind: constant, amount: 1 N*m}}}\n",
    ),
    "time_law": (
        "constant_rate",
        BAR + "drives: {d: {coordinate: b.q, law: {kind: constant_rate, rate: 1 rad/s}}}\n",
    ),
    "shape": ("sphere", BAR + "shapes: {s: {kind: sphere, body: b, radius: 0.1 m}}\n"),
    "tyre": ("calspan", DRIVE),
    "road": ("flat", DRIVE),
    "manoeuvre": ("straight", DRIVE),
    "solver": ("rk4", DRIVE),
    "driver": ("pure_pursuit", DRIVE.replace("{kind: straight}", SLALOM)),
    "relaxation": (
        "of_tyre",
        DRIVE.replace("{kind: calspan}", "{file: passenger_R0394_mf61.tir}")
        + "relaxation: {kind: of_tyre}\n",
    ),
}
"""A kind of a family and a file that uses it, where the file may be read by itself."""


@pytest.fixture
def own(tmp_path, request):
    """Return family and base of a kind that a file just registered, and take it out again."""
    loaded = dict(plugins._loaded)
    family = request.param
    base = USES[family][0] if family in USES else kinds(family)[0]
    entry = find(family, base)
    path = tmp_path / "mine.py"
    path.write_text(
        '"""A kind of my own."""\n'
        f"from {entry.__module__} import {entry.__qualname__}\n"
        "from vehicledyn.base.registry import register\n\n\n"
        f'@register("{family}", "own_kind")\n'
        f"class OwnKind({entry.__qualname__}):\n"
        '    """What I add."""\n',
        encoding="utf-8",
    )
    assert vd.load_plugin(path) == [(family, "own_kind")]
    yield family, base
    for entries in registry._catalogues.values():
        entries.pop("own_kind", None)
    plugins._loaded.clear()
    plugins._loaded.update(loaded)


@pytest.mark.parametrize("own", FAMILIES, indirect=True)
def test_one_file_is_in_reference_and_schema(own):
    family, _ = own
    load_kinds()
    sys.path.insert(0, str(DOCS))
    try:
        page = importlib.import_module("sphinx_parts.catalogues")._page
    finally:
        sys.path.remove(str(DOCS))
    shown = family.removesuffix("_type")
    if shown in ("joint", "element", "sensor", "constraint"):
        assert "own_kind" in kinds(shown)
        assert f'"{shown}.own_kind"' in json.dumps(system_schema())
    told = page(shown, ("own_kind",)).partition("\n## own_kind\n")[2]
    assert "What I add." in told


@pytest.mark.parametrize("own", sorted(USES), indirect=True)
def test_one_file_is_enough_to_use_it(own, tmp_path):
    family, base = own
    text = USES[family][1]
    assert f"kind: {base}" in text
    path = tmp_path / "use.yaml"
    path.write_text(text, encoding="utf-8")
    vd.load(path)
    path.write_text(text.replace(f"kind: {base}", "kind: own_kind"), encoding="utf-8")
    vd.load(path)
    path.write_text(text.replace(f"kind: {base}", "kind: own_kin"), encoding="utf-8")
    with pytest.raises(vd.InputError, match="did you mean 'own_kind'"):
        vd.load(path)
