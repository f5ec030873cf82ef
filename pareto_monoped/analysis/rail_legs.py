"""A published leg predicted: its replayed pushes as described and as built, before and after a fit of one loss term."""

from dataclasses import dataclass, replace

import numpy as np

from pareto_monoped.errors import InputError, SimulationError, unknown_name
from pareto_monoped.jump.rail_leg import MEASURED, RailLeg, Series
from pareto_monoped.jump.replay import TERMS, Term, calibration_of_leg, fitted, replay, with_term
from pareto_monoped.jump.variations import Variations
from pareto_monoped.uncertainty.samples import sobol_samples, variations
from pareto_monoped.uncertainty.settings import Sampling
from pareto_monoped.uncertainty.statistics import spread


@dataclass(frozen=True, slots=True, kw_only=True)
class Band:
    """One quantity of a push; NaN where it does not lift off."""

    nominal: float  #: of the leg as described
    #: p05, p95: percentiles of those samples that lift off
    p05: float
    p95: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Predicted:
    """One series of a leg."""

    name: str
    bands: dict[str, Band]  #: by the names of ``rail_leg.MEASURED``
    failed: float  #: share of the samples that do not lift off


def predicted(leg: RailLeg, sampling: Sampling, fit: Term | None = None) -> list[Predicted]:
    """Return all series of a leg under uncertainty; a term that was ``fit`` is known and does not vary."""
    calibration = calibration_of_leg(leg)
    drawn = sobol_samples(sampling.ranges.where(stand=True), sampling.samples, sampling.seed)
    built = _known(variations(drawn, 1, calibration), fit)
    return [_series(leg, one, built) for one in leg.series]


def _known(built: Variations, fit: Term | None) -> Variations:
    ones = np.ones(len(built))
    factors = {"damping": "damping", "friction": "friction", "efficiency": "gear_loss", "rail": "rail_friction"}
    return built if fit is None else replace(built, **{factors[fit]: ones})


def _series(leg: RailLeg, series: Series, built: Variations) -> Predicted:
    nominal, samples = replay(leg, series), replay(leg, series, built)
    flown = np.isfinite(samples["push_s"])
    bands = {}
    for name in MEASURED:
        found = spread(samples[name][flown])
        low, high = (float("nan"),) * 2 if found is None else (found.p05, found.p95)
        bands[name] = Band(nominal=float(nominal[name][0]), p05=low, p95=high)
    return Predicted(name=series.name, bands=bands, failed=float(1.0 - flown.mean()))


def fitted_leg(leg: RailLeg, fit: str, on: str) -> tuple[RailLeg, float, Term]:
    """Return the leg with which one series takes off as fast as measured, the value of the loss term, and the term.

    Raises:
        InputError: no such term or series, or a series without measured hops.
        SimulationError: no value fits.
    """
    term = next((one for one in TERMS if one == fit), None)
    if term is None:
        raise InputError(unknown_name("fit", fit, tuple(TERMS)))
    named = {one.name: one for one in leg.series}
    if on not in named:
        raise InputError(unknown_name("on", on, tuple(named)))
    if named[on].measured is None:
        raise InputError(f"on = {on!r}: this series has no measured hops to fit to; choose another")
    value = fitted(leg, named[on], term)
    found = with_term(leg, term, value)
    if not np.isfinite(replay(found, named[on])["take_off_m_per_s"][0]):
        raise SimulationError(f"fit of {term}: no value fits series {on!r}; choose another loss term")
    return found, value, term
