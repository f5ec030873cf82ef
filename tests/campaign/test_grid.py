"""Campaign files: which studies they make, what they are called, and what is refused."""

import pytest

from pareto_monoped.campaign.grid import LONGEST, MOST_STUDIES, joined, load_campaign, names_of
from pareto_monoped.errors import MotorError, StudyError

HEAD = 'name = "grid"\n[study]\nevaluations = 100\ncase = "C"\n'


def written(folder, axes, head=HEAD):
    path = folder / "grid.toml"
    path.write_text(f"{head}[axes]\n{axes}\n", encoding="utf-8")
    return path


def test_every_combination_is_a_study_named_by_what_varies(tmp_path):
    campaign = load_campaign(written(tmp_path, 'motors = ["U8", "VT8020"]\nevaluations = [60]\nseeds = [1, 2, 7]'))
    assert [member.name for member in campaign.members] == [
        f"{motor}_seed{seed}" for motor in ("U8", "VT8020") for seed in (1, 2, 7)
    ]
    assert campaign.axes == ("motors", "seeds")
    last = campaign.members[-1]
    assert (last.study.motor, last.study.seed, last.study.evaluations) == ("VT8020", 7, 60)
    assert (last.study.name, dict(last.labels)) == ("VT8020_seed7", {"motors": "VT8020", "seeds": "seed7"})
    assert campaign.folder == tmp_path / "grid"


def test_the_base_is_a_file_and_paths_are_relative_to_the_file_that_names_them(tmp_path):
    (tmp_path / "bases").mkdir()
    (tmp_path / "bases" / "base.toml").write_text(
        'name = "b"\nevaluations = 50\ncalibration = "own.toml"\n[algorithm]\nname = "nsga2"\npopulation = 10\n'
    )
    head = 'name = "grid"\nstudy = "bases/base.toml"\n'
    campaign = load_campaign(written(tmp_path, 'motors = ["U8", "mine.toml", ["U8", "mine.toml"]]', head))
    one, mine, both = (member.study for member in campaign.members)
    assert one.calibration == str(tmp_path / "bases" / "own.toml")
    assert mine.motor == str(tmp_path / "mine.toml")
    assert both.motor == ("U8", str(tmp_path / "mine.toml"))
    assert [member.name for member in campaign.members] == ["U8", "mine", "U8+mine"]
    assert one.algorithm.population == 10


def test_a_table_of_an_axis_is_added_to_that_of_the_base(tmp_path):
    head = HEAD + "[study.variables]\nthigh_length_m = 0.4\n[study.constraints]\nmass_kg = { max = 4.5 }\n"
    axes = "variables = [{ knee_ratio = 5.0 }, { knee_ratio = 6.0, thigh_length_m = 0.35 }]"
    first, second = (member.study for member in load_campaign(written(tmp_path, axes, head)).members)
    assert (first.variables["thigh_length_m"], first.variables["knee_ratio"]) == (0.4, 5.0)
    assert (second.variables["thigh_length_m"], second.variables["knee_ratio"]) == (0.35, 6.0)
    assert first.constraints.value("max_mass_kg") == 4.5


def test_other_objectives_keep_what_the_reference_point_says_of_them_alone(tmp_path):
    head = HEAD + "[study.reference_point]\nheight_m = 0.6\nenergy_j = 80.0\n"
    axes = 'objectives = [["height_m", "energy_j"], ["height_m", "electrical_energy_j"]]'
    by_energy, by_battery = load_campaign(written(tmp_path, axes, head)).members
    assert by_energy.study.reference_point.as_dict() == {"height_m": 0.6, "energy_j": 80.0}
    assert by_battery.study.reference_point.as_dict()["height_m"] == 0.6
    assert (by_energy.name, by_battery.name) == ("energy_j", "electrical_energy_j")


def test_without_an_axis_that_varies_the_study_has_the_name_of_the_campaign(tmp_path):
    (member,) = load_campaign(written(tmp_path, "seeds = [3]", HEAD.replace('"grid"', '"my grid: 1"'))).members
    assert (member.name, member.study.seed) == ("my-grid-1", 3)


