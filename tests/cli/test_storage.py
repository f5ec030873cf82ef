"""``verify`` on the command line."""

import pytest

from pareto_monoped import cli
from tests.analysis.test_verify import path, whole  # noqa: F401  fixtures
from tests.study.support import UNSEALED, change


def ended(capsys, *words):
    with pytest.raises(SystemExit) as caught:
        cli.main([str(word) for word in words])
    output = capsys.readouterr()
    return caught.value.code, output.out, output.err


def test_a_sound_study_is_said_to_be_sound(path, capsys):  # noqa: F811
    assert ended(capsys, "verify", path) == (0, f"{path}: sound, 50 trials\n", "")
    assert ended(capsys, "verify", path, "--simulate", "3") == (
        0,
        f"{path}: sound, 50 trials, 3 jumped again as stored\n",
        "",
    )


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
    assert (code, out) == (0, f"{path}: sound, 50 trials\n")
    assert err.startswith("note: the study has no running hash")
