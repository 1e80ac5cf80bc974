"""Files that scenarios may name as models."""

import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.registry import find, kinds


@pytest.mark.parametrize("kind", kinds("model_file"))
def test_kind_of_file_tells_itself_from_scenarios(kind, tmp_path):
    files = find("model_file", kind)
    assert not files.is_one({"title": "t", "model": "iltis"})
    assert not files.is_one(None)
    path = tmp_path / "empty.yaml"
    path.write_text("title: t\n")
    assert files.groups(path) == set()
    model, problems = files.read(path, {}, None)
    assert (model is None) == bool(problems)
