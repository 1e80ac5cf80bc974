import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.base.problems import Mark
from vehicledyn.base.yaml import LARGEST_FILE, copied, parse_yaml, read_yaml


def refusal_of(text):
    with pytest.raises(InputError) as refused:
        parse_yaml(text, "f.yaml")
    return str(refused.value)


def test_values_follow_yaml_1_2():
    text = (
        "a: 1e5\nb: on\nc: 2020-01-01\nd: 0o14\ne: .nan\nf: ~\ng: true\nh: 010\ni: 'x'\nj: [1, x]"
    )
    data = parse_yaml(text, "f.yaml").data
    assert data.pop("e") != 0.0
    assert data == {
        "a": 1e5, "b": "on", "c": "2020-01-01", "d": 12, "f": None,
        "g": True, "h": 10, "i": "x", "j": [1, "x"],
    }  # fmt: skip


def test_marks_of_keys_and_values():
    document = parse_yaml("a:\n  b: 1\n  c: [4, {d: 5}]\n", "f.yaml")
    assert document.keys["a", "b"] == Mark(2, 3)
    assert document.values["a", "b"] == Mark(2, 6)
    assert document.values["a", "c", 1, "d"] == Mark(3, 14)


@pytest.mark.parametrize(
    ("text", "start", "words"),
    [
        ("a: b: c", "f.yaml:1:5: syntax: ", "mapping values"),
        ("a: 1\n\tb: 2", "f.yaml:2:1: syntax: ", "use spaces"),
        ("a: 'x", "f.yaml:1:6: syntax: ", "end of stream"),
        ("a: \x00", "f.yaml:1:4: syntax: ", "U+0000"),
        ("a: 1\n--- \nb: 2", "f.yaml:2:1: syntax: ", "single document"),
        ("a: &x [*x]", "f.yaml:1:4: syntax: ", "repeats itself"),
        ("a: *x", "f.yaml:1:4: syntax: ", "undefined alias"),
        ("a: [2, *x]", "f.yaml:1:8: syntax: ", "begins with * in quotation marks"),
        ("a: [2*{i}, 3]", "f.yaml:1:7: syntax: ", "put a text that holds { } [ ] or ,"),
        ("%YAML 1.1\n---\na: on", "f.yaml:1:1: syntax: ", "1.2"),
        ("[" * 1000, "f.yaml:1:1: syntax: ", "too deeply"),
        ("a: {b: 1\nc: 2", "f.yaml:2:2: syntax: ", "expected"),
        ("- a\nb: 1", "f.yaml:2:1: syntax: ", "indentation"),
    ],
)
def test_syntax_is_told_with_its_place(text, start, words):
    message = refusal_of(text)
    assert message.startswith(start)
    assert words in message.splitlines()[0]
    assert message.endswith("\n1 problem in f.yaml")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("a: 1\na: 2", "f.yaml:2:1: a: given twice; the first is in line 1"),
        ("x: {b: 1, b: 1}", "f.yaml:1:11: x.b: given twice; the first is in line 1"),
        ("? [1]\n: 2", "f.yaml:1:3: a key must be a text"),
        ("a: !!binary aGk=", "f.yaml:1:4: a: the tag 'binary' is not allowed here"),
        ("a: !!int x", "f.yaml:1:4: a: 'x' is no int"),
        ("a: !!bool maybe", "f.yaml:1:4: a: 'maybe' is no bool"),
        ('a: "\\0"', "f.yaml:1:4: a: the text holds a character that no file can store"),
    ],
)
def test_problems_of_a_readable_file(text, told):
    assert [str(problem) for problem in parse_yaml(text, "f.yaml").problems] == [told]


def test_all_duplicate_keys_are_told():
    problems = parse_yaml("a: 1\na: 2\na: 3\nb: 1\nb: 2", "f.yaml").problems
    assert [problem.mark for problem in problems] == [Mark(2, 1), Mark(3, 1), Mark(5, 1)]


def test_aliases_cannot_blow_up():
    text = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(
        f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]\n" for n in range(1, 9)
    )
    assert "too many values" in refusal_of(text)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda path: None, "f.yaml:1:1: file: there is no such file"),
        (lambda path: path.mkdir(), "f.yaml:1:1: file: this is a folder, not a file"),
        (lambda path: path.write_bytes(b"a: 1\nb: \xff"), "f.yaml:2:4: syntax: the byte 0xff"),
        (lambda path: path.write_bytes(b"\x89PNG\r\n\x1a\n\0"), "f.yaml:1:1: syntax: the byte"),
        (lambda path: path.write_text("a: 1", "utf-16"), "f.yaml:1:1: syntax: the byte"),
        (lambda path: path.write_bytes(b"#" * (LARGEST_FILE + 2)), "f.yaml:1:1: file: larger"),
    ],
)
def test_unreadable_files(tmp_path, make, words):
    path = tmp_path / "f.yaml"
    make(path)
    with pytest.raises(InputError) as refused:
        read_yaml(path)
    assert words in str(refused.value)
    assert "Traceback" not in str(refused.value)


def test_byte_order_mark_is_no_content(tmp_path):
    path = tmp_path / "f.yaml"
    path.write_bytes(b"\xef\xbb\xbfa: 1\r\nb: \xc2\xb5m\r\n")
    assert read_yaml(path).data == {"a": 1, "b": "µm"}


def test_a_text_that_is_read_again_is_no_other_and_nobody_elses():
    text = "wheels: {radius: 1, radius: 2}\nplaces: [[1, 2], [3, 4]]\n"
    first = parse_yaml(text, "again.yaml")
    whole = copied(first.data), dict(first.values), dict(first.keys), list(first.problems)
    first.data["places"][0].append(5)
    first.values.clear()
    first.keys.clear()
    first.problems.clear()
    second = parse_yaml(text, "again.yaml")
    assert (second.data, second.values, second.keys, second.problems) == whole
    assert parse_yaml(text, "other.yaml").problems[0].source == "other.yaml"


def test_a_long_text_read_twice_is_parsed_once(monkeypatch):
    """Each reader has a copy of its own."""
    from vehicledyn.base import yaml

    text, parsed = "long: " + "x" * 100_001 + "\n", []
    parse = yaml._parse
    monkeypatch.setattr(yaml, "_parse", lambda *given: parsed.append(1) or parse(*given))
    first, second = (yaml.parse_yaml(text, "long.yaml") for _ in range(2))
    first.data["long"] = "changed"
    assert (len(parsed), len(second.data["long"])) == (1, 100_001)
