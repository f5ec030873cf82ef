"""What a check found, compared with its limit."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from pareto_monoped.cad.check.limits import Limit


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One measured value, and what to say if it is beyond the limit."""

    value: float
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One check of an export.

    Attributes:
        name: what must hold.
        looked_at: what was examined.
        measured: the worst value found.
        limit: what is allowed; at most, or at least if ``at_least``.
        unit: of both.
        failures: a sentence per failure.
        at_least: whether the limit is a lower one.
    """

    name: str
    looked_at: str
    measured: float
    limit: float
    unit: str
    failures: tuple[str, ...]
    at_least: bool = False

    @property
    def passed(self) -> bool:
        """Whether nothing failed."""
        return not self.failures

    @property
    def worst(self) -> str:
        """The worst value beside its limit, in words."""
        bound = "at least" if self.at_least else "at most"
        return f"{_number(self.measured)} {self.unit} (allowed: {bound} {self.limit:g})"


def worst_of(limit: Limit, looked_at: str, findings: Iterable[Finding]) -> Check:
    """A check of measured values: fails for each one that is beyond the limit.

    Without findings the measured value is the limit's own for a lower limit, else 0.
    """
    found = sorted(findings, key=lambda finding: finding.value, reverse=not limit.at_least)
    nothing = limit.value if limit.at_least else 0.0
    return Check(
        name=limit.name,
        looked_at=looked_at,
        measured=float(found[0].value) if found else nothing,
        limit=limit.value,
        unit=limit.unit,
        failures=tuple(finding.text for finding in found if not limit.allows(finding.value)),
        at_least=limit.at_least,
    )


def count_of(limit: Limit, looked_at: str, failures: Sequence[str]) -> Check:
    """A check of things that are right or wrong: the measured value is the number of the wrong ones."""
    return Check(
        name=limit.name,
        looked_at=looked_at,
        measured=float(len(failures)),
        limit=limit.value,
        unit=limit.unit,
        failures=tuple(failures),
    )


def _number(value: float) -> str:
    return f"{value:.0f}" if value == round(value) else f"{value:.3f}"
