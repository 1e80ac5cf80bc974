"""Linearised models in state space, from Python and as files."""

import errno

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.errors import InputError, MissingPartError

OUTPUTS = ["body.height", "strut.force"]


@pytest.fixture(scope="module")
def model():
    """Return a quarter car under a force."""
    return vd.linearise("quarter_car", "force:body.height", OUTPUTS)


def test_it_has_the_response_of_the_model(model):
    """To rounding."""
    found = vd.response(
        "quarter_car", "force:body.height", OUTPUTS, first="0.3 Hz", last="20 Hz", points=5
    )
    expected = np.squeeze(found["response"].values)
    own = model.system.response(found["frequency"].values)[:, :, 0]
    assert own == pytest.approx(expected, rel=1e-12)
    assert model.states == ("wheel.height", "body.height", "wheel.height_rate", "body.height_rate")
    assert "input   force:body.height [N]" in model.as_text()


def test_files_hold_matrices_and_names(model, tmp_path):
    """Both are read again as they were written; other endings are refused."""
    from scipy.io import loadmat

    with np.load(model.save(tmp_path / "model.npz")) as found:
        assert (found["A"] == model.system.a).all()
        assert list(found["outputs"]) == OUTPUTS
    matlab = loadmat(model.save(tmp_path / "model.mat"), squeeze_me=True)
    assert np.reshape(matlab["B"], (4, 1)) == pytest.approx(model.system.b)
    assert list(matlab["output_units"]) == ["m", "N"]
    with pytest.raises(InputError, match=r"\.mat or \.npz"):
        model.save(tmp_path / "model.txt")


@pytest.mark.parametrize(
    ("name", "writer"), [("model.npz", "numpy.savez"), ("model.mat", "scipy.io.savemat")]
)
def test_a_disk_that_fills_up_leaves_the_file_that_was_there(
    model, tmp_path, monkeypatch, name, writer
):
    def write_half(file, *_, **__):
        file.write(b"half")
        raise OSError(errno.ENOSPC, "No space left on device")

    path = tmp_path / name
    path.write_bytes(b"whole")
    monkeypatch.setattr(writer, write_half)
    with pytest.raises(InputError, match="No space left on device"):
        model.save(path)
    assert [place.name for place in tmp_path.iterdir()] == [name]
    assert path.read_bytes() == b"whole"


def test_control_is_optional(model):
    """With python-control its names are those of the model; without it a message says so."""
    try:
        import control  # noqa: F401
    except ImportError:
        with pytest.raises(MissingPartError, match="pip install control"):
            model.to_control()
        return
    found = model.to_control()
    assert found.output_labels == [name.replace(".", "_") for name in OUTPUTS]
    assert (model.system.a == found.A).all()


def test_wrong_names_and_orders_are_refused():
    """Each with one clear message."""
    with pytest.raises(InputError, match="order"):
        vd.linearise("quarter_car", "force:body.height", OUTPUTS, order=9)
    with pytest.raises(InputError, match=r"body\.hight"):
        vd.linearise("quarter_car", "force:body.height", "body.hight")
