"""Rating of a planetary stage after ISO 6336: flanks and roots of sun, planets and ring.

``geometry`` has what follows from the teeth alone, ``load`` the factors of load and its distribution, ``life`` load
cycles and S-N curves, ``flank`` and ``root`` the permissible loads, ``stage`` puts them together for one or many gear
sets, ``width`` finds the least face width, ``sheet`` rates one gear set in full. Symbols and clauses are those of
ISO 6336:2006; everything is in mm, N and MPa, as in the standard.
"""
