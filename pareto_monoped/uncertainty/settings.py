"""What a study says of uncertainty: its own ranges, and how many samples each design has while it searches."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pareto_monoped.config import read_shipped
from pareto_monoped.errors import StudyError, complaint
from pareto_monoped.uncertainty.ranges import SHIPPED, WHAT, Uncertainty, uncertainty_of

DEFAULT_SEED = 1
"""Seed of the samples: the same for all designs and studies, so that their numbers can be compared."""
SEARCH_SAMPLES = 64
"""Samples of a design during a search. Our own choice: a 5th percentile then rests on the worst three or four, and
2,000 designs take about as long as 130,000 without uncertainty. ``robust`` judges the front by more."""
FEWEST, MOST = 16, 4096
"""Samples that a study may ask for: of fewer than 16 no 5th percentile can be told from the least value."""
OWN = "own"
"""Name of ranges that a study file changes without a name."""
MOST_FAILED = 0.05
"""Greatest share of failed jumps of a design that counts as robust. Our own choice, as that of the percentiles."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sampling:
    """The ranges of a study, and the samples that it searches with.

    Attributes:
        ranges: what is uncertain, and by how much.
        samples: jumps per design, besides the one without variation; a power of two.
        seed: of the samples, which all designs and all seeds of the search have in common.
    """

    ranges: Uncertainty
    samples: int = SEARCH_SAMPLES
    seed: int = DEFAULT_SEED

    def as_dict(self) -> dict[str, Any]:
        """As in a study file, with all ranges; ``sampling_of`` reads it back."""
        return {**self.ranges.as_dict(), "samples": self.samples, "seed": self.seed}


def sampling_of(table: Mapping[str, Any], *, source: str) -> Sampling:
    """The table ``[uncertainty]`` of a study; what it leaves out is as shipped.

    Raises:
        StudyError: an unknown key, a wrong range, or a number of samples that Sobol points cannot have.
    """
    given = dict(table)
    samples, seed = given.pop("samples", SEARCH_SAMPLES), given.pop("seed", DEFAULT_SEED)
    whole = isinstance(samples, int) and not isinstance(samples, bool)
    if not whole or not FEWEST <= samples <= MOST or samples & (samples - 1):
        allowed = f"a power of two from {FEWEST} to {MOST}"
        raise StudyError(f"{source}: {complaint('uncertainty.samples', samples, allowed, 'correct it')}")
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**63:
        allowed = "a whole number from 0 up"
        raise StudyError(f"{source}: {complaint('uncertainty.seed', seed, allowed, 'correct it')}")
    if given:
        given.setdefault("name", OWN)
    values, place = read_shipped(SHIPPED, what=WHAT) | given, f"{source}, table [uncertainty]"
    ranges = uncertainty_of(values, source=place, error=StudyError)
    return Sampling(ranges=ranges, samples=samples, seed=seed)
