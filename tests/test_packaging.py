"""What is shipped: the README on a package index, the strict types, and both distributions."""

import importlib.util
import re
import subprocess
import sys
import sysconfig
import tomllib
import venv
import zipfile
from importlib.metadata import distributions
from pathlib import Path

import pytest
from packaging.specifiers import SpecifierSet

import pareto_monoped as pm

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
SOURCE = "https://example.org/someone/pareto_monoped"


@pytest.fixture(scope="module")
def packaging():
    """What ``setup.py`` defines."""
    spec = importlib.util.spec_from_file_location("of_setuptools", ROOT / "setup.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


TARGET = re.compile(r'!?\[[^\]]+\]\(([^)#]+)|<img src="([^"]+)')


def targets(text):
    """Where links and pictures lead, without anchors within the page."""
    return [one or other for one, other in TARGET.findall(text)]


def test_what_is_installed_runs_on_every_python_that_the_readme_names():
    """A pinned package wanted 3.11.5, and the set-up failed on Debian 12, whose Python is 3.11.2."""
    least = PROJECT["project"]["requires-python"].removeprefix(">=") + ".0"
    # Not by its key: that raises for a package that names no Python once any package has imported
    # `importlib_metadata`, which then reads for the standard library as well.
    wanted = {one.name: one.metadata.get("Requires-Python") for one in distributions()}
    assert {name: of for name, of in wanted.items() if of and least not in SpecifierSet(of)} == {}


def test_with_an_address_all_links_and_pictures_of_the_readme_lead_to_files_there(packaging):
    shown = targets(packaging.for_an_index(README, SOURCE + "/", "1.2.3"))
    assert len(shown) == len(targets(README)) > 10
    for target, there in zip(shown, targets(README), strict=True):
        if there.startswith("http"):
            assert target == there
            continue
        kind = "raw" if Path(there).suffix in (".png", ".svg", ".gif") else "blob"
        assert target == f"{SOURCE}/{kind}/v1.2.3/{there}"
        assert (ROOT / there).exists()


def test_without_an_address_nothing_of_the_readme_is_broken(packaging):
    shown = packaging.for_an_index(README, None, "1.2.3")
    assert [target for target in targets(shown) if not target.startswith("http")] == []
    assert "pictures are in the source distribution" in shown
    # Nothing else is changed: the words and commands are all there.
    assert shown.count("$ pareto-monoped") == README.count("$ pareto-monoped")
    assert packaging.for_an_index("# a\n\ntext\n", None, "1") == "# a\n\ntext\n"


def test_the_address_has_one_place(packaging, monkeypatch, tmp_path):
    """Written into [project.urls], it is all that a release needs."""
    for name in ("README.md", "pyproject.toml", "pareto_monoped/__init__.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        text = (ROOT / name).read_text(encoding="utf-8")
        if name == "pyproject.toml":
            text += f'\n[project.urls]\nSource = "{SOURCE}"\n'
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.setattr(packaging, "ROOT", tmp_path)
    assert "urls" not in PROJECT["project"]
    assert f"]({SOURCE}/raw/v{pm.__version__}/docs/front.svg)" in packaging.long_description()


def test_types_are_strict_and_every_exception_has_its_reason():
    settings = PROJECT["tool"]["mypy"]
    assert settings["strict"] is True
    loosening = {"strict", "python_version", "files", "overrides", "untyped_calls_exclude"}
    assert set(settings) == loosening
    assert {"pareto_monoped", "benchmarks", "tools"} <= set(settings["files"])
    for folder in settings["files"]:
        for path in (ROOT / folder).rglob("*.py"):
            for line in path.read_text(encoding="utf-8").splitlines():
                if "type: ignore" in line:
                    assert re.search(r"# type: ignore\[[a-z, -]+\]  # \w+", line), f"{path}: {line}"


def test_the_version_and_the_changelog_agree():
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    released = re.findall(r"^## (\S+)(?: \((unreleased|\d{4}-\d{2}-\d{2})\))?$", text, re.M)
    assert released[0][0] == pm.__version__
    assert [day == "unreleased" for _, day in released[1:]] == [False] * (len(released) - 1)
    for section in re.split(r"^## ", text, flags=re.M)[1:-1]:  # the first version changed nothing
        assert re.findall(r"^### (\w+)$", section, re.M) == ["Added", "Changed", "Fixed"]


def tracked():
    """The files of the repository; the test is skipped where there is none, as in a source distribution."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=False)
    if listed.returncode or not (ROOT / ".git").exists():
        pytest.skip("no repository")
    return listed.stdout.strip("\0").split("\0")


def test_the_source_distribution_has_every_file_but_those_of_the_code_host(tmp_path):
    """Tests and documents are made from it; SECURITY.md, which the site shows, was left out once."""
    from setuptools._distutils.filelist import FileList

    names = tracked()
    for name in names:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    chosen = FileList()
    chosen.findall(str(tmp_path))
    chosen.allfiles = [str(Path(name).relative_to(tmp_path)) for name in chosen.allfiles]
    for line in (ROOT / "MANIFEST.in").read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            chosen.process_template_line(line)
    # setuptools itself adds these, and the package with its data.
    given = {"README.md", "LICENSE", "MANIFEST.in", "pyproject.toml", "setup.py"}
    left = [
        name for name in names if name not in {*chosen.files, *given} and not name.startswith((".", "pareto_monoped/"))
    ]
    assert left == []


def test_prose_has_at_most_120_characters_per_line():
    """Tables, formulas, code, and lines that one picture or link fills are as long as they must be."""
    long = []
    for name in tracked():
        if not name.endswith(".md") or name.startswith("tests/"):
            continue
        text = (ROOT / name).read_text(encoding="utf-8")
        text = re.sub(
            r"^( *)```.*?^\1```|^\$\$.*?^\$\$", lambda found: "\n" * found[0].count("\n"), text, flags=re.S | re.M
        )
        for number, line in enumerate(text.splitlines(), 1):
            if len(line) > 120 and not line.lstrip().startswith(("|", "!", "<")) and " " in line.strip():
                long.append(f"{name}:{number}")
    assert long == []


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The wheel, built from the checkout's files alone."""
    folder = tmp_path_factory.mktemp("wheel")
    names = ["README.md", "LICENSE", "pyproject.toml", "setup.py", "MANIFEST.in", "pareto_monoped", "studies"]
    source = folder / "Quelle mit Blank und Ümlaut"
    source.mkdir()
    for name in names:
        subprocess.run(["cp", "-r", str(ROOT / name), str(source)], check=True)
    subprocess.run(
        [
            sys.executable,
            "-m",
            "pip",
            "wheel",
            "--no-deps",
            "-q",
            "-w",
            str(folder),
            str(source),
        ],
        check=True,
    )
    (found,) = folder.glob("*.whl")
    return found


REVEALED = {
    "pm.simulate": "pandas: Any",
    "pm.run": "pareto_monoped.api.studies.StoredStudy",
    "pm.resume": "pareto_monoped.api.studies.StoredStudy",
    "pm.load_study": "pareto_monoped.api.studies.StoredStudy",
    "pm.Study.define": "pareto_monoped.definition.study.Study",
    "pm.load_motor": "pareto_monoped.actuator.motor.Motor",
    "pm.actuator_map": "pareto_monoped.actuator.ratiomap.ActuatorMap",
    "pm.load_calibration": "pareto_monoped.jump.calibration.Calibration",
    "pm.build_robot": "pareto_monoped.robot.build.Robot",
    "pm.StoredStudy.pick": "pareto_monoped.api.studies.Picked",
}
"""Public name -> what it gives. Data frames are Any as long as pandas has no types of its own."""


@pytest.mark.long
def test_the_wheel_is_typed_for_its_users(wheel, tmp_path):
    """A script under mypy --strict, against the installed wheel: every name is known, and a wrong type is found."""
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        assert "pareto_monoped/py.typed" in names
        assert "pareto_monoped/data/studies/quick.toml" in names
        venv.create(tmp_path / "venv")
        (site,) = (tmp_path / "venv").glob("lib/python*/site-packages")
        archive.extractall(site)
    (site / "others.pth").write_text(sysconfig.get_path("purelib") + "\n")
    script = tmp_path / "script.py"
    lines = ["import pareto_monoped as pm", *(f"reveal_type({name})" for name in REVEALED)]
    lines += [f"reveal_type(pm.{name})" for name in pm.__all__]
    lines += ["pm.load_motor(80)", "pm.simulat"]
    script.write_text("\n".join(lines) + "\n")
    run = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--python-executable", str(tmp_path / "venv" / "bin" / "python"),
         "--cache-dir", str(tmp_path / "cache"), str(script)],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    said = [line.split(": ", 1)[1] for line in run.stdout.splitlines() if line.startswith("script.py:")]
    notes = [line for line in said if line.startswith("note: Revealed")]
    assert len(notes) == len(REVEALED) + len(pm.__all__), run.stdout
    for (name, gives), note in zip(REVEALED.items(), notes, strict=False):
        assert note.split("->")[-1].strip(' "').endswith(gives.removeprefix("pandas: ")), f"{name}: {note}"
    for name, note in zip(pm.__all__, notes[len(REVEALED) :], strict=True):
        assert note != 'note: Revealed type is "Any"', name
    errors = [line for line in said if line.startswith("error")]
    assert len(errors) == 2, run.stdout
    assert "arg-type" in errors[0]
    assert "attr-defined" in errors[1]


@pytest.mark.long
def test_the_readme_of_the_wheel_is_for_an_index(wheel):
    with zipfile.ZipFile(wheel) as archive:
        (name,) = [name for name in archive.namelist() if name.endswith(".dist-info/METADATA")]
        text = archive.read(name).decode()
    assert "Description-Content-Type: text/markdown" in text
    assert [target for target in targets(text) if not target.startswith("http")] == []
