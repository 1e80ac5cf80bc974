"""Many errors, long names and repeated texts stay short."""

import pytest

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.problems import START, Problem, refusal
from vehicledyn.base.yaml import parse_yaml
from vehicledyn.files.system.assemblies.repeat import expand


def test_twenty_of_many_problems_are_listed():
    text = str(
        refusal([Problem("file", START, f"field{k}", "wrong") for k in range(20_000)], "file")
    )
    lines = text.splitlines()
    assert len(lines) == 22
    assert lines[-2:] == ["... and 19980 more", "20000 problems or more in file"]
    few = str(refusal([Problem("file", START, "field", "wrong")] * 20, "file"))
    assert len(few.splitlines()) == 21


def test_long_messages_are_shown_in_part():
    text = str(Problem("file", START, "field", f"'{'x' * 1_000_000}' is no number"))
    assert len(text) < 5_000
    assert text.startswith("file:1:1: field: 'xxx") and text.endswith("xxx' is no number")


def test_names_are_compared_and_shown_in_part():
    text = unknown_name("part", "x" * 1_000_000, [f"part{k}" for k in range(50_000)])
    assert len(text) < 2_000
    assert text.endswith(" and 49940 more")


def test_aliases_cannot_repeat_texts_without_end():
    text = f"a: &a {'x' * 100_000}\nb: [{', '.join(['*a'] * 49)}]\n"
    assert len(parse_yaml(text, "file").data["b"]) == 49
    with pytest.raises(InputError, match="file:1:4: syntax: aliases repeat too much text"):
        parse_yaml(text.replace("[", "[*a, "), "file")


def test_aliases_of_aliases_end_at_the_count():
    levels = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    levels += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 10)}]" for k in range(1, 9)]
    with pytest.raises(InputError, match="too many values"):
        parse_yaml("\n".join(levels), "file")


@pytest.mark.parametrize(
    ("group", "words"),
    [
        ({"for": {"i": {"from": 1, "to": 20_000}}}, "makes more than 10000 copies"),
        (
            {"for": {"i": {"from": 1, "to": 9_000}}, "bodies": {"b{i}": {"at": [0] * 500}}},
            "makes more than 1000000 values",
        ),
        (
            {"for": {"i": ["x" * 200], "j": {"from": 1, "to": 9_000}},
             "bodies": {"b{i}{j}": {"at": "{i}" * 100}}},
            "makes more than 20000000 letters",
        ),
        (
            {"for": {"i": {"from": 1, "to": 9_000}}, "bodies": {"b{i}": {"at": "{j}"}}},
            "makes more than 1000 problems",
        ),
    ],
)  # fmt: skip
def test_repetition_has_an_end(group, words):
    expansion = expand({"repeat": [group]})
    assert expansion.overflows
    assert expansion.problems[-1] == (("repeat", 0), words)
    assert len(expansion.problems) < 1_100
