"""How an impact leaves an end stop, compiled by numba, which the rest of the end stops does not need."""

from pareto_monoped.compute.compiled import compiled


@compiled
def _deceleration(
    r: float, v: float, width: float, full: float, stiffness: float, damping: float, inertia: float
) -> float:
    u = min(max(r / width, 0.0), 1.0)
    share = u * (1.0 - full) / (1.0 - full * u)
    torque = share * (stiffness * u * r + damping * v)
    return max(0.0, torque) * (1.0 - full * u) / inertia  # the virtual inertia adds d / (1 - d)


@compiled
def rebound(speed: float, width: float, full: float, stiffness: float, damping: float, inertia: float) -> float:
    """Return the speed at which a free inertia leaves a stop that it met at ``speed``, by Runge and Kutta's method.

    All quantities are in SI units; ``full`` is the impedance at the full ``width``.
    """
    r, v = 0.0, speed
    h = 0.005 * width / speed
    while r >= 0.0:
        a1 = _deceleration(r, v, width, full, stiffness, damping, inertia)
        v2 = v - 0.5 * h * a1
        a2 = _deceleration(r + 0.5 * h * v, v2, width, full, stiffness, damping, inertia)
        v3 = v - 0.5 * h * a2
        a3 = _deceleration(r + 0.5 * h * v2, v3, width, full, stiffness, damping, inertia)
        v4 = v - h * a3
        a4 = _deceleration(r + h * v3, v4, width, full, stiffness, damping, inertia)
        r += h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0
        v -= h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0
    return -v
