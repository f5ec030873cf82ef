"""Libraries that take long to import and that few tests use."""

from importlib import import_module


class Lazily:
    """A module that is imported when a test first uses it: only one process of a test run waits for it."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, name: str) -> object:
        if name.startswith(("__", "_mock")):  # pytest asks everything in a file of tests what it is
            raise AttributeError(name)
        return getattr(import_module(self._name), name)
