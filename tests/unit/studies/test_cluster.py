"""Dask clusters: only with TLS, and what becomes of cases whose workers die."""

from types import SimpleNamespace

import numpy as np
import pytest

from vehicledyn.base.errors import InputError, MissingPartError, NumericalError
from vehicledyn.results.store.study_layout import FAILED
from vehicledyn.studies.cluster import Cluster, ClusterAddress, open_cluster

distributed = pytest.importorskip("distributed")


class Poisoned:
    """A client whose workers die of one case; blocks are the spans themselves."""

    status = "running"
    scheduler = SimpleNamespace(address="tcp://there")

    def __init__(self, poison):
        self.poison = poison

    def run_on_scheduler(self, _):
        return ["a worker"]

    def submit(self, _, work, first, stop, **__):
        killed = first <= self.poison < stop

        def result(timeout):
            if killed:
                worker = SimpleNamespace(address="a worker")
                raise distributed.KilledWorker("case", worker, 4)
            return (first, stop)

        return SimpleNamespaceKey(done=lambda: True, result=result)

    def cancel(self, _):
        pass


class SimpleNamespaceKey(SimpleNamespace):
    __hash__ = object.__hash__
    __eq__ = object.__eq__


@pytest.fixture
def instant(monkeypatch):
    monkeypatch.setattr(distributed, "wait", lambda *_, **__: None)


def test_a_case_that_kills_workers_fails_alone(instant):
    design = SimpleNamespace(cases=lambda first, stop: np.zeros((stop - first, 1)))
    cluster = Cluster(Poisoned(5), SimpleNamespace(design=design), "workers")
    taken = []
    cluster.compute(iter([(0, 4), (4, 8), (8, 10)]), taken.append)
    whole = sorted(block for block in taken if isinstance(block, tuple))
    assert whole == [(0, 4), (4, 5), (6, 7), (7, 8), (8, 10)]
    (failed,) = (block for block in taken if not isinstance(block, tuple))
    assert (failed.first, len(failed), failed.status[0]) == (5, 1, FAILED)
    assert "the worker process died" in failed.reasons[0]


def test_a_cluster_that_is_gone_is_told(instant):
    client = Poisoned(-1)
    client.status = "closed"
    with pytest.raises(NumericalError, match="the scheduler at tcp://there has gone away"):
        Cluster(client, None, "workers").compute(iter([(0, 1)]), print)


def test_another_program_on_a_worker_ends_the_study(instant):
    client = Poisoned(-1)

    def submit(*_, **__):
        def result(timeout):
            raise InputError("a worker runs another vehicledyn")

        return SimpleNamespaceKey(done=lambda: True, result=result)

    client.submit = submit
    with pytest.raises(InputError, match="another vehicledyn"):
        Cluster(client, None, "workers").compute(iter([(0, 1)]), print)


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:8786", "127.0.0.1:8786", "inproc://x", ""])
def test_addresses_without_tls_are_refused(address, tmp_path):
    with pytest.raises(InputError, match="write tls://HOST:PORT; without TLS anybody"):
        ClusterAddress(address, tmp_path)


def test_keys_that_others_can_use_are_refused(tmp_path):
    address = ClusterAddress("tls://127.0.0.1:9", tmp_path)
    with pytest.raises(InputError, match=r"there is no file ca\.pem"):
        address.security()
    for name in ("ca.pem", "cert.pem", "key.pem"):
        (tmp_path / name).write_text("secret", encoding="utf-8")
        (tmp_path / name).chmod(0o600)
    assert address.security().require_encryption
    for name, mode in (("key.pem", 0o604), ("ca.pem", 0o622), ("cert.pem", 0o602)):
        (tmp_path / name).chmod(mode)
        with pytest.raises(InputError, match=r"others can (read|write)"):
            address.security()
        (tmp_path / name).chmod(0o600)


def test_a_cluster_needs_dask(tmp_path, monkeypatch):
    monkeypatch.setattr("vehicledyn.studies.cluster.find_spec", lambda _: None)
    opened = open_cluster(None, ClusterAddress("tls://127.0.0.1:9", tmp_path))
    with pytest.raises(MissingPartError, match=r"vehicledyn\[cluster\]") as caught:
        opened.__enter__()
    assert isinstance(caught.value, MissingPartError)
