import contextlib
import signal
from types import SimpleNamespace

import pytest

from vehicledyn.analyses.preparation import prepare as module
from vehicledyn.multibody.equations import derivation


def test_ctrl_c_while_deriving_is_not_swallowed(monkeypatch):
    def solve_motion(_system, **_options):
        with contextlib.suppress(KeyboardInterrupt):  # as CasADi's operators do
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(module, "build_subject", lambda _target: SimpleNamespace(system=None))
    monkeypatch.setattr(derivation, "solve_motion", solve_motion)
    with pytest.raises(KeyboardInterrupt):
        module.prepare(None, backend="interpreted", progress=lambda *_: None)
