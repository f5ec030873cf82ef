"""The study files that come with the package, to start from."""

from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

from pareto_monoped.errors import StudyError, unknown_name

START = "case_c"
"""The study that a newcomer begins with: all seven variables of the paper, its best design."""


def shipped_studies() -> dict[str, Traversable]:
    """Name -> file of each study that comes with the package, in alphabetical order.

    An installed package has them among its data, a checkout in ``studies`` beside it.
    """
    folder = resources.files("pareto_monoped") / "data" / "studies"
    if not folder.is_dir():
        folder = Path(__file__).parents[2] / "studies"
    return {file.name.removesuffix(".toml"): file for file in _files(folder)}


def _files(folder: Traversable) -> list[Traversable]:
    found = [file for file in folder.iterdir() if file.name.endswith(".toml")] if folder.is_dir() else []
    return sorted(found, key=lambda file: file.name)


def shipped_study(name: str) -> str:
    """The text of a shipped study.

    Raises:
        StudyError: there is none of this name.
    """
    known = shipped_studies()
    if name not in known:
        raise StudyError(unknown_name("study", name, known))
    return known[name].read_text(encoding="utf-8")
