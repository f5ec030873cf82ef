"""The recipes stay true: commands and options exist, files can be parsed, versions agree with the package."""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import click
import pytest

import pareto_monoped as pm
from pareto_monoped.cli import cli
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.study.run import run

ROOT = Path(__file__).parents[2]
RECIPES = ROOT / "recipes"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
PROGRAMS = ("pareto-monoped", "dask scheduler", "dask worker")


def text_of(name):
    return (RECIPES / name).read_text(encoding="utf-8")


def resources():
    """What the manifest declares, by kind and name."""
    yaml = pytest.importorskip("yaml")
    return {(each["kind"], each["metadata"]["name"]): each for each in yaml.safe_load_all(text_of("kubernetes.yaml"))}


def pods():
    """What each kind of pod is made of, by the name of its only container."""
    templates = [each["spec"]["template"] for (kind, _), each in resources().items() if kind in ("Deployment", "Job")]
    return {template["spec"]["containers"][0]["name"]: template for template in templates}


def container(name):
    (found,) = pods()[name]["spec"]["containers"]
    return found


def calls():
    """Words of all calls of our command and of Dask's in the recipes and in their page."""
    lines = [shlex.join(container(name)["command"]) for name in ("scheduler", "worker")]
    lines += container("coordinator")["args"][0].splitlines()
    blocks = re.findall(r"^```sh\n(.*?)^```", (ROOT / "docs" / "scaling.md").read_text("utf-8"), re.S | re.M)
    for block in (*blocks, text_of("slurm.sbatch"), text_of("Containerfile")):
        lines += block.replace("\\\n", " ").splitlines()
    found = []
    for line in lines:
        for program in PROGRAMS:
            if match := re.search(rf"(?<![\w./:-]){program} (?=-|\"|[a-z])([^&|#`]*)", line):
                found.append((program, shlex.split(match[1])))
    return found


def test_every_command_and_option_exists():
    from distributed.cli import dask_scheduler, dask_worker

    context = click.Context(cli)
    programs = {"dask scheduler": dask_scheduler.main, "dask worker": dask_worker.main}
    seen = set()
    for program, words in calls():
        if program == "pareto-monoped":
            name = next((word for word in words if not word.startswith("-")), "")
            command = cli.get_command(context, name if name != "$@" else "robust")
            if command is None:
                continue  # the name of an image, or of a job
        else:
            command = programs[program]
        known = {option for each in command.params for option in (*each.opts, *each.secondary_opts)} | {"--help"}
        for word in words:
            if word.startswith("--"):
                assert word.split("=")[0] in known, f"{program} {shlex.join(words)}"
        seen.add(program if program != "pareto-monoped" else words[0])
    assert {"dask scheduler", "dask worker", "run", "resume", "robust", "$@"} <= seen


@pytest.mark.parametrize("name", ["ssh_hosts.py", "slurm_jobs.py"])
def test_the_options_that_a_program_shows_exist(name):
    pytest.importorskip("distributed" if name == "ssh_hosts.py" else "dask_jobqueue")
    done = subprocess.run(
        [sys.executable, RECIPES / name, "--help"], capture_output=True, text=True, check=True, cwd=ROOT
    )
    pages = text_of(name) + (ROOT / "docs" / "scaling.md").read_text("utf-8")
    (shown, *_) = lines = re.findall(rf"python (?:recipes/)?{name} (.*)", pages)
    assert len(lines) == 2, "the program itself and the page show a call"
    for line in lines:
        own = re.split(r" (?:robust|run|resume) ", line)[0]
        for option in re.findall(r"--[a-z-]+", own):
            assert option in done.stdout
    assert shown


def test_shell_scripts_can_be_read():
    subprocess.run(["bash", "-n", RECIPES / "slurm.sbatch"], check=True)
    (script,) = container("coordinator")["args"]
    subprocess.run(["sh", "-n"], input=script, text=True, check=True)


def test_the_page_names_every_recipe():
    page = (ROOT / "docs" / "scaling.md").read_text("utf-8")
    named = set(re.findall(r"recipes/([\w.]+\w)", page))
    assert named == {path.name for path in RECIPES.iterdir() if path.is_file()}