@pytest.mark.parametrize(
    ("axes", "words"),
    [
        ('motor = ["U8"]', ("table [axes]", "unknown key 'motor'", "did you mean 'motors'?")),
        ("seeds = []", ("table [axes]", "seeds = []", "a list that is not empty")),
        ("seeds = 3", ("table [axes]", "seeds = 3", "list")),
        ("", ("axes: none is named", "motors")),
        ("seeds = [1, 2, 1]", ("axes.seeds: 1 is named 2 times", "name it once")),
        ('motors = ["U8", "u8"]', ("axes.motors: 'U8' is named 2 times",)),
        ("seeds = [1, -1]", ("study 'seed-1'", "seed = -1", "at least 0")),
        ('algorithms = ["nsga2", "nsga3"]', ("study 'nsga3'", "algorithm.name = 'nsga3'", "must be one of")),
        ('objectives = [["height_m", "speed"]]', ("study 'grid'", "speed")),
        ("variables = [{ knee = 5.0 }]", ("variable = 'knee'", "must be one of")),
    ],
)
def test_refused_in_one_line_that_says_what_is_allowed(tmp_path, axes, words):
    with pytest.raises(StudyError) as caught:
        load_campaign(written(tmp_path, axes))
    message = str(caught.value)
    assert message.startswith(f"campaign file {str(tmp_path / 'grid.toml')!r}")
    assert "\n" not in message
    for word in words:
        assert word in message


@pytest.mark.parametrize(
    ("head", "words"),
    [
        ('name = "grid"\nseed = 3\n', ("unknown key 'seed'", "allowed: axes, description, name, study")),
        ('name = "grid"\n', ("study = None", "the name of a study file")),
        ('name = "grid"\nstudy = "none.toml"\n', ("study file", "none.toml", "no such file")),
        (HEAD + "evaluatoins = 3\n", ("study 'grid'", "unknown key 'evaluatoins'", "did you mean 'evaluations'?")),
    ],
)
def test_a_file_that_is_wrong_elsewhere_is_refused(tmp_path, head, words):
    with pytest.raises(StudyError) as caught:
        load_campaign(written(tmp_path, "seeds = [1]", head))
    for word in words:
        assert word in str(caught.value)


def test_names_that_are_alike_only_together_are_refused(tmp_path):
    """The values of each axis have different names."""
    axes = 'motors = ["a_b.toml", "a.toml"]\ncalibrations = ["c.toml", "b_c.toml"]'
    with pytest.raises(StudyError, match="2 studies would be named 'a_b_c'; rename one of the files"):
        load_campaign(written(tmp_path, axes))


def test_too_many_studies_are_counted_and_refused_before_any_is_made(tmp_path):
    seeds = list(range(20_000))
    with pytest.raises(StudyError, match=f"make 40000 studies .2 motors x 20000 seeds.: must be {MOST_STUDIES} at"):
        load_campaign(written(tmp_path, f'motors = ["U8", "U10"]\nseeds = {seeds}'))


@pytest.mark.parametrize(
    ("axis", "values", "names"),
    [
        ("algorithms", [{"name": "nsga2", "population": 60}, "nsga2"], ["nsga2-population-60", "nsga2"]),
        ("constraints", [{"mass_kg": {"max": 4.0}}, {"mass_kg": {"max": 4.5}}], ["mass_kg-max-4", "mass_kg-max-4.5"]),
        ("evaluations", [100, 200], ["jumps100", "jumps200"]),
        ("cases", ["A", "B"], ["case-A", "case-B"]),
        ("objectives", [["mass_kg", "energy_j"], ["energy_j", "mass_kg"]], ["mass_kg-energy_j", "energy_j-mass_kg"]),
        ("motors", ["../../etc/passwd", "a b"], ["etc-passwd", "a-b"]),
    ],
)  # fmt: skip
def test_names_say_what_differs_and_fit_into_a_file_name(axis, values, names):
    assert names_of(axis, values) == names


def test_names_that_would_be_alike_get_a_mark_of_their_own():
    names = names_of("motors", ["a/mine.toml", "b/MINE.toml", "c" * 80, "c" * 81])
    assert len({name.casefold() for name in names}) == 4
    assert all(len(name) <= 48 for name in names)
    assert names == names_of("motors", ["a/mine.toml", "b/MINE.toml", "c" * 80, "c" * 81])
    assert len(joined(["x" * 48] * 6)) == LONGEST
    assert joined(["x" * 48] * 6) != joined(["x" * 48] * 7)


def test_an_unknown_motor_is_refused_before_any_study_runs(tmp_path):
    """It was the end of its own studies only, after the others."""
    with pytest.raises(MotorError, match="study 'U9': motor = 'U9': must be one of VT8020, U8"):
        load_campaign(written(tmp_path, 'motors = ["U8", "U9"]'))
