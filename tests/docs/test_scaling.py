"""The commands that docs/scaling.md shows for one machine start a scheduler and workers, and a study runs on them."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.compute.dask_here import free_port

ROOT = Path(__file__).parents[2]


@pytest.mark.long
def test_scheduler_and_workers_on_one_machine(tmp_path):
    pytest.importorskip("distributed")
    text = (ROOT / "docs" / "scaling.md").read_text(encoding="utf-8")
    section = text.split("## A scheduler and workers on one machine")[1].split("\n## ")[0]
    (block,) = re.findall(r"^```sh\n(.*?)^```", section, re.S | re.M)
    port = str(free_port())
    scheduler, workers, study = block.replace("8786", port).strip().splitlines()
    shutil.copytree(ROOT / "studies", tmp_path / "studies", ignore=shutil.ignore_patterns("*.db*"))
    environment = os.environ | {"PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    started = []
    try:
        for command in (f"{scheduler} --port {port} --no-dashboard", f"{workers} --no-dashboard"):
            with (tmp_path / "log").open("a") as log:
                started.append(
                    subprocess.Popen(shlex.split(command), cwd=tmp_path, env=environment, stdout=log, stderr=log)
                )
        done = subprocess.run(
            shlex.split(study), cwd=tmp_path, env=environment, capture_output=True, text=True, check=False, timeout=500
        )
    finally:
        for process in reversed(started):
            process.terminate()
            process.wait()
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("front: ")
    assert "300 evaluations" in done.stderr
    assert "Traceback" not in done.stderr