def test_the_image_has_the_version_and_the_user_of_the_pods():
    (user,) = re.findall(r"^USER (\d+)$", text_of("Containerfile"), re.M)
    assert re.search(rf"useradd --uid {user}\b", text_of("Containerfile"))
    for name, template in pods().items():
        spec = template["spec"]
        assert container(name)["image"] == f"pareto-monoped:{pm.__version__}"
        assert spec["securityContext"]["runAsUser"] == int(user)
        assert spec["securityContext"]["runAsNonRoot"] is True
        assert spec["automountServiceAccountToken"] is False
        assert container(name)["securityContext"]["readOnlyRootFilesystem"] is True
        assert container(name)["securityContext"]["allowPrivilegeEscalation"] is False
        assert {"cpu", "memory"} <= set(container(name)["resources"]["requests"])


def test_the_image_is_built_from_what_there_is():
    text = text_of("Containerfile")
    (python,) = re.findall(r"^ARG PYTHON=(.*)$", text, re.M)
    assert (ROOT / "constraints.txt").read_text("utf-8").startswith(f"# What was tested together, on Python {python}.")
    assert set(re.findall(r"^ARG EXTRAS=(.*)$", text, re.M)) == {"cluster"} <= set(PROJECT["optional-dependencies"])
    copied = [word for line in re.findall(r"^COPY (?!--from)(.*) \S+$", text, re.M) for word in line.split()]
    assert len(copied) == 7
    for word in copied:
        assert (ROOT / word).exists(), word


def test_services_probes_and_policies_meet_the_pods():
    found = resources()
    service = found["Service", "pareto-monoped-scheduler"]["spec"]
    labels = {name: template["metadata"]["labels"] for name, template in pods().items()}
    assert [name for name in labels if service["selector"].items() <= labels[name].items()] == ["scheduler"]
    ports = {port["name"]: port["containerPort"] for port in container("scheduler")["ports"]}
    (served,) = service["ports"]
    assert ports[served["targetPort"]] == served["port"] == 8786
    address = f"tcp://{found['Service', 'pareto-monoped-scheduler']['metadata']['name']}:{served['port']}"
    assert address in container("worker")["command"]
    assert {"name": "SCHEDULER", "value": address} in container("coordinator")["env"]
    for name in ("scheduler", "worker"):
        probed = container(name)["readinessProbe"]["httpGet"]["port"]
        ports = {port["name"]: port["containerPort"] for port in container(name)["ports"]}
        command = container(name)["command"]
        assert command[command.index("--dashboard-address") + 1] == f":{ports[probed]}"
    policy = found["NetworkPolicy", "pareto-monoped"]["spec"]
    for selector in (policy["podSelector"], policy["ingress"][0]["from"][0]["podSelector"]):
        assert all(selector["matchLabels"].items() <= each.items() for each in labels.values())


def test_the_manifest_has_the_published_schema():
    validate = pytest.importorskip("kubernetes_validate")
    for each in resources().values():
        validate.validate(each, "1.30", strict=True)


@pytest.mark.long
def test_the_job_of_slurm_runs_and_cleans_up(tmp_path):
    """With a program in place of srun that starts what it is given, on this machine."""
    pytest.importorskip("distributed")
    stand_in = tmp_path / "bin" / "srun"
    stand_in.parent.mkdir()
    stand_in.write_text('#!/bin/sh\nwhile [ "$1" != dask ]; do shift; done\nexec "$@"\n')
    stand_in.chmod(0o755)
    shutil.copy(RECIPES / "slurm.sbatch", tmp_path)
    study = {"name": "job", "evaluations": 20, "audit": False, "algorithm": {"name": "random"}}
    run(study_from_dict(study, source="test"), tmp_path / "s.db")
    path = os.pathsep.join((str(stand_in.parent), str(Path(sys.executable).parent), os.environ["PATH"]))
    environment = os.environ | {"PATH": path, "SLURM_NTASKS": "2", "SLURM_JOB_ID": "7", "PYTHONPATH": str(ROOT)}
    words = ["bash", "slurm.sbatch", "robust", "s.db"]
    done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=500)
    assert done.returncode == 0, done.stderr
    assert "mean" in done.stdout
    assert not list(tmp_path.glob("scheduler-*"))
    wrong = subprocess.run([*words[:-1], "none.db"], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert wrong.returncode != 0
    assert "none.db" in wrong.stderr
