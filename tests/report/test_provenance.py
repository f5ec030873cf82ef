from pareto_monoped.report.summary import command, provenance


def test_every_setting_and_version_is_listed_once(data):
    rows = dict(map(tuple, provenance(data)))
    assert len(rows) == len(provenance(data))
    assert rows["study"] == data.study.name
    assert rows["seed"] == "3"
    assert rows["state"] == "finished"
    assert rows["settings hash (SHA-256)"] == data.meta.hash
    assert rows["version of mujoco"] == data.meta.versions["mujoco"]
    assert rows["algorithm.name"] == data.study.algorithm.name
    assert rows["reference_point.energy_j"] == f"{data.reference_point.as_dict()['energy_j']:g}"


def test_the_command_runs_the_study_with_its_seed_and_budget(data):
    assert command(data) == "pareto-monoped run STUDY.toml --seed 3 --evaluations 200"
