"""One module per file format, and the folder that they are written to."""

__all__ = ["folder"]
