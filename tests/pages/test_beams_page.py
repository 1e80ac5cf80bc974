"""Every command and listing of the page on beams works; its tables name every choice."""

import re
from pathlib import Path
from typing import get_args, get_type_hints

from programs import run

from vehicledyn.multibody.bodies.beam_sections import Section
from vehicledyn.multibody.elements.flexible.beam import Beam, Modes

PAGE = (Path(__file__).parents[2] / "docs" / "beams.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
FIRST = re.compile(r"# (\S+)\n")


def test_listings_and_commands(tmp_path):
    for kind, body in BLOCK.findall(PAGE):
        lines = body.splitlines()
        if kind in ("yaml", "python"):
            (tmp_path / FIRST.match(body)[1]).write_text(body, encoding="utf-8")
            lines = [f"python {FIRST.match(body)[1]}"] if kind == "python" else []
        for line in lines:
            assert run(line, tmp_path)
    assert (tmp_path / "spin.h5").is_file()


def test_page_names_every_choice():
    words = {name for kind in (Section, Modes) for name in get_type_hints(kind)}
    for field in ("model", "basis", "stiffening"):
        words |= set(get_args(get_type_hints(Beam)[field]))
    words |= set(get_args(get_type_hints(Section)["shape"]))
    assert not {word for word in words if f"`{word}`" not in PAGE}
