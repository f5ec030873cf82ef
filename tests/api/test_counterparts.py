"""Every option of the command line has its counterpart in Python, or a reason why it has none."""

import inspect

import click
import pytest

import pareto_monoped as pm
from pareto_monoped.cli import _COMMANDS, cli

PICK, FRONT = pm.StoredStudy.pick, pm.StoredStudy.front
DOORS = {
    "actuators": [pm.actuator_map, pm.plot_actuators],
    "simulate": [pm.simulate, pm.trace, pm.film, pm.Design.replace],
    "table1": [pm.table1],
    "run": [pm.run],
    "resume": [pm.resume],
    "status": [pm.status],
    "campaign": [pm.run_campaign],
    "verify": [pm.verify],
    "trials": [pm.load_study],
    "front": [FRONT],
    "pick": [PICK, pm.StoredStudy.alternatives],
    "robust": [pm.robust, FRONT, pm.StoredStudy.alternatives],
    "sensitivity": [pm.sensitivity, PICK],
    "limit": [pm.limit, FRONT],
    "export": [pm.export, pm.export_trial, PICK],
    "report": [pm.write_report],
}  #: Command -> the functions that do the same; a row that ``pick`` returns is what others take.

ALONE = {
    "pareto": "a job of several commands, whose steps Python has one by one",
    "init": "writes a study file to edit; Study.define makes a study",
    "repair": "mends a file that Optuna's users added to; nothing in Python reads what it drops",
    "dashboard": "a server that runs until Ctrl-C",
    "replay": "a check of a leg that was built, printed as tables; legs are no objects of Python yet",
    "compare": "likewise, of the log of a jump",
}

RENAMED = {
    "--processes": "executor",
    "--min-height": "min_height_m",
    "--max-energy": "max_energy_j",
    "--limit": "at_most",
    "--min": "at_least",
    "--max": "at_most",
    "--knee": "by",
    "--tradeoff": "by",
    "--all": "include_ill_conditioned",
    "study_file": "study",
    "campaign_file": "file",
    "dbs": "studies",
    "--set": "changes",
    "--gif": "out",
    "--video": "out",
    "--no-jumps": "jumps",
    "--no-strength": "strength",
}
OF_COMMAND = {
    ("simulate", "--case"): "designs",
    ("export", "--case"): "design",
    ("report", "--output"): "out",
    ("export", "--output"): "folder",
    ("robust", "--trial"): "trials",
    ("limit", "--trial"): "trials",
    ("limit", "db"): "study",
    ("pick", "--alternatives"): "count",
    ("robust", "--alternatives"): "count",
    ("verify", "db"): "study",
    ("status", "db"): "study",
    ("robust", "db"): "study",
    ("sensitivity", "db"): "study",
    ("export", "db"): "study",
    ("trials", "db"): "path",
}
_VALUES = "Python has the values, which are frames, mappings and objects"
REASONS = {
    "--json": _VALUES,
    "--csv": "frames have to_csv",
    "--parquet": "frames have to_parquet",
    "--scheduler": "executor=distributed.Client(ADDRESS).get_executor()",
}
REASONS_OF_COMMAND = {
    ("actuators", "--ratio"): "ActuatorMap.lookup(ratio) has the gearbox with all that is printed",
    ("actuators", "--without"): "a comparison of rules, for their documentation",
    ("actuators", "--bearings"): "the list of bearings is data/bearings.toml",
    ("actuators", "--figure"): "plot_actuators returns the figure",
    ("actuators", "--force"): "nothing is written",
    ("simulate", "--json"): _VALUES,
    ("simulate", "--hops"): "a course of one robot, for the terminal; jump.landing.hops makes it",
    ("simulate", "--trace"): "the function trace",
    ("simulate", "--model"): "export(..., formats=['mjcf']) writes it with the parts' shapes",
    ("simulate", "--view"): "a window, which belongs to a terminal",
    ("simulate", "--audit"): "studies have audits; of one design it is a check for the terminal",
    ("run", "--no-strength"): "Study.define(strength=False)",
    ("trials", "--state"): "StoredStudy.trials has the column",
    ("trials", "--force"): "nothing is written",
    ("front", "db"): "a method of StoredStudy",
    ("front", "--force"): "nothing is written",
    ("front", "--most"): "a frame is cut by iloc",
    ("pick", "db"): "a method of StoredStudy",
    ("robust", "--every"): "a frame is cut by iloc; trials= takes its column",
    ("sensitivity", "--plot"): "the frame has what the chart shows",
    ("sensitivity", "--force"): "nothing is written",
    ("export", "--record"): "a record comes from an export, which Python repeats by the same call",
    ("export", "--front"): "a loop over front()",
    ("export", "--every"): "a loop over front().iloc[::N]",
    ("export", "--workers"): "belongs to --front",
    ("export", "--no-drawings"): "formats= names what is wanted",
    ("export", "--no-assembly"): "formats= names what is wanted",
    ("export", "--hip-deg"): "the pose of the CAD assembly, which a reader turns there",
    ("export", "--knee-deg"): "likewise",
}


def option(parameter):
    return parameter.opts[-1] if isinstance(parameter, click.Option) else parameter.name


OPTIONS = {name: [option(one) for one in cli.get_command(None, name).params] for name in _COMMANDS if name not in ALONE}


def test_every_command_has_its_functions_or_a_reason():
    assert {*DOORS, *ALONE} == set(_COMMANDS)
    assert not DOORS.keys() & ALONE


@pytest.mark.parametrize("command", DOORS)
def test_every_option_has_its_counterpart_or_a_reason(command):
    taken = {name for function in DOORS[command] for name in inspect.signature(function).parameters}
    for name in OPTIONS[command]:
        if (command, name) in REASONS_OF_COMMAND:
            continue
        same = OF_COMMAND.get((command, name), RENAMED.get(name, name.removeprefix("--").replace("-", "_")))
        if same not in taken:
            assert name in REASONS, f"{command} {name}: give it a counterpart, or say here why it has none"


def test_the_tables_name_nothing_that_is_gone():
    known = {(command, name) for command, names in OPTIONS.items() for name in names}
    assert {*OF_COMMAND, *REASONS_OF_COMMAND} <= known
    assert {*RENAMED, *REASONS} <= {name for _, name in known}
