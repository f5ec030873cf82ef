"""Every part's solid passes the CAD kernel's own check of topology and geometry."""

from pareto_monoped.cad.check.limits import VALID
from pareto_monoped.cad.check.result import Check, count_of
from pareto_monoped.cad.product import Product


def check(product: Product) -> Check:
    """Look at the solid of every unique part."""
    bad = [
        f"{kind.name}: its solid is not valid"
        for kind, solid in zip(product.unique, product.solids.result(), strict=True)
        if not solid.valid
    ]
    return count_of(VALID, f"{len(product.unique)} parts", bad)
