"""Small studies that tests of signatures read, made once per test run, and the files that their commands need."""

import shutil
from dataclasses import fields
from pathlib import Path

from pareto_monoped.campaign.grid import load_campaign
from pareto_monoped.definition.study import load_study
from pareto_monoped.storage.extra_rows import Limit, Perturbed, Reached
from pareto_monoped.study.run import run

SIGNED = """
name = "signed"
case = "C"
evaluations = 160
seed = 5
strength = false
algorithm = { name = "random" }
constraints = { mass_kg = { max = 7.0 } }
variables = { knee_release_rad = { lower = 0.0, upper = 0.4 }, start_height_m = { lower = 0.4, upper = 0.6 } }
"""
"""A random search asks for the same trials on every machine, whatever the last digits of its jumps are."""
OTHER = """
name = "other"
case = "C"
motor = ["U8", "MN8014", "VT8020"]
calibration = "printed"
objectives = ["height_m", "electrical_energy_j", "mass_kg"]
evaluations = 90
seed = 8
algorithm = { name = "random" }
constraints = { mass_kg = { min = 3.5, max = 8.0 }, drift_m = { max = 0.3 }, peak_foot_force_n = { max = 900.0 } }
reference_point = { height_m = 0.5, electrical_energy_j = 400.0, mass_kg = 9.0 }

[variables]
thigh_length_m = 0.4
stiffness_n_per_m = { lower = 0.0, upper = 60.0 }
rest_length_m = { lower = 0.5, upper = 3.0 }

[uncertainty]
samples = 32
masses = { lower = -0.03, upper = 0.02, source = "weighed" }
"""
"""Three objectives, one of three motors for both joints, limits to both sides, and trials that fail."""
PAIR = """
name = "pair"
case = "B"
hip_motor = ["U8", "VT8020"]
knee_motor = "MN8014"
calibration = "stand"
evaluations = 40
seed = 2
algorithm = { name = "random" }
objectives = ["energy_j", "height_m"]
constraints = { height_m = { min = 2.5 } }
"""
"""Motors of their own for either joint, and no design that reaches the least height."""
STUDIES = {"signed": SIGNED, "other": OTHER, "pair": PAIR}
FILES = {
    "mine.toml": 'name = "mine"\nmasses = { lower = -0.02, upper = 0.03, source = "weighed" }\n',
    "grid.toml": 'name = "grid"\nstudy = "small.toml"\n[axes]\nmotors = ["VT8020", "U8"]\nseeds = [1, 2]\n',
    "small.toml": SIGNED.replace("160", "12").replace('"signed"', '"small"'),
    "notes.csv": "mine",
    "notes.html": "mine",
}
"""Ranges, a campaign of four studies, and files that nothing but --force replaces."""


def go_to_studies(made_once, folder, patch):
    """Copy the studies, as files and as databases, and the other files to a folder, and go there.

    As ``few_samples`` does for a module, 32 robots as built jump where commands would take 256.
    """
    shutil.copytree(made_once("signed_studies", _made), folder, dirs_exist_ok=True)
    patch.chdir(folder)
    patch.setenv("COLUMNS", "80")
    for name in ("LEAST_SAMPLES", "DEFAULT_SAMPLES"):
        patch.setattr(f"pareto_monoped.analysis.robustness.{name}", 32)


def _made(folder):
    for name, text in (STUDIES | FILES).items():
        (folder / name).with_suffix(Path(name).suffix or ".toml").write_text(text)
    for name in STUDIES:
        run(load_study(folder / f"{name}.toml"), folder / f"{name}.db", workers=1)
    (folder / "studies").mkdir()
    for one in load_campaign(folder / "grid.toml").members:
        run(one.study, folder / "studies" / f"{one.name}.db", workers=1)
    return folder


def numbered_limit():
    """A limit of a design whose numbers all differ, and what makes other records of numbers that differ from them."""
    numbers = iter(0.0137 * k for k in range(1, 100))

    def numbered(kind, *names, **known):
        return kind(**{name: next(numbers) for name in names or [f.name for f in fields(kind)]}, **known)

    def reached():
        known = {"design": {}, "controller": {}, "perturbed": numbered(Perturbed)}
        return numbered(Reached, "height_m", "energy_j", "half_step_height_m", "half_step_energy", **known)

    jumps = {name: reached() for name in ("least", "greatest", "least_held", "greatest_held", "over_time", "tracking")}
    known = {"trial": 5, "energy": "energy_j", "jumps": 60, "perturbed": numbered(Perturbed)}
    gaps = ("height_m", "energy_j", "floor_j", "controller_gap", "controller_gap_held")
    found = numbered(Limit, *gaps, **jumps, **known)
    return found, numbered
