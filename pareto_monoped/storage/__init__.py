"""Stored studies: trials, checkpoints and results in SQLite files or on a PostgreSQL server, and their integrity.

Order of imports, lowest first: address, columns, connection; base; lock, server; file; place; meta; seals; kept_front;
extra_rows, optuna_tables, reader; front_reader, status, store; optuna_check.
"""

__all__ = [
    "address",
    "base",
    "columns",
    "connection",
    "extra_rows",
    "front_reader",
    "kept_front",
    "lock",
    "meta",
    "optuna_check",
    "place",
    "reader",
    "seals",
    "status",
    "store",
]
