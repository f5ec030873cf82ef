"""MuJoCo leaves no log, whatever a jump comes to."""

from concurrent.futures import ThreadPoolExecutor

import mujoco
import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.jump.audit import audit
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.quiet import quiet
from pareto_monoped.jump.single import simulate
from tests.jump.robots import wild_calibration

DESIGN = PAPER_CASES["nominal"].design


def config():
    now = mujoco.MjLogConfig.get()
    return now.logto_console, now.logto_file


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def ask(what):
    maps, wild, values = map_for("VT8020"), wild_calibration(), DESIGN.as_array()[None, :]
    if what == "batch":
        return Evaluator(maps, wild)(np.vstack((values, values))).status[0]
    if what == "trace":
        return simulate(DESIGN, maps, wild, trace=True).status
    return audit(values, maps, wild).as_columns()["status"][0]


@pytest.mark.parametrize("what", ["batch", "trace", "audit"])
def test_a_jump_that_diverges_leaves_no_log_and_prints_nothing(folder, capfd, what):
    before = config()
    assert ask(what) == "diverged"
    assert list(folder.iterdir()) == []
    assert capfd.readouterr() == ("", "")
    assert config() == before == (True, True)


def test_overlapping_users_restore_what_was_set_before(folder):
    def use(_):
        for _ in range(200):
            with quiet():
                assert config() == (False, False)

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(use, range(4)))
    assert config() == (True, True)
