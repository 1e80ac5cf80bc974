"""USE_MODE of tyre property files: which forces act, and what else a file asks for."""

import math
from dataclasses import astuple
from importlib import resources

import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.road.tyres.asked_modes import asked
from vehicledyn.road.tyres.pac2002 import Pac2002
from vehicledyn.road.tyres.tyre import TyreInput
from vehicledyn.road.tyres.tyre_of_file import TyreOfFile

PAC = "passenger_235_60R16_pac2002.tir"
MF61 = "passenger_R0394_mf61.tir"
FELT = (4e3, 0.04, 0.05, 0.02, 20.0)


@pytest.fixture
def written(tmp_path):
    def write(mode, **settings):
        text = (resources.files("vehicledyn.library.tyres") / PAC).read_text()
        path = tmp_path / f"of_mode_{mode}.tir"
        path.write_text(text.replace("USE_MODE = 4", f"USE_MODE = {mode}"))
        return TyreOfFile(file=str(path), **settings)

    return write


def forces(tyre, *felt):
    return [float(force) for force in astuple(tyre.forces(TyreInput(*(felt or FELT))))]


def test_the_last_digit_says_which_forces_act(written):
    load, slip, angle, camber, speed = FELT
    whole = forces(written(4))
    along = forces(written(4), load, slip, 0.0, camber, speed)
    across = forces(written(4, scaling={"LS": 0}), load, 0.0, angle, camber, speed)
    assert abs(whole[0] - along[0]) > 100 and abs(whole[1] - across[1]) > 100
    assert forces(written(0)) == [0.0] * 5
    assert forces(written(1)) == [along[0], 0.0, 0.0, 0.0, along[4]]
    assert forces(written(2)) == [0.0, *across[1:4], 0.0]
    for mode in (3, 13, 23, -3):
        assert forces(written(mode)) == [along[0], *across[1:4], along[4]]
    assert forces(written(25)) == forces(written(3, acting="combined")) == whole
    assert not written(2).pulls_along and not written(1).has_overturning_moment


def test_a_negative_mode_mirrors(written):
    usual, turned = written(4), written(-4)  # a file of a left tyre
    assert turned.mounted("left").mirror == usual.mounted("right").mirror == "always"
    assert turned.mounted("right").mirror == usual.mounted("left").mirror == "never"


@pytest.mark.parametrize("mode", [6, 44, 4.5, 604])
def test_modes_that_there_are_not_are_refused(written, mode):
    with pytest.raises(InputError, match=rf"USE_MODE: no mode {mode:g}; the last digit is 0 to 5"):
        _ = written(mode).content


def test_what_a_file_asks_for_is_told(written):
    told = [" ".join(asked(written(mode))) for mode in (4, 2, 13, 25, -14)]
    assert told[0] == "" and "only side force" in told[1]
    assert "do not weaken" in told[2] and "kind: of_tyre" in told[2]
    assert "turn slip" in told[3] and "kind: contact_patch" in told[3]
    assert "mirror image" in told[4] and not list(asked(written(14), relaxed=True))
    assert not list(asked(written(1, acting="combined")))


def test_unknown_names_and_pressures_outside_the_range_are_told(tmp_path):
    text = (resources.files("vehicledyn.library.tyres") / MF61).read_text()
    (tmp_path / "b.tir").write_text(text.replace("PKY3 =", "PKY33 ="))
    (told,) = asked(TyreOfFile(file=str(tmp_path / "b.tir")))
    assert told == "b.tir: names without effect, since no law knows them: PKY33"
    (told,) = asked(TyreOfFile(file=MF61, pressure="1 bar"))
    assert "the pressure of 100 kPa is outside the file's 200 to 400 kPa" in told
    assert not list(asked(TyreOfFile(file=MF61, pressure="2.2 bar")))


def test_the_rolling_radius_of_the_file(tmp_path):
    """MF 6.1: R_e = R_0 - ρ_0 (D atan(B F_z/F_z0) + F F_z/F_z0) at 6 kN; 0.3943 m, 315 kN/m."""
    law = TyreOfFile(file=MF61, rolling="file")
    nominal, pressed = 6752 / 314931.2969, 6000 / 6752
    loaded = 0.3943 - nominal * pressed
    wanted = 0.3943 - nominal * (0.23778 * math.atan(6.217 * pressed) + 0.080544 * pressed)
    assert law.rolling_radius(0.3943, loaded, 0.0) == pytest.approx(wanted, rel=1e-12)
    assert law.rolling_radius(0.3943, 0.4, 0.0) == 0.3943  # in the air
    assert TyreOfFile(file=MF61).rolling_radius(0.3943, loaded, 0.0) == loaded
    text = (resources.files("vehicledyn.library.tyres") / MF61).read_text()
    (tmp_path / "c.tir").write_text(text.replace("BREFF =", "BREFF = 0 $"))
    (problem,) = TyreOfFile(file="c.tir", rolling="file").problems_beside(tmp_path)
    assert "rolling: the file has no rolling radius" in problem


