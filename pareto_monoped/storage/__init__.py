"""Stored studies: trials, checkpoints and results in SQLite files or on a PostgreSQL server, and their integrity."""
