"""Every command and listing of the page on flexible bodies works; it names every field."""

import re
from dataclasses import fields
from pathlib import Path

from programs import run

from vehicledyn.multibody.elements.flexible.flexible_body import FlexibleBody, Matrices

PAGE = (Path(__file__).parents[2] / "docs" / "flexible_bodies.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
FIRST = re.compile(r"# (\S+)\n")
MATRICES = """
from pathlib import Path
import numpy as np, scipy.io
from vehicledyn.multibody.bodies.finite_elements.reading import read_archive
frame = read_archive(Path("frame.npz"))
scipy.io.mmwrite("mass.mtx", frame.mass)
scipy.io.mmwrite("stiffness.mtx", frame.stiffness)
np.savetxt("nodes.csv", np.column_stack([frame.numbers, frame.places]), delimiter=",")
np.savetxt("dofs.csv", frame.rows, fmt="%d", delimiter=",")
"""


def test_listings_and_commands(tmp_path):
    matrices = ""
    for kind, body in BLOCK.findall(PAGE):
        lines = body.splitlines()
        if body.startswith("matrices:"):
            matrices = body.strip()
        if not FIRST.match(body) and kind != "sh":
            continue
        if kind in ("yaml", "python"):
            (tmp_path / FIRST.match(body)[1]).write_text(body, encoding="utf-8")
            lines = [f"python {FIRST.match(body)[1]}"] if kind == "python" else []
        for line in lines:
            run(line, tmp_path)
    (tmp_path / "matrices.py").write_text(MATRICES, encoding="utf-8")
    run("python matrices.py", tmp_path)
    text = (tmp_path / "cart.yaml").read_text(encoding="utf-8")
    (tmp_path / "other.yaml").write_text(text.replace("file: frame.npz", matrices))
    run("vehicledyn validate other.yaml", tmp_path)
    one = text[text.index("    interface:") : text.index("    damping_ratio")]
    ends = "    interface: {rear_left: 5, rear_right: 6}\n"
    short = f"title: t\nbodies: {{chassis: {{joints: [T3 z]}}}}\nelements:\n{_element(text)}"
    standard = short.replace(one, ends).replace("frame.npz", "frame.SID_FEM")
    (tmp_path / "standard.yaml").write_text(re.sub(r"(?m)^    lines.*\n", "", standard))
    run("vehicledyn validate standard.yaml", tmp_path)
    (tmp_path / "stiff.yaml").write_text(short.replace("frame.npz", "stiffened.npz").replace(
        "    nodes: {middle: 3}\n", ""))  # fmt: skip
    run("vehicledyn validate stiff.yaml", tmp_path)


def _element(text):
    return text[text.index("  frame:\n    kind") : text.index("links:")]


def test_page_names_every_field():
    names = {f.name for kind in (FlexibleBody, Matrices) for f in fields(kind)} - {"name", "role"}
    assert not {name for name in names if f"`{name}" not in PAGE and f"{name}:" not in PAGE}
