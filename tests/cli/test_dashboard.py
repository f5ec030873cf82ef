"""The command ``dashboard`` with the real optuna-dashboard, where it is installed."""

import hashlib
import json
import os
import re
import signal
import socket
import subprocess
import sys
import urllib.error
import urllib.request
from importlib.util import find_spec
from pathlib import Path

import pytest
from click.testing import CliRunner

from pareto_monoped.cli import cli, stored
from pareto_monoped.cli.stored import _reading, _server
from pareto_monoped.errors import InputError

ROOT = Path(__file__).parents[2]
STORED = ROOT / "tests" / "storage" / "data" / "plain.db"
INSTALLED = find_spec("optuna_dashboard") is not None


@pytest.mark.skipif(INSTALLED, reason="optuna-dashboard is installed")
def test_without_the_package_one_line_says_what_to_install():
    result = CliRunner().invoke(cli, ["dashboard", str(STORED)])
    assert isinstance(result.exception, InputError)
    assert str(result.exception).startswith("dashboard: needs optuna-dashboard")
    assert "pip install 'pareto-monoped[dashboard]'" in str(result.exception)


def test_only_requests_that_read_reach_the_application():
    seen, answers = [], []
    application = _reading(lambda environment, start: seen.append(environment["REQUEST_METHOD"]) or [b"all"])
    bodies = {
        method: application({"REQUEST_METHOD": method}, lambda status, _: answers.append(status))
        for method in ("GET", "HEAD", "POST", "PUT", "DELETE", "PATCH")
    }
    assert seen == ["GET", "HEAD"]
    assert answers == ["403 Forbidden"] * 4
    assert json.loads(bodies["DELETE"][0])["reason"] == "the study is open for reading only"


def test_it_listens_on_the_loopback_only_and_finds_a_free_port():
    with _server(None, None) as first, _server(None, None) as second:
        assert first.server_address[0] == second.server_address[0] == "127.0.0.1"
        assert first.server_port != second.server_port
        with pytest.raises(InputError, match=f"--port = {first.server_port}: cannot be listened at"):
            _server(None, first.server_port)


@pytest.mark.skipif(not INSTALLED, reason="optuna-dashboard is not installed; pip install 'pareto-monoped[dashboard]'")
def test_the_real_dashboard_shows_a_study_changes_nothing_and_ends_with_an_interrupt(tmp_path):
    db = tmp_path / "a study #1?.db"
    db.write_bytes(STORED.read_bytes())
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    line = [sys.executable, "-m", "pareto_monoped", "dashboard", str(db), "--port", str(port)]
    process = subprocess.Popen(
        line,
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])},
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        said = process.stderr.readline()
        address = re.search(r"http://127\.0\.0\.1:\d+/", said)[0]
        assert address == f"http://127.0.0.1:{port}/"
        studies = json.load(urllib.request.urlopen(f"{address}api/studies"))["study_summaries"]
        assert [study["study_name"] for study in studies] == ["plain"]
        detail = json.load(urllib.request.urlopen(f"{address}api/studies/{studies[0]['study_id']}"))
        assert len(detail["trials"]) > 20
        request = urllib.request.Request(f"{address}api/studies/{studies[0]['study_id']}", method="DELETE")
        with pytest.raises(urllib.error.HTTPError, match="403"):
            urllib.request.urlopen(request)
    finally:
        process.send_signal(signal.SIGINT)
        _, rest = process.communicate(timeout=60)
    assert process.returncode == 0
    assert rest == "ended\n"
    assert hashlib.sha256(db.read_bytes()).digest() == hashlib.sha256(STORED.read_bytes()).digest()
    assert [path.name for path in tmp_path.iterdir()] == [db.name]


@pytest.mark.parametrize("browse", [False, True])
def test_the_browser_opens_where_it_listens_only_if_asked(monkeypatch, browse):
    opened = []
    monkeypatch.setattr(stored, "require_extra", lambda *names: None)
    monkeypatch.setattr(stored, "_application", lambda db: None)
    monkeypatch.setattr(stored.webbrowser, "open", opened.append)
    monkeypatch.setattr("socketserver.BaseServer.serve_forever", lambda server, poll_interval: None)
    result = CliRunner().invoke(cli, ["dashboard", str(STORED), *(["--open"] if browse else [])])
    assert result.exit_code == 0, result.output
    assert opened == ([re.search(r"http://127\.0\.0\.1:\d+/", result.stderr)[0]] if browse else [])
