"""Arrays kept on disk: the same to the last bit as computed, never trusted, and never in the way."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from pareto_monoped import files
from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.search import build_map
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.design import RULE_SETS
from pareto_monoped.files import CACHE, kept

FIRST = {"a": np.array([1.0, np.nan, -0.0]), "b": np.arange(6).reshape(2, 3)}
PROGRAM = """
import hashlib, sys
import numpy as np
from pareto_monoped.actuator.ratiomap import JointMaps
from pareto_monoped.actuator.search import build_map, map_for
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.design import LOWER, UPPER
from pareto_monoped.robot.population import robot_arrays
from pareto_monoped.strength import factors
from pareto_monoped.strength.factors import LOAD_NAMES, strength_factors

if sys.argv[1] == "second":
    factors._blocks = None  # what is read is not computed
designs = np.random.default_rng(1).uniform(LOWER, UPPER, size=(20, len(LOWER)))
loads = dict.fromkeys(LOAD_NAMES, np.linspace(1.0, 500.0, 20))


def fingerprint(maps):
    maps = JointMaps(hip=maps[0], knee=maps[1])
    robots = robot_arrays(designs, maps)
    numbers = [getattr(robots, name) for name in robots.__dataclass_fields__]
    numbers = [each for each in numbers if isinstance(each, np.ndarray)] + [strength_factors(designs, maps, loads)]
    return hashlib.sha256(b"".join(np.ascontiguousarray(each).tobytes() for each in numbers)).hexdigest()


# The same map at either joint, in other legs, and under other rules.
for hip, knee, rules in (("M", "M", "iso6336"), ("M", "M", "paper"), ("N", "M", "paper")):
    maps = [map_for({"M": "MAD_M6C12", "N": "MN8014"}[name], rules) for name in (hip, knee)]
    said = fingerprint(maps)
    print(said)
if sys.argv[1] == "first":  # the last one again, of maps of which nothing is kept
    motors = [each.motor for each in maps]
    assert said == fingerprint([build_map(motor, ActuatorSettings(rules=rules)) for motor in motors])
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv(CACHE, str(tmp_path / "kept"))
    return tmp_path / "kept"


def never():
    raise AssertionError("it was computed")


def assert_first(found):
    assert list(found) == list(FIRST)
    for name, values in FIRST.items():
        assert found[name].dtype == values.dtype
        assert found[name].tobytes() == values.tobytes()


def test_what_is_kept_is_read_and_not_computed(folder):
    assert_first(kept("key", lambda: FIRST))
    assert_first(kept("key", never))
    with pytest.raises(AssertionError, match="computed"):
        kept("other key", never)
    with pytest.raises(AssertionError, match="computed"):
        kept(None, never)
    assert [path.suffix for path in folder.iterdir()] == [".npz"]


def test_another_process_has_the_same_robots_to_the_last_bit(folder):

    def said(which, cache):
        environment = os.environ | {CACHE: cache}
        words = [sys.executable, "-c", PROGRAM, which]
        return subprocess.run(words, env=environment, capture_output=True, text=True, check=True).stdout

    assert said("first", str(folder)) == said("second", str(folder))


@pytest.mark.parametrize("damage", ["cut", "empty", "text", "bit", "pickle"])
def test_a_damaged_file_is_computed_again_and_nothing_of_it_runs(folder, damage):
    class Trap:
        def __reduce__(self):
            return Path.touch, (folder / "sprung",)

    kept("key", lambda: FIRST)
    (path,) = folder.iterdir()
    whole = path.read_bytes()
    if damage == "pickle":
        np.savez(path, a=np.array([Trap()], dtype=object))
        assert b"sprung" in path.read_bytes()
    else:
        path.write_bytes({"cut": whole[:-40], "empty": b"", "text": b"no archive", "bit": flipped(whole)}[damage])
    assert_first(kept("key", lambda: FIRST))
    assert_first(kept("key", never))
    assert list(folder.iterdir()) == [path]


def flipped(data):
    """With one bit of the first array's numbers turned over."""
    place = data.index(FIRST["a"].tobytes()) + 3
    return data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :]


def test_another_version_of_the_code_computes_anew(folder, monkeypatch):
    kept("key", lambda: FIRST)
    monkeypatch.setattr(files, "_stamp", lambda: "other")
    with pytest.raises(AssertionError, match="computed"):
        kept("key", never)


def test_every_file_of_code_and_data_counts(tmp_path, monkeypatch):
    files._stamp.cache_clear()
    before = files._stamp()
    for name in ("one.py", "deep/two.toml"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("1")
    (tmp_path / ".#lock.py").symlink_to("nothing")
    monkeypatch.setattr(files, "__file__", str(tmp_path / "files.py"))
    stamps = [before]
    for name in ("one.py", "deep/two.toml"):
        (tmp_path / name).write_text("2")
        files._stamp.cache_clear()
        stamps.append(files._stamp())
    files._stamp.cache_clear()
    assert len(set(stamps)) == 3


def test_without_a_place_to_write_arrays_are_computed(tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))  # which an empty variable of ours does not lead to
    for place in (tmp_path / "file" / "kept", ""):
        monkeypatch.setenv(CACHE, str(place))
        for _ in range(2):
            assert_first(kept("key", lambda: FIRST))
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_the_oldest_files_go(folder, monkeypatch):
    monkeypatch.setattr(files, "_MOST_KEPT", 3)
    for number in range(5):
        kept(str(number), lambda: FIRST)
        newest = max(folder.iterdir(), key=lambda path: path.stat().st_ctime_ns)
        os.utime(newest, (number, number))
    assert sorted(path.stat().st_mtime for path in folder.iterdir()) == [2, 3, 4]


def test_the_place_is_the_cache_of_the_user(tmp_path, monkeypatch):
    monkeypatch.delenv(CACHE)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    kept("key", lambda: FIRST)
    assert [path.parent for path in tmp_path.rglob("*.npz")] == [tmp_path / "pareto_monoped"]


@pytest.mark.parametrize("rules", RULE_SETS)
def test_a_map_from_what_is_kept_is_that_of_the_search(folder, rules):
    """To the type of each number: both print alike."""
    motor, settings = load_motor("MAD_M6C12"), ActuatorSettings(rules=rules)
    searched = build_map(motor, settings)
    assert list(folder.glob("*")) == []
    for _ in range(2):
        found = build_map(motor, settings, keep=True)
        assert found.entries == searched.entries
        for one, other in zip(found.entries, searched.entries, strict=True):
            assert repr((one.runner_up, one.families, one.binding)) == repr(
                (other.runner_up, other.families, other.binding)
            )
    assert len(list(folder.glob("*"))) == (motor.framed is not None) + (motor.frameless is not None)


def test_a_home_that_does_not_exist_is_not_made(tmp_path, monkeypatch):
    """A fuzzer's calls once made /nonexistent, Debian's home of users without one."""
    for name in (CACHE, "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "nonexistent"))
    assert_first(kept("key", lambda: FIRST))
    assert not (tmp_path / "nonexistent").exists()
    monkeypatch.setenv("HOME", str(tmp_path))
    assert_first(kept("key", lambda: FIRST))
    assert list((tmp_path / ".cache" / "pareto_monoped").glob("*.npz"))
