"""Rating of a planetary stage after ISO 6336: flanks and roots of sun, planets and ring.

``geometry`` has what follows from the teeth alone, ``load`` the factors of load and its distribution, ``capacity`` load
cycles, S-N curves and permissible loads. ``build`` and ``stage`` put them together for one or many gear sets, ``width``
finds the least face width, ``sheet`` rates gear sets in full, ``strike`` those whose stop is struck in every jump.
Symbols and clauses are those of ISO 6336:2006; everything is in mm, N and MPa, as in the standard.
"""

__all__ = ["sheet"]
