"""Commands on machines that exist: ``replay``, a published leg on its rail, and ``compare``, a log of a real jump."""

import json
import math
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pareto_monoped.cli import options
from pareto_monoped.cli.terminal import echo, name, note, wrapped

if TYPE_CHECKING:
    from pareto_monoped.actuator.ratiomap import JointMaps
    from pareto_monoped.analysis.rail_legs import Predicted
    from pareto_monoped.design import Design
    from pareto_monoped.jump.calibration import Calibration
    from pareto_monoped.jump.rail_leg import RailLeg

_UNITS = {"push_s": "push, s", "take_off_m_per_s": "take-off, m/s", "apex_m": "apex of the hip, m"}


@click.command()
@click.argument("leg", type=options.Local(dir_okay=False), metavar="LEG.toml")
@click.option("--fit", metavar="TERM", help="Fit a loss: damping, friction, efficiency or rail.")
@click.option("--on", metavar="SERIES", help="Series whose take-off speed is fitted.")
@click.option("--samples", type=int, default=256, show_default=True, metavar="N", help="Of what is uncertain.")
@options.sample_seed_option
@options.uncertainty_option
@click.option("--json", "as_json", is_flag=True, help="Print everything as JSON.")
def replay(
    leg: Path, fit: str | None, on: str | None, samples: int, seed: int | None, uncertainty: Path | None, as_json: bool
) -> None:
    """Replay the pushes of a two-link leg on a rail.

    LEG.toml has bodies, drives and commands of a leg that was built, and what was measured, each with its source. Bands
    are from the 5th to the 95th percentile of legs as built.
    """
    from pareto_monoped.analysis.rail_legs import fitted_leg, predicted
    from pareto_monoped.jump.rail_leg import load_leg
    from pareto_monoped.uncertainty.settings import DEFAULT_SEED, Sampling, load_uncertainty

    if (fit is None) != (on is None):
        raise click.UsageError("--fit and --on go together; give both or none")
    described = load_leg(leg)
    ranges = load_uncertainty(uncertainty)
    sampling = Sampling(ranges=ranges, samples=samples, seed=DEFAULT_SEED if seed is None else seed)
    given = predicted(described, sampling)
    value, after = None, None
    if fit is not None and on is not None:
        lossy, value, term = fitted_leg(described, fit, on)
        after = predicted(lossy, sampling, term)
    if as_json:
        echo(json.dumps(_as_json(described, given, after, fit, on, value), indent=2))
        return
    _print(described, given, after)
    if value is not None:
        echo(f"fitted on series {name(on)}: {fit} {value:.3g}")
    kinds = Counter(text.partition(":")[0] for text in described.sources.values())
    echo("sources: " + ", ".join(f"{count} {kind}" for kind, count in kinds.items()))
    for key, text in described.sources.items():
        if text.startswith("inferred"):
            echo(wrapped(f"  {name(key)} {name(text)}", 4))


def _as_json(
    leg: "RailLeg",
    given: "list[Predicted]",
    after: "list[Predicted] | None",
    fit: str | None,
    on: str | None,
    value: float | None,
) -> dict[str, object]:
    """Return everything that ``replay`` knows; what does not lift off is null."""

    def clean(found: object) -> object:
        if isinstance(found, dict):
            return {key: clean(inner) for key, inner in found.items()}
        return None if isinstance(found, float) and not math.isfinite(found) else found

    def listed(series: "list[Predicted] | None") -> object:
        return None if series is None else [clean(asdict(one)) for one in series]

    measured = {one.name: None if one.measured is None else asdict(one.measured) for one in leg.series}
    found = {"leg": leg.name, "measured": measured, "as_given": listed(given), "fitted": listed(after)}
    return found | {"fit": fit, "on": on, "value": value, "sources": leg.sources}


def _print(leg: "RailLeg", given: "list[Predicted]", after: "list[Predicted] | None") -> None:
    """One row per series and quantity: measured with deviation, predicted as given and fitted, each with its band."""
    titles = f"{'measured':>15}{'as given':>22}" + ("" if after is None else f"{'fitted':>22}")
    for k, series in enumerate(leg.series):
        echo(f"{name(series.name):18}" + (titles if k == 0 else ""))
        for key, label in _UNITS.items():
            found = getattr(series.measured, key, None)
            measured = "-" if found is None else f"{found[0]:.3f} +- {found[1]:.3f}"
            cells = [one[k].bands[key] for one in (given, after) if one is not None]
            texts = [f"{band.nominal:.3f} ({band.p05:.3f}-{band.p95:.3f})" for band in cells]
            echo(f"  {label:18}{measured:>15}" + "".join(f"{text:>22}" for text in texts))
        for text, one in (("as given", given), ("fitted", after)):
            if one is not None and one[k].failed:
                echo(f"  {text}: {100.0 * one[k].failed:.0f} % of the samples do not lift off")


@click.command()
@click.argument("log", type=options.Local(dir_okay=False), metavar="FILE.csv")
@click.argument("design", metavar="DESIGN")
@click.option(
    "--calibration",
    metavar="NAME",
    shell_complete=options.calibrations,
    help="Name or TOML file.  [default: that of DESIGN, or reference]",
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def compare(log: Path, design: str, calibration: str | None, as_json: bool) -> None:
    """Compare the log of a real jump with the simulated one.

    FILE.csv has columns such as time_s, hip_rad, knee_rad, hip_current_a, knee_current_a and height_m. DESIGN is the
    design.json of an export, or a row of Table I. Friction, torque constant, delay and stiffness are fitted.
    """
    from pareto_monoped.analysis.compare import SI, read_log
    from pareto_monoped.analysis.compare import compare as compared

    told = read_log(log)
    found = compared(told, *_built(design, calibration))
    if as_json:
        echo(json.dumps(asdict(found), indent=2))
        return
    echo(f"{found.samples} samples of the push")
    echo(f"{'residual, rms':18}{'as designed':>14}{'fitted':>12}")
    for key, value in found.before.items():
        echo(f"  {f'{key}, {SI[key]}':16}{value:>14.4g}{found.after[key]:>12.4g}")
    echo(f"{'fitted':18}{'value':>14}   95 % interval, all together")
    for key, one in found.fitted.items():
        label, scale = (f"{key}, ms", 1e3) if key == "delay" else (f"{key}, factor", 1.0)
        echo(f"  {label:22}{scale * one.value:>8.3f}   {scale * one.lower:.3f} to {scale * one.upper:.3f}")


def _built(design: str, calibration: str | None) -> "tuple[Design, JointMaps, Calibration]":
    """Return the design of an export or of Table I with its gearboxes and calibration."""
    from pareto_monoped.actuator.ratiomap import joint_maps
    from pareto_monoped.actuator.search import map_for
    from pareto_monoped.cad.records import record_job
    from pareto_monoped.design import PAPER_CASES, PAPER_MOTOR
    from pareto_monoped.jump.calibration import load_calibration
    from pareto_monoped.jump.calibration_defaults import DEFAULT, rules_for

    if design in PAPER_CASES:
        chosen = calibration or DEFAULT
        maps = joint_maps(map_for(PAPER_MOTOR, rules_for(chosen)))
        return PAPER_CASES[design].design, maps, load_calibration(chosen)
    job = record_job(Path(design), folder=Path(), note=note)
    return job.design, job.maps(), job.calibration if calibration is None else load_calibration(calibration)
