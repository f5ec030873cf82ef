import copy
import csv
import dataclasses
import inspect
import io

import numpy as np
import pytest

from pareto_monoped.design import (
    BASE_START_HEIGHT_M,
    CONTROL,
    DEFAULTS,
    HEADLINE_HEIGHT_M,
    LENGTHS,
    LOWER,
    NAMES,
    PAPER_CASES,
    PAPER_CONTROL,
    PAPER_MOTOR,
    PAPER_NAMES,
    RATIOS,
    UPPER,
    Design,
    columns,
    complete,
    in_use,
)
from pareto_monoped.errors import DesignError

# Table I of the paper, typed again from its LaTeX source: g_h, g_k, l1, l2, K, C, T, H, E.
TABLE_1 = """\
nominal,6,6,0.4,0.4,50,2.5,10.0,0.887,31.44
A,4,7.9,0.4,0.4,13.7,6.5,46.5,0.743,15.51
B,6,6,0.499,0.346,8.9,1.0,6.9,0.771,17.02
C,4,6,0.49,0.36,7.9,2.2,8.4,0.800,15.36
"""


def test_order_is_the_papers():
    assert NAMES[:7] == PAPER_NAMES
    assert PAPER_NAMES == (
        "thigh_length_m",
        "shank_length_m",
        "knee_ratio",
        "hip_ratio",
        "stiffness_n_per_m",
        "damping_n_s_per_m",
        "torsional_stiffness_n_m_per_rad",
    )


@pytest.mark.parametrize("row", list(csv.reader(io.StringIO(TABLE_1))), ids=lambda row: row[0])
def test_cases_are_table_1(row):
    case = PAPER_CASES[row[0]]
    g_h, g_k, l1, l2, k, c, t, height, energy = map(float, row[1:])
    assert case.design.as_array().tolist() == [l1, l2, g_k, g_h, k, c, t, *DEFAULTS.values()]
    assert (case.height_m, case.energy_j) == (height, energy)


def test_every_variable_is_a_length_a_ratio_or_of_the_controller():
    assert LENGTHS + RATIOS + CONTROL == NAMES


def test_columns_are_found_by_name():
    designs = np.stack([PAPER_CASES[name].design.as_array() for name in ("A", "C")])
    assert columns(designs, RATIOS).tolist() == [[7.9, 4.0], [6.0, 4.0]]
    assert columns(designs, ("hip_ratio", "thigh_length_m")).tolist() == [[4.0, 0.4], [4.0, 0.49]]
    assert columns(designs[0], PAPER_CONTROL).tolist() == [13.7, 6.5, 46.5]
    assert columns(designs[0], CONTROL).tolist() == [13.7, 6.5, 46.5, *DEFAULTS.values()]
    assert columns(designs, CONTROL).flags.c_contiguous


def test_cases_lie_within_the_papers_bounds():
    for case in PAPER_CASES.values():
        values = columns(case.design.as_array(), PAPER_NAMES)
        assert np.all((values >= LOWER) & (values <= UPPER))


def test_array_and_back():
    values = np.linspace(LOWER, UPPER, 3)[1]
    assert Design.from_array(values).as_array().tolist() == [*values.tolist(), *DEFAULTS.values()]
    everything = complete(values) + 0.25
    assert Design.from_array(everything).as_array().tolist() == everything.tolist()


def test_a_design_by_name_leaves_out_optional_variables_at_their_defaults():
    design = PAPER_CASES["A"].design
    assert tuple(design.as_dict()) == PAPER_NAMES
    released = design.replace({"knee_release_rad": 0.3})
    assert released.as_dict() == design.as_dict() | {"knee_release_rad": 0.3}
    assert Design(**released.as_dict()) == released


def test_variables_in_use_are_the_papers_and_those_off_their_defaults():
    values = {name: [1.0, 2.0] for name in PAPER_NAMES} | {"rest_length_m": [10.0, 10.0]}
    assert tuple(variable.name for variable in in_use(values)) == PAPER_NAMES
    used = in_use(values | {"rest_length_m": [10.0, 9.0]})
    assert tuple(variable.name for variable in used) == (*PAPER_NAMES, "rest_length_m")


def test_replace_changes_only_what_is_named():
    design = PAPER_CASES["C"].design
    changed = design.replace({"knee_ratio": 7.0})
    assert changed.knee_ratio == 7.0
    assert changed.as_dict() | {"knee_ratio": 6.0} == design.as_dict()


