"""What a page says and a test asks for, or a script does: the file still has the words that say so."""

import pytest

from tests.docs.prose import untold
from tests.docs.scripts import ROOT

#: A page and the test or script that holds it -> what the page says, and the words for it, which the file has once.
TOLD = {
    ("docs/actuators.md", "tests/cli/test_motor_without_gearbox.py"): [
        ("The leg needs a motor of 65 mm or more", '[("64.9", False), ("65.1", True)]'),
    ],
    ("docs/bench.md", "benchmarks/actuator_bench.py"): [
        ("Up to 13 N m, two printed", "PROPORTIONAL = range(1, 14)"),
    ],
    ("docs/examples.md", "examples/constrained_study.py"): [("may weigh 4.5 kg at most", '{"max": 4.5}')],
    ("docs/examples.md", "tests/examples/test_examples.py"): [("under 40 lines", "splitlines()) < 40")],
    ("docs/python.md", "tests/examples/test_examples.py"): [("under 40 lines", "splitlines()) < 40")],
    ("docs/limit.md", "benchmarks/limit_collocation.py"): [("with a gate of 2 mm in place of", "length_m=0.002")],
    ("docs/limit.md", "benchmarks/limit_fronts.py"): [
        ("Both studies have 8,000 jumps", "default=8000"),
        ("With six knots per joint", "default=6"),
    ],
    ("docs/model.md", "benchmarks/jump_conditioning.py"): [("VT8020 and 200 random designs", "else 200)")],
    ("docs/model.md", "benchmarks/least_energy.py"): [("CMA-ES finds for 0.8 m", "TARGET_M, STEP_S = 0.8, ")],
    ("docs/model.md", "tools/fit_paper.py"): [
        ("links 1 and 2.5 % lighter and heavier", "(0.975, 0.99, 1.0, 1.01, 1.025)"),
    ],
    ("docs/scaling.md", "benchmarks/campaign_overhead.py"): [("with 2,000 jumps each", "default=2000")],
    ("docs/scaling.md", "benchmarks/cluster_overhead.py"): [
        ("60 designs with 256 jumps each", '"--designs", type=int, default=60')
    ],
    ("docs/studies.md", "benchmarks/server_storage.py"): [
        ("With 100 trials per generation", '"--size", type=int, default=100')
    ],
    ("docs/actuators.md", "tests/geometry/test_cut_teeth.py"): [
        ("the same depth as the package within 0.2 um", "approx(depth, abs=2e-4)"),
        ("of forty sets that do overlap", "param(interfering, 40, "),
    ],
    ("docs/actuators.md", "tests/actuator/rating/test_root_stress.py"): [
        ("0.88 to 1.00 times those of ISO 6336-3", "(SMALL, 0.884, "),
        ("0.88 to 1.00 times those of ISO 6336-3", "param(PLANET, 1.000, "),
    ],
    ("docs/actuators.md", "tests/actuator/test_tolerances.py"): [
        ("up to 2.4 times as wide", "for factor in (1.6, 2.4):"),
        ("is the chains' within 2 percent", "approx(put_together, abs=0.02)"),
    ],
    ("docs/actuators.md", "tests/actuator/rating/test_oracle.py"): [
        ("agrees on forty gear sets", 'parametrize("k", range(40))'),
        ("within 0.01 percent", "approx(expected[gear.gear, name], rel=1e-4)"),
    ],
    ("docs/actuators.md", "tests/actuator/test_bearings.py"): [
        ("ISO 281 and ISO 76 within 2 percent", "dynamic_rating_n == pytest.approx(rating, rel=0.02)"),
    ],
    ("docs/compare.md", "tests/jump/planar.py"): [("RK4, 50 us", "SUBSTEPS = 20\n")],
    ("docs/model.md", "tests/jump/planar.py"): [("Runge and Kutta's method with 50 us", "SUBSTEPS = 20\n")],
    ("docs/model.md", "tests/robot/test_tabulated.py"): [("equal to 12 digits", "exact.mass_kg, rtol=1e-12")],
    ("docs/compare.md", "tests/analysis/test_compare.py"): [
        (
            "narrower than ± 0.35 of the friction, ± 0.0075 of the torque constants, ± 0.25 ms of the delay and ± 0.05",
            "[0.7, 0.015, 0.5e-3, 0.1]",
        ),
        (
            "friction of 0.5 to 2 times, torque constants of 0.92 to 1.1 times, delays of 0 to 2.95 ms and stiffness "
            "of 0.7 to 1.3 times",
            "rng.uniform(0.5, 2.0), rng.uniform(0.92, 1.1), 50e-6 * rng.integers(0, 60), rng.uniform(0.7, 1.3)",
        ),
        (
            "Noise of 2 mm, 2 mrad and 0.3 A",
            '{"height": 2e-3, "hip": 2e-3, "knee": 2e-3, "hip_current": 0.3, "knee_current": 0.3}',
        ),
        ("at least 18 of the 20 logs", "param(20, 18, "),
    ],
    ("docs/landing.md", "tests/jump/test_landing.py"): [
        ("at most 5 and 6 cm", "ROBOTS.start_height_m, atol=0.05"),
        ("at most 5 and 6 cm", "foot_x, 0.0, atol=0.06"),
        ("slower than 0.01 m/s and 0.05 rad/s for 0.05 s", "approx(0.05, abs=2.1e-4)"),
        ("with 25 falls", "np.linspace(0.0, 2.6e-3, 25)"),
        ("changes by less than 1.2 percent", "< 0.012 * peaks.mean()"),
        ("engine agree to 1e-7", "values, judged, rtol=1e-7"),
        ("kept to 0.05 percent of the net work", "balance.error < 5e-4"),
        ("over four hops of Case C to 0.012 percent", "hops=4))\n    assert balance.error < 1.2e-4"),
    ],
    ("docs/landing.md", "tests/jump/test_independent_simulator.py"): [
        (
            "For 14 designs, peak loads agree within 1.2 percent at the usual step and within 0.3 percent at a quarter",
            "14, marks=pytest.mark.long) for how in ((2e-4, 0.012), (5e-5, 0.003)))",
        ),
        ("within twice that", "< 2.0 * share"),
    ],
    ("docs/limit.md", "tests/jump/test_laws.py"): [
        ("with MuJoCo and NumPy alone, to 1e-9", 'printed["height_m"] == pytest.approx(found.height_m[0], rel=1e-9)'),
    ],
    ("docs/model.md", "tests/jump/test_population.py"): [
        ("agrees to 1e-9 on 100 random designs", "approx(jump.clearance, rel=1e-9)"),
        ("agrees to 1e-9 on 100 random designs", "param(100, marks=pytest.mark.long)"),
    ],
    ("docs/model.md", "tests/jump/test_independent_simulator.py"): [
        ("both agree to 3 um of height and 3e-5 of either energy", "(3e-6, 3e-5)"),
        ("at 50 us it agrees to 3 um and 0.003 percent", "(3e-6, 3e-5)"),
        ("their peaks are within 1.5 percent", 'if "play" in which else 0.015'),
        ("to 0.6 mm, 0.2 percent of both energies, and 1.5 percent", "height_m=0.6e-3, share=2e-3"),
        ("to 0.1 mm and 0.003 percent of both energies", '{"stand": (1e-4, 3e-5)'),
    ],
    ("docs/model.md", "tests/jump/test_rotors.py"): [
        ("equals the sum over all parts to 1e-9", "energy == pytest.approx(expected, rel=1e-9)"),
        (
            "makes the same jump within 1 mm and 0.1 percent",
            "< 0.001\n        assert abs(energy / plain.energy_j[0] - 1.0) < 0.001",
        ),
    ],
    ("docs/model.md", "tests/jump/test_loads.py"): [
        ("constraint forces to 0.1 percent (`tests/jump/test_loads.py`)", "approx(value, rel=1e-3, "),
    ],
    ("docs/model.md", "tests/jump/test_gravity.py"): [
        ("one by one within 0.1 percent", "found, tried, rtol=1e-3"),
    ],
    ("docs/model.md", "tests/jump/test_end_stops.py"): [
        ("with 0.29, 0.31, 0.26 and 0.26 of the speed", "[0.285, 0.308, 0.255, 0.257], abs=0.02"),
        ("with 0.30 in the median", "approx(0.303, abs=0.02)"),
        ("from 0.21 to 0.37 (`tests/jump/test_end_stops.py`, within 0.03)", "approx((0.212, 0.375), abs=0.03)"),
        ("on 25 random designs", "(25, len(LOWER))"),
    ],
    ("docs/model.md", "tests/cad/write/test_exported_stand.py"): [
        ("to 0.1 percent of height, 0.15 percent of the energies and 2 percent of the loads", "approx(load, rel=0.02)"),
        ("to 0.05 percent of height and 0.15 percent", '0.0005 if drive == "rigid" else 0.001'),
        ("0.15 percent of the energies", "approx(energy_j, rel=0.0015)"),
    ],
    ("docs/model.md", "tests/jump/test_engines.py"): [
        ("to 5e-8 of their greatest value", "share=5e-8"),
    ],
    ("docs/model.md", "tests/jump/test_stand.py"): [
        ("constraint forces to 0.1 percent (`tests/jump/test_stand.py`)", "approx(value, rel=1e-3, "),
        ("an entry for the rails and closes to 0.1 percent", "assert balance.error < 0.001"),
    ],
    ("docs/model.md", "tests/jump/test_balance.py"): [
        ("to 0.1 % on 100 random ones", "UPPER, (100, len(LOWER))"),
        ("it is open by 0.2 % at most", "assert balance.error < 0.002"),
    ],
}


@pytest.mark.parametrize(("page", "test"), TOLD)
def test_what_a_page_says_of_a_test_is_what_the_test_asks_for(page, test):
    assert untold(page, [sentence for sentence, _ in TOLD[page, test]]) == []
    text = (ROOT / test).read_text(encoding="utf-8")
    assert [words for _, words in TOLD[page, test] if text.count(words) != 1] == []
