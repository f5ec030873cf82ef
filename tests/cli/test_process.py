"""The process of a command: its signals and its end."""

import errno
import os
import signal
import subprocess
import sys

import pytest

from pareto_monoped.cli.process import told
from tests.cli.support import ROOT, STORED

WAITS = """
import sys
from pareto_monoped import cli
from pareto_monoped.files import replacing
from pathlib import Path

def wait(arguments):
    with replacing(Path("out.txt")) as temporary:
        print("waiting", flush=True)
        sys.stdin.read()

cli.cli.main = lambda **_: wait(None)
sys.argv = ["pareto-monoped"]
cli.main()
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_any_command_without_a_trace(tmp_path, number):
    # Under nohup, or in the background of a script, the tests ignore some signals, and the command would inherit that.
    inherited = signal.signal(number, signal.SIG_DFL if number != signal.SIGINT else signal.default_int_handler)
    process = subprocess.Popen(
        [sys.executable, "-c", WAITS],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    signal.signal(number, inherited)
    assert process.stdout.readline() == "waiting\n"
    assert len(list(tmp_path.iterdir())) == 1
    process.send_signal(number)
    _, said = process.communicate(timeout=100)
    assert (process.returncode, said) == (130, "interrupted\n")
    assert list(tmp_path.iterdir()) == []


# A shell starts background jobs with SIGINT ignored, and what they start has it so.
_UNSHIELDED = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "from pareto_monoped.__main__ import main; main()"
)


@pytest.mark.parametrize("module", ["click", "difflib", "numpy"])
def test_an_interrupt_while_modules_are_imported_ends_in_one_line(tmp_path, module):
    """The module is one of ours that interrupts its own import, as Ctrl-C would at that moment."""
    (tmp_path / f"{module}.py").write_text(
        "import os, signal, time\nos.kill(os.getpid(), signal.SIGINT)\ntime.sleep(9)\n"
    )
    done = subprocess.run(
        [sys.executable, "-P", "-c", _UNSHIELDED, "status", str(STORED)],
        env=os.environ | {"PYTHONPATH": f"{tmp_path}{os.pathsep}{ROOT}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr.strip()) == (130, "", "interrupted")


LOST = """
import os, signal, time
from pareto_monoped import cli

class Slow:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(1)

def command(**_):
    Slow()
    time.sleep(1)

cli.cli.main = command
cli.main()
"""


def test_a_signal_in_a_destructor_is_not_lost():
    """Found by the fuzzer: Python printed a traceback, and the command went on."""
    done = subprocess.run(
        [sys.executable, "-c", LOST],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr.strip()) == (130, "interrupted")


ENDS = """
import atexit, sys
from pareto_monoped import cli

class Slow:
    def __del__(self):
        print("taken apart", flush=True)

slow = Slow()
atexit.register(print, "handler of before", flush=True)

def command(**_):
    atexit.register(print, "handler of during", flush=True)
    print("the last words", end="\\n")
    return 7

cli.cli.main = command
sys.argv = ["pareto-monoped"]
cli.main()
"""


def test_the_end_runs_handlers_and_takes_nothing_apart():
    done = subprocess.run(
        [sys.executable, "-c", ENDS],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 7
    assert done.stdout == "the last words\nhandler of during\n"
    assert done.stderr == ""


def test_words_given_leave_the_process_alone(capsys):
    """A test or another program that calls the command line keeps its signals, its warnings and its end."""
    from pareto_monoped import cli

    before = [signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGHUP)]
    with pytest.raises(SystemExit):
        cli.main(["--version"])
    assert [signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGHUP)] == before
    assert capsys.readouterr().out.startswith("pareto-monoped")


IMPORTS = """
from pareto_monoped import cli

def command(**_):
    import mujoco
    print(mujoco.MjModel.__name__)

cli.cli.main = command
cli.main()
"""


def test_a_drawing_library_that_does_not_exist_ends_no_command():
    """Found by the fuzzer: MuJoCo's import failed, although nothing is drawn with it."""
    done = subprocess.run(
        [sys.executable, "-c", IMPORTS],
        env=os.environ | {"PYTHONPATH": str(ROOT), "MUJOCO_GL": "nonsense"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "MjModel\n", "")


LATE = """
import os, signal
from pareto_monoped import cli
from pareto_monoped.cli import process

def report(error):
    os.kill(os.getpid(), signal.SIGTERM)
    return 2

def command(**_):
    raise ValueError

process.report = report
cli.cli.main = command
cli.main()
"""


def test_a_signal_while_the_end_is_told_leaves_no_traceback():
    """Found by the fuzzer."""
    line = [sys.executable, "-c", LATE]
    done = subprocess.run(line, env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "")


def test_an_error_of_the_system_names_both_files_that_it_is_about():
    error = OSError(errno.EXDEV, "Invalid cross-device link", "one.db", None, "two.db")
    line, code = told(error)
    assert "file 'one.db', 'two.db': cannot be used (Invalid cross-device link)" in line
    assert code == 2