@pytest.mark.parametrize("changes", [{"kne_ratio": 6.0}, {"knee_ratio": float("nan")}, {"knee_ratio": float("inf")}])
def test_bad_changes_are_refused(changes):
    with pytest.raises(DesignError, match=next(iter(changes))):
        PAPER_CASES["C"].design.replace(changes)


def test_unknown_and_missing_names_of_a_new_design_are_told():
    values = PAPER_CASES["C"].design.as_dict()
    assert Design(**values) == PAPER_CASES["C"].design
    with pytest.raises(DesignError, match=r"'thigh_lenght_m': .* did you mean 'thigh_length_m'\?"):
        Design(**values, thigh_lenght_m=0.4)
    del values["hip_ratio"]
    with pytest.raises(DesignError, match=r"^design: lacks hip_ratio; add them$"):
        Design(**values)
    design = PAPER_CASES["C"].design
    assert copy.copy(design) == dataclasses.replace(design) == design
    assert list(inspect.signature(Design).parameters) == [*NAMES, "profile"]


def test_wrong_number_of_values_is_refused():
    with pytest.raises(DesignError, match=r"\(6,\)"):
        Design.from_array(np.ones(6))


def test_bounds_cannot_be_overwritten():
    with pytest.raises(ValueError, match="read-only"):
        LOWER[0] = 0.0


def test_bounds_are_those_of_the_paper():
    """Section III-B: lengths in m, ratios, K in N/m, C in N s/m, T in N m/rad."""
    assert LOWER.tolist() == [0.3, 0.3, 4.0, 4.0, 5.0, 0.0, 0.0]
    assert UPPER.tolist() == [0.5, 0.5, 8.7, 8.7, 200.0, 10.0, 50.0]


def test_each_case_frees_the_variables_that_the_paper_frees():
    """Section IV-B: A gears and controller, B links and controller, C everything; the nominal design is given."""
    assert {name: case.free for name, case in PAPER_CASES.items()} == {
        "nominal": (),
        "A": RATIOS + PAPER_CONTROL,
        "B": LENGTHS + PAPER_CONTROL,
        "C": PAPER_NAMES,
    }


def test_jumps_start_at_the_papers_height():
    assert (BASE_START_HEIGHT_M, HEADLINE_HEIGHT_M, PAPER_MOTOR) == (0.5, 0.8, "VT8020")


def test_an_unknown_case_is_an_error_of_ours_that_names_the_cases():
    """It was a bare KeyError."""
    with pytest.raises(DesignError, match=r"^case = 'D': must be one of nominal, A, B, C; correct the name$"):
        PAPER_CASES["D"]
    with pytest.raises(DesignError, match="case = 3"):
        PAPER_CASES[3]
    assert PAPER_CASES.get("D") is None
    assert "D" not in PAPER_CASES


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("thigh_length_m", -0.3, "thigh_length_m = -0.3: must be at least 0.05"),
        ("shank_length_m", 0.0, "at least 0.05"),
        ("start_height_m", 0.0, "at least 0.05"),
        ("knee_ratio", 0.5, "knee_ratio = 0.5: must be at least 1"),
        ("hip_ratio", -6, "at least 1"),
        ("stiffness_n_per_m", -1e-9, "at least 0"),
        ("damping_n_s_per_m", -1.0, "at least 0"),
        ("torsional_stiffness_n_m_per_rad", -1.0, "at least 0"),
        ("knee_release_rad", -0.1, "at least 0"),
        ("rest_length_m", -1.0, "at least 0"),
        ("stiffness_n_per_m", 2e9, "at most 1e"),
        ("stiffness_n_per_m", float("nan"), "finite number"),
        ("stiffness_n_per_m", 10**400, "finite number"),
        ("stiffness_n_per_m", "50", "finite number"),
        ("stiffness_n_per_m", True, "finite number"),
        ("stiffness_n_per_m", None, "finite number"),
        ("stiffness_n_per_m", [50.0], "finite number"),
    ],
)
def test_a_design_refuses_values_that_nobody_can_mean(name, value, words):
    """``Design(thigh_length_m=-0.3)`` was accepted."""
    with pytest.raises(DesignError, match=words) as caught:
        Design(**PAPER_CASES["C"].design.as_dict() | {name: value})
    assert "\n" not in str(caught.value)


def test_a_design_takes_numbers_of_any_kind_as_floats():
    design = Design(**PAPER_CASES["C"].design.as_dict() | {"knee_ratio": 6, "hip_ratio": np.float32(4.0)})
    assert design == PAPER_CASES["C"].design
    assert {type(value) for value in design.as_dict().values()} == {float}