SEDAN = {"file": "passenger_245_40R18_pac2002.tir"}


def test_without_coefficients_of_combined_slip_slips_combine_by_the_friction_ellipse():
    """Once both forces came out whole: 1.4 times the friction."""
    law = TyreOfFile(**SEDAN)
    fx, fy, *_ = forces(law, 4e3, 0.1, 0.12, 0.0, 20.0)
    chrono = Pac2002(**SEDAN, convention="chrono", combined="ellipse")
    near = forces(chrono, 4e3, 0.1, 0.12, 0.0, 20.0)
    assert (fx, fy) == pytest.approx(near[:2], rel=0.02)
    whole = forces(TyreOfFile(**SEDAN, acting="uncombined"), 4e3, 0.1, 0.12, 0.0, 20.0)
    assert (fx / whole[0]) ** 2 + (fy / whole[1]) ** 2 == pytest.approx(1.0, abs=0.05)
    for felt, k in (((4e3, 0.1, 0.0), 0), ((4e3, 0.0, 0.12), 1)):  # pure slip keeps its curves
        pure = forces(TyreOfFile(**SEDAN, acting="uncombined"), *felt, 0.0, 20.0)
        assert forces(law, *felt, 0.0, 20.0)[k] == pytest.approx(pure[k], rel=1e-12)
    assert "no coefficients of combined slip" in " ".join(asked(law))


def test_the_file_may_choose_the_friction_ellipse(written, tmp_path):
    text = written(4).path.read_text()
    for method in ("YES", "NO"):
        (tmp_path / f"{method}.tir").write_text(
            text.replace("USE_MODE = 4", f"USE_MODE = 4\nFE_METHOD = '{method}'")
        )
    ellipse, weights = (TyreOfFile(file=str(tmp_path / f"{m}.tir")) for m in ("YES", "NO"))
    assert forces(weights) == forces(written(4)) != forces(ellipse)
    assert "FE_METHOD 'YES'" in " ".join(asked(ellipse)) and not list(asked(weights))
    assert ellipse.law.ellipse == "shifted" and weights.ellipse is None
    assert TyreOfFile(**SEDAN, acting="lateral").ellipse is None


def test_forces_at_little_slip_change_slowly_on_the_ellipse():
    """Conicity and plysteer give forces at no slip; they must not jump as slip begins."""
    law = TyreOfFile(**SEDAN)
    rest = forces(law, 4e3, 0.0, 0.0, 0.0, 20.0)
    for slip, angle in ((1e-6, 0.0), (0.0, 1e-6), (-1e-6, 1e-6)):
        near = forces(law, 4e3, slip, angle, 0.0, 20.0)
        assert near == pytest.approx(rest, abs=0.3)


@pytest.mark.parametrize("felt", [(0.0, 0.0), (0.0, 0.5), (-1.0, 0.0), (-1.0, 1.5), (50.0, -1.57)])
def test_the_ellipse_is_finite_everywhere_and_within_friction(felt):
    for load in (0.0, 1e-6, 4e3, 1e5):
        fx, fy, *_ = forces(TyreOfFile(**SEDAN), load, *felt, 0.05, 20.0)
        assert (fx**2 + fy**2) ** 0.5 <= 1.3 * load


def test_ways_of_chrono_need_its_convention():
    with pytest.raises(ValueError, match="combined: a rule of Chrono; give 'convention: chrono'"):
        Pac2002(file=PAC, combined="none")
    with pytest.raises(ValueError, match="combined: a rule of Chrono; give 'convention: chrono'"):
        TyreOfFile(file=PAC, combined="none")


def test_the_law_of_a_file_combines_slips_by_the_rule_that_is_named():
    """The key was refused without 'kind: pac2002'."""
    for way in ("ellipse", "none"):
        given = {**SEDAN, "convention": "chrono", "combined": way}
        felt = 4e3, 0.1, 0.12, 0.0, 20.0
        assert forces(TyreOfFile(**given), *felt) == forces(Pac2002(**given), *felt)
