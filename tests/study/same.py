"""When two databases hold the same study."""

from pareto_monoped.storage.extra_rows import read_robustness, read_sensitivity
from pareto_monoped.storage.reader import read_study


def assert_same_study(one, other):
    """Both have the same trials, audits, front, state, settings, robustness and sensitivity, to the last bit."""
    here, there = read_study(one), read_study(other)
    assert there.trials.equals(here.trials)
    assert there.audits.equals(here.audits)
    assert there.front().equals(here.front())
    assert there.checkpoint == here.checkpoint
    assert there.meta.hash == here.meta.hash
    assert there.content_hash == here.content_hash
    assert there.meta.probe == here.meta.probe
    assert there.history["hypervolume"].equals(here.history["hypervolume"])
    assert read_robustness(one) == read_robustness(other)
    assert read_sensitivity(one) == read_sensitivity(other)
