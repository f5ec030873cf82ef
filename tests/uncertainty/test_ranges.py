"""The file of ranges: what is shipped, what a user's own may say, what is refused."""

import numpy as np
import pytest

from pareto_monoped.errors import InputError
from pareto_monoped.uncertainty.settings import LATER_RANGES, load_uncertainty, uncertainty_of


def test_the_shipped_ranges_have_sources_and_are_those_that_the_documents_name():
    shipped = load_uncertainty()
    ends = {name: (found.lower, found.upper) for name, found in shipped.ranges.items()}
    assert ends == {
        "masses": (-0.05, 0.05),
        "peak_torque": (-0.1, 0.13),
        "friction": (-0.6, 0.5),
        "damping": (-0.9, 1.0),
        "stop_stiffness": (-0.3, 0.3),
        "foot_stiffness": (-0.3, 0.3),
        "link_length_m": (-0.0005, 0.0005),
        "gains": (-0.05, 0.05),
        "delay_s": (0.0, 0.003),
        "battery_voltage": (-0.1, 0.0),
        "gear_loss": (-0.5, 1.0),
        "chain_loss": (-0.5, 1.5),
        "winding_resistance": (-0.15, 0.25),
        "rotor_inertia": (-0.2, 0.2),
        "rebound": (-0.4, 0.9),
    }
    assert all(found.source for found in shipped.ranges.values())


def test_ranges_stored_before_losses_were_uncertain_vary_none_of_them():
    """They are read as they were stored, on a stand and elsewhere, and their samples leave these factors at 1."""
    from pareto_monoped.jump.calibration import load_calibration
    from pareto_monoped.uncertainty.samples import sobol_samples, variations

    earlier = {name: value for name, value in load_uncertainty().as_dict().items() if name not in LATER_RANGES}
    for stand in (False, True):
        found = uncertainty_of(earlier, source="stored").where(stand=stand)
        assert not set(LATER_RANGES) & set(found.ranges)
        varied = variations(sobol_samples(found, 16), 2, load_calibration("stand" if stand else "reference"))
        assert all((getattr(varied, name) == 1.0).all() for name in LATER_RANGES)
        assert np.ptp(varied.friction) > 0.1


def test_a_file_replaces_what_it_names(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('name = "mine"\n[masses]\nlower = -0.01\nupper = 0.02\nsource = "weighed"\n')
    own, shipped = load_uncertainty(path), load_uncertainty()
    assert (own.name, own.masses.upper, own.masses.source) == ("mine", 0.02, "weighed")
    assert {n: r for n, r in own.ranges.items() if n != "masses"} == {
        n: r for n, r in shipped.ranges.items() if n != "masses"
    }
    assert uncertainty_of(own.as_dict(), source="again") == own


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[masses]\nlower = 0\nupper = 1\nsource = 'x'\n", ["name is missing"]),
        ('name = "m"\n[mass]\nlower = 0\n', ["unknown key 'mass'", "did you mean 'masses'?"]),
        ('name = "m"\n[masses]\nlower = 0.1\nupper = 0.0\nsource = "x"\n', ["lower 0.1 must not exceed upper 0"]),
        ('name = "m"\n[masses]\nlower = -1.0\nupper = 0.0\nsource = "x"\n', ["masses", "at least -0.9"]),
        ('name = "m"\n[delay_s]\nlower = -0.001\nupper = 0.0\nsource = "x"\n', ["delay_s", "at least 0"]),
        ('name = "m"\n[link_length_m]\nlower = 0\nupper = 0.5\nsource = "x"\n', ["at most 0.01"]),
        ('name = "m"\n[masses]\nlower = 0\nupper = 0.5\n', ["masses.source is missing"]),
        ("name = \n", ["not valid TOML"]),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(tmp_path, text, words):
    path = tmp_path / "mine.toml"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        load_uncertainty(path)
    message = str(caught.value)
    assert "\n" not in message
    for word in [*words, "mine.toml"]:
        assert word in message
