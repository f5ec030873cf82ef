"""Robust evaluation gives an executor the jumps of several chunks at a time, so that many cores have some."""

import threading
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np

from pareto_monoped.actuator.search import map_for
from pareto_monoped.analysis import robustness
from pareto_monoped.analysis.robustness import robust
from pareto_monoped.design import PAPER_CASES, PAPER_MOTOR
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.shared import SharedEvaluator
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run
from pareto_monoped.uncertainty import samples
from pareto_monoped.uncertainty.samples import RobustEvaluator
from pareto_monoped.uncertainty.settings import Sampling, load_uncertainty
from tests.study.support import study_of

LEAST = dict.fromkeys(("gear_safety", "link_safety", "chain_safety", "stop_safety", "joint_safety"), 1.0)


class Together(ThreadPoolExecutor):
    """Does no jumps under uncertainty before those of three pieces of work are there."""

    def __init__(self):
        super().__init__(8)
        self.seen, self.three = set(), threading.Event()

    def submit(self, function, work, text, designs, motors, variations):
        if variations is not None:
            self.seen.add(designs[0].tobytes())
            if len(self.seen) == 3:
                self.three.set()
            function = partial(self.after_three, function)
        return super().submit(function, work, text, designs, motors, variations)

    def after_three(self, function, *arguments):
        assert self.three.wait(timeout=60.0), "the other pieces do not come"
        return function(*arguments)


def test_robust_keeps_the_workers_busy_over_its_chunks(few_samples, tmp_path, monkeypatch):
    """One chunk after the other ended with most of many workers idle."""
    monkeypatch.setattr(robustness, "_SHARED", 1)
    run(study_of(name="s", evaluations=16, audit=False, algorithm={"name": "random"}), tmp_path / "s.db", workers=2)
    trials = read_study(tmp_path / "s.db").trials.query("status == 'ok'")["trial"].tolist()[:3]
    (tmp_path / "t.db").write_bytes((tmp_path / "s.db").read_bytes())
    done, settings = [], {"trials": trials, "samples": 32}
    with Together() as pool:
        there = robust(
            tmp_path / "t.db", load_uncertainty(), executor=pool, progress=lambda n, _: done.append(n), **settings
        )
    assert done == [1, 2, 3]
    assert list(there) == trials
    assert robust(tmp_path / "s.db", load_uncertainty(), workers=2, **settings) == there


def test_robust_objectives_keep_the_workers_busy_over_their_chunks(monkeypatch):
    monkeypatch.setattr(samples, "_JUMPS", 16)
    designs = np.array([PAPER_CASES[name].design.as_array() for name in ("A", "B", "C")])
    gearboxes, calibration = map_for(PAPER_MOTOR), load_calibration()
    names, sampling = (
        ("height_m.p05", "failed_share", "overloaded_share"),
        Sampling(ranges=load_uncertainty(), samples=16, seed=1),
    )
    with Together() as pool:
        shared = SharedEvaluator(gearboxes, calibration, executor=pool)
        found = RobustEvaluator(evaluator=shared, sampling=sampling, names=names, least=LEAST)(designs)
    alone = RobustEvaluator(evaluator=Evaluator(gearboxes, calibration), sampling=sampling, names=names, least=LEAST)
    expected = alone(designs)
    for name in names:
        assert np.array_equal(found.of(name), expected.of(name))
