"""Bodies from finite elements in system files: files beside them, and mistakes by line."""

import re

import pytest
from element_examples import FRAME
from system_texts import equations, load, problems

from vehicledyn.files.building.construct import build_system

TEXT = """title: t
bodies:
  hub: {joints: [T3 z]}
  load: {parent: frame.rear, mass: 9 kg, at: [0, 0, 1 m]}
elements:
  frame:
    kind: flexible_body
    body: hub
    file: models/frame.npz
    interface:
      left: 3
      right: 16
      rear: [11, 24]
    modes: 2
    damping_ratio: 2 %
    highest_frequency: 60 Hz
    lines: [[1, 7, 13], [14, 20, 26]]
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "frame.npz").write_bytes(FRAME.read_bytes())
    return tmp_path


def test_the_file_is_beside_the_system(folder):
    found = equations(folder, TEXT)
    names = [state.name for state in found.states]
    assert names[:3] == ["hub.z", "frame.mode_1", "frame.mode_2"]
    assert "frame.rear_z" in {channel.name for channel in found.channels}


def test_the_file_is_beside_the_assembly(folder):
    (folder / "parts").mkdir()
    (folder / "models").rename(folder / "parts" / "models")
    (folder / "parts" / "part.yaml").write_text(TEXT)
    whole = build_system(load(folder, "title: w\nassemblies: {a: {file: parts/part.yaml}}\n"))
    assert any(body.name == "a.frame.rear" and body.place is not None for body in whole.bodies)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("models/frame", "none", "^9:11: elements.frame.file: .*none.npz: there is no such file"),
        ("left: 3", "left: 40", "^11:13: elements.frame.interface.left: .* has no node 40; the"),
        ("rear: [11, 24]", "rear: 3", "^13:.*interface.rear: node 3 is also of 'left'; attach"),
        ("modes: 2", "modes: 170", "^14:12: elements.frame.modes: 170 are more than are indep"),
        ("frame.rear", "frame.back", "^4:18: .*no body named 'frame.back'; did you mean 'frame.re"),
        ("parent: frame.rear", "parent: frame", "^4:18: .*'frame' deforms; hang it on a frame"),
        ("60 Hz", "60 m", "^16:24: .*'60 m' has the wrong unit: a quantity in Hz"),
        ("modes: 2\n", "modes: 2\n    reference: front\n", "^15:16: .*'front' is no interface; in"),
        ("[1, 7, 13]", "[1, 7, 99]", "^17:12: elements.frame.lines: .* has no node 99"),
    ],
)
def test_mistakes_have_a_line(folder, old, new, words):
    found = problems(folder, TEXT.replace(old, new))
    assert len(found) == 1
    assert re.search(words, found[0]), found[0]


def test_a_mirror_image_is_refused(folder):
    """The matrices of a left arm are not those of the right one."""
    body = (
        TEXT[TEXT.index("bodies:") :]
        .replace("  frame:", "  left_frame:")
        .replace("hub", "left_hub")
    )
    body = re.sub(r"  load: .*\n", "", body)
    text = "title: t\nmirror:\n- plane: y\n  names: {left_: right_}\n" + re.sub("(?m)^", "  ", body)
    found = problems(folder, text)
    assert len(found) == 1
    assert "left_frame: its matrices are not mirrored; write it and its image" in found[0]
