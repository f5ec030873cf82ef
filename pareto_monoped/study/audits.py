"""Audits of the front: is each of its points a property of the design, or an accident of the simulation?"""

from pathlib import Path

from pareto_monoped.study.physics import Physics
from pareto_monoped.study.store import Store


def audit_front(db: Path, store: Store, physics: Physics) -> None:
    """Audit what is on the front and has no audit yet."""
