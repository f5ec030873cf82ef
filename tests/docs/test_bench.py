"""docs/bench.md: its tables are those that its script prints, and the script finds losses that are known."""

import importlib
import re

import numpy as np
import pytest

from tests.docs.prose import between, untold
from tests.docs.scripts import ROOT, imported, rows

PAGE = (ROOT / "docs" / "bench.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def bench():
    with imported("actuator_bench") as found:
        yield found


def test_the_page_shows_what_its_script_prints(bench, capsys):
    bench.print_tables({name: bench.torques(bench.read(name)) for name in bench.RATIOS})
    printed = [rows(table) for table in capsys.readouterr().out.strip().split("\n\n")]
    shown = re.findall(r"<!-- made by: python benchmarks/actuator_bench.py -->\n((?:\|.*\n)+)", PAGE)
    assert len(printed) == 6
    assert [rows(table) for table in shown] == printed


def made(rng, *, kt=1.04, split=0.03, coulomb=0.4, viscous=0.02, cell=0.6, noise=0.0):
    """Runs of a made-up bench: each actuator as rotor, teeth and friction, each drive as windings and switches.

    ``split`` is the share of the torque that the teeth of either actuator lose, ``coulomb`` and ``viscous`` their other
    friction; the load cell reads ``cell`` of the torque in the shaft.
    """
    lines = []
    for command in range(1, 19):
        for rpm in (10, 20, 30, 40, 50):
            speed = rpm * np.pi / 30.0
            motor = kt * command
            shaft = motor - split * motor - coulomb - viscous * speed
            brake = shaft - split * shaft - coulomb - viscous * speed
            driving_a, braking_a = 1.5 * command, 1.3 * brake  # currents, whatever their unit
            taken = motor * speed + 0.9 * driving_a + 0.07 * driving_a**2
            given = brake * speed - 1.1 * braking_a - 0.05 * braking_a**2
            watts = rng.normal(0.0, noise, 2)
            lines.append((command, speed, taken + watts[0], given + watts[1], 0.9 * brake, cell * shaft))
    return np.rec.fromrecords(lines, names="command_n_m,speed,test_w,load_w,load_n_m,cell_n_m")


def test_torques_follow_from_powers_alone(bench):
    """Without viscous friction, no constant of either drive is needed, and a wrong load cell changes nothing."""
    for cell in (0.6, 1.0):
        runs = made(np.random.default_rng(0), viscous=0.0, cell=cell)
        found = bench.torques(runs)
        assert found.driving == pytest.approx(1.04 * found.command, rel=1e-9)
        both = bench.pair(found, range(1, 19))
        assert both.slope == pytest.approx(0.97**2, rel=1e-9)
        assert both.offset == pytest.approx(0.4 * 0.97 + 0.4, rel=1e-9)
        assert found.drift == pytest.approx(0.0, abs=1e-12)
        assert found.held == pytest.approx(0.9 * 1.5 * found.command + 0.07 * (1.5 * found.command) ** 2, rel=1e-9)


def test_viscous_friction_is_seen_in_the_drift(bench):
    found = bench.torques(made(np.random.default_rng(0), viscous=0.02))
    assert found.drift[5:] == pytest.approx(0.02 * 1.97, rel=0.15)


def test_the_truth_lies_within_the_intervals(bench):
    """Powers off by 0.2 W, as on the bench: 95 percent intervals hold the truth in about that share of 200 benches."""
    held = []
    for seed in range(200):
        runs = made(np.random.default_rng(seed), viscous=0.0, noise=0.2)
        both = bench.pair(bench.torques(runs), range(1, 19))
        held.append((abs(both.slope - 0.97**2) <= both.slope_pm, abs(both.offset - 0.788) <= both.offset_pm))
    shares = np.mean(held, axis=0)
    assert np.all(shares >= 0.9)
    assert np.all(shares <= 0.99)


def test_the_brake_takes_in_more_than_the_load_cell_says(bench):
    """What no loss can explain: from 4 N m on, the braking motor's torque exceeds the load cell's in every row."""
    for name in bench.RATIOS:
        found = bench.torques(bench.read(name))
        found = found[found.command >= 4]
        assert np.all(found.braking > 1.1 * found.cell), name
        assert np.all(found.braking < found.driving), name


@pytest.mark.parametrize("friction", [0.05, 0.1, 0.3])
def test_meshes_of_the_compound_gearbox_follow_the_package_s_formula(bench, friction):
    """For planets of one size, both formulas give the same."""
    plain = float(bench.efficiency(bench.GEARS, friction))
    assert bench.planetary((25, 65), (65, 155), friction) == pytest.approx(plain, rel=1e-9)


def test_the_data_name_their_author_and_licence():
    head = (ROOT / "benchmarks" / "data" / "actuator_bench.csv").read_text(encoding="utf-8").split("actuator,")[0]
    assert "MIT License, Copyright (c) 2026 Aman Singh" in head
    licence = (ROOT / "benchmarks" / "data" / "COMPAct-LICENSE.txt").read_text(encoding="utf-8")
    assert "Copyright (c) 2026 Aman Singh" in licence
    assert "this permission notice shall be included" in licence


def test_the_example_of_the_page_is_that_of_the_data(bench):
    runs = bench.read("7.2:1")
    slow, *_, fast = runs[runs.command_n_m == 18]
    more, faster = fast.load_w - slow.load_w, fast.speed - slow.speed
    text = " ".join(PAGE.split())
    assert f"takes {-slow.load_w:.1f} W from its bus at 10 rpm and gives {fast.load_w:.1f} W back at 50 rpm" in text
    assert f"The {more:.1f} W between come through the shaft, at {faster:.2f} rad/s more" in text
    assert f"rad/s more: {more / faster:.1f} N m, where the load cell reads {runs.cell_n_m[-5:].mean():.1f}" in text


def test_what_the_page_tells_of_single_runs_is_in_the_data(bench):
    """What its tables show in part only: ``test_told_by_tables`` has the others."""
    found = {name: bench.torques(bench.read(name)) for name in bench.RATIOS}
    runs = np.concatenate([one.cell_n_m / one.command_n_m for one in map(bench.read, bench.RATIOS)])
    taken = np.concatenate([(one.braking / one.cell)[one.command >= 6] for one in found.values()])
    small, other = ((one.cell / one.command) for one in found.values())
    late = bench.read("7.2:1")
    late = late.cell_n_m[late.command_n_m == 14] / 14.0
    losses = found["7.2:1"].driving - found["7.2:1"].braking
    both = bench.pair(found["7.2:1"], bench.PROPORTIONAL)
    line = found["7.2:1"].driving[-1] * (1.0 - both.slope) + both.offset
    drag = bench.VISCOUS * 6.0**2 * 5.5 * 3000.0 * np.pi / 30.0 / 6.0  # 3000 rpm of the motor, 5.5 N m
    every = [bench.read(name) for name in bench.RATIOS]
    reported = [one.load_n_m[one.command_n_m == at] for one in every for at in range(3, 19)]
    moved = 100.0 * np.array([np.ptp(some) / np.mean(some) for some in reported])
    assert np.mean(moved < 1.0) > 0.5  # mostly
    frictions = [bench.brentq(lambda x, y=y: bench.own("7.2:1", x) ** 2 - both.slope - y, 0.0, 2.0) for y in (0, 0.01)]
    assert {(len(one), *np.unique(one.command_n_m)[[0, -1]]) for one in every} == {(90, 1, 18)}
    rpm = every[0].speed * 30.0 / np.pi
    said = [
        "90 steady runs each of a single-stage 7.2:1 actuator with an MN8014 and of a compound 14:1 one with an M6C12, "
        f"at commands of 1 to 18 N m and {between(rpm)} rpm",
        f"what the braking drive reports moves by {moved.max():.0f} percent at most, mostly by less than 1",
        f"by one percent, and the friction coefficient by {frictions[0] - frictions[1]:.2f}",
        f"load cell shows {between(100.0 * runs)} percent of the commanded torque",
        f"the braking motor takes in {between(taken, 1)} times what the load cell reads",
        f"jumps from {small[5]:.2f} to {small[6]:.2f} of the command",
        f"within the runs at 14 N m it falls from {late[0]:.2f} to {late[2]:.2f}",
        f"of the 14:1 one jumps from {other[10]:.2f} to {other[11]:.2f} at 12 N m",
        f"Up to 4 N m, the load cell reads {between(small[:4], 2)} of the command",
        f"up to {losses.max():.1f} instead of {line:.1f} N m",
        f"{drag:.1f} N m at that speed, {100.0 * drag / 33.0:.1f} percent",
    ]
    assert untold("docs/bench.md", said) == []


def test_the_figure_is_drawn(bench, tmp_path):
    figure = importlib.import_module("actuator_bench_figure")
    runs = bench.read("7.2:1")
    figure.draw(runs, bench.torques(runs), tmp_path / "bench.svg")
    drawn, shown = ((path / "bench.svg").read_text() for path in (tmp_path, ROOT / "docs" / "images"))
    assert drawn.count("<use") == shown.count("<use") > 500
