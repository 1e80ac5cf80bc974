"""How many processes compute a sweep."""

import contextlib
from types import SimpleNamespace

import pytest

from vehicledyn.studies import sweep


@pytest.mark.parametrize(
    ("wanted", "cases", "count"), [(4096, 10**6, 16), (None, 10**6, 2), (5, 10**6, 5), (4096, 3, 3)]
)
def test_a_file_gets_no_more_processes_than_a_machine_bears(monkeypatch, wanted, cases, count):
    asked = []
    monkeypatch.setattr(sweep, "cores", lambda: 2)

    def own_processes(_, number):
        asked.append(number)
        return contextlib.nullcontext()

    monkeypatch.setattr(sweep, "own_processes", own_processes)
    work = SimpleNamespace(design=SimpleNamespace(count=cases), recipe=SimpleNamespace(built=None))
    with contextlib.ExitStack() as stack:
        sweep._helpers(stack, work, wanted, None, lambda *_: None)
    assert asked == [count]
