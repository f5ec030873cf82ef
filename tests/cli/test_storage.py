"""``verify`` on the command line."""

import pytest

from pareto_monoped import cli
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run
from tests.analysis.test_verify import path, whole  # noqa: F401  fixtures
from tests.study.support import UNSEALED, change, reseal, study_of


def ended(capsys, *words):
    with pytest.raises(SystemExit) as caught:
        cli.main([str(word) for word in words])
    output = capsys.readouterr()
    return caught.value.code, output.out, output.err


def test_a_sound_study_is_said_to_be_sound(path, capsys):  # noqa: F811
    found = read_study(path).content_hash
    assert ended(capsys, "verify", path) == (0, f"{path}: sound, 50 trials\ncontent hash {found}\n", "")
    assert ended(capsys, "verify", path, "--simulate", "3", "--expect", found[:16].upper()) == (
        0,
        f"{path}: sound, 50 trials, 3 jumped again as stored\ncontent hash {found}\n",
        "",
    )


def test_a_content_hash_finds_what_was_resealed_rolled_back_or_exchanged(path, tmp_path, capsys):  # noqa: F811
    """Each time ``verify`` alone is content; a study that has only grown is told as such."""
    expected, older = read_study(path).content_hash, tmp_path / "older.db"
    run(study_of(evaluations=20, seed=7, strength=False, audit=False, algorithm={"name": "random"}), older)
    earlier = read_study(older).content_hash
    run(study_of(evaluations=30, seed=7, strength=False, audit=False, algorithm={"name": "random"}), older)
    change(path, "UPDATE monoped_trials SET mass_kg = mass_kg + 1e-9 WHERE trial = 3")
    reseal(path)
    for db, hashed, words in (
        (path, expected, "it was changed, an older copy has taken its place, or it is another study"),
        (older, expected, "it was changed, an older copy"),
        (older, earlier, "its first 20 trials have the latter, and 10 have come since"),
    ):
        assert ended(capsys, "verify", db)[0] == 0
        code, out, err = ended(capsys, "verify", db, "--expect", hashed)
        assert (code, out) == (2, "")
        assert words in err


@pytest.mark.parametrize("given", ["abc", "0123456789abcdef0" * 4, "0123456789abcdeg"])
def test_what_is_no_content_hash_is_refused_in_one_line(path, capsys, given):  # noqa: F811
    code, _, err = ended(capsys, "verify", path, "--expect", given)
    assert (code, len(err.splitlines())) == (2, 1)
    assert "give 16 to 64 hexadecimal digits" in err


def test_every_finding_has_a_line(path, capsys):  # noqa: F811
    change(path, "UPDATE studies SET study_name = 'w'", "UPDATE study_directions SET direction = 'MINIMIZE'")
    code, out, err = ended(capsys, "verify", path)
    assert (code, out) == (2, "")
    lines = err.splitlines()
    assert [line.partition(":")[0] for line in lines] == ["found", "found", "error"]
    assert "(and 1 more)" in lines[-1]


def test_a_study_without_a_hash_is_said_to_have_none(path, capsys):  # noqa: F811
    change(path, *UNSEALED)
    code, out, err = ended(capsys, "verify", path)
    assert code == 0
    assert out.startswith(f"{path}: sound, 50 trials\ncontent hash ")
    assert err.startswith("note: the study has no running hash")
