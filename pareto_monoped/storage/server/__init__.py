"""Studies on a PostgreSQL server: one schema (namespace) per study, with the same tables as in a file."""
