"""Everything else stands in pyproject.toml; this adds the study files, which live beside the package, to the wheel."""

import shutil
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

STUDIES = Path(__file__).parent / "studies"


class WithStudies(build_py):
    """Copies ``studies/*.toml`` to ``pareto_monoped/data/studies``, where ``study.shipped`` looks for them."""

    def run(self) -> None:
        """Build as usual, then copy; an editable installation reads the files where they are."""
        super().run()
        if self.editable_mode:
            return
        folder = Path(self.build_lib) / "pareto_monoped" / "data" / "studies"
        folder.mkdir(parents=True, exist_ok=True)
        for path in sorted(STUDIES.glob("*.toml")):
            shutil.copy(path, folder)


setup(cmdclass={"build_py": WithStudies})
