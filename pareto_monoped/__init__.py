"""Co-design of a jumping one-legged robot: actuators, links and controller on one Pareto front.

Everything in ``__all__`` is for scripts and notebooks and stays as it is within a major version; the rest of the
package may change. Names are imported when they are first used, so that importing the package costs nothing.

Three tables say what there is: ``VARIABLES`` has a record of each design variable, ``MEASURES`` of each measure of a
jump, with its unit, meaning and better direction, and ``PAPER_CASES`` the designs of the paper's Table I by name.

Example:
    >>> import pareto_monoped as pm
    >>> jump = pm.simulate(pm.PAPER_CASES["C"].design)
    >>> print(f"{jump.height_m[0]:.2f} m")
    1.06 m
    >>> print(*(f"{one.name}, {one.lower:g} to {one.upper:g} {one.unit}" for one in pm.VARIABLES[:2]), sep="; ")
    thigh_length_m, 0.3 to 0.5 m; shank_length_m, 0.3 to 0.5 m
    >>> pm.MEASURES["cost_eur"].unit, pm.VARIABLES["knee_ratio"].upper
    ('EUR', 8.7)
    >>> [one.name for one in pm.MEASURES if one.unit == "J" and one.direction == "minimise"][:2]
    ['energy_j', 'energy_hip_j']
"""

from typing import TYPE_CHECKING, Any

__version__ = "0.3.0"
__date__ = "2026-11-23"  # of the version: on drawings of designs that no study made

if TYPE_CHECKING:
    from pareto_monoped.actuator.actuator import Actuator
    from pareto_monoped.actuator.motor import Motor
    from pareto_monoped.actuator.ratiomap import ActuatorMap
    from pareto_monoped.analysis.alternatives import Alternative
    from pareto_monoped.analysis.verify import Verification
    from pareto_monoped.api.jumps import (
        actuator_map,
        build_robot,
        load_calibration,
        load_motor,
        simulate,
        table1,
        trace,
    )
    from pareto_monoped.api.outputs import Export, export, export_trial, film, write_report
    from pareto_monoped.api.plots import plot_actuators, plot_front, plot_jump
    from pareto_monoped.api.robustness import limit, robust, sensitivity, status, verify
    from pareto_monoped.api.running import resume, run, run_campaign
    from pareto_monoped.api.studies import Picked, StoredStudy, load_study
    from pareto_monoped.definition.study import Study
    from pareto_monoped.design import PAPER_CASES, VARIABLES, Design, PaperCase, Variable
    from pareto_monoped.errors import (
        CalibrationError,
        CheckError,
        DatabaseError,
        DesignError,
        DiskError,
        InputError,
        LostTrialsError,
        MotorError,
        OutputError,
        ParetoMonopedError,
        SelectionError,
        ServerError,
        SimulationError,
        StudyError,
        WorkerError,
    )
    from pareto_monoped.jump.calibration import Calibration
    from pareto_monoped.jump.laws import OwnLaw
    from pareto_monoped.measures import MEASURES, Measure
    from pareto_monoped.pareto.growth import SecondSearch
    from pareto_monoped.robot.build import Robot
    from pareto_monoped.search.algorithm import Scores, Space
    from pareto_monoped.study.outside import OptunaObjective
    from pareto_monoped.study.pymoo_problem import MonopedProblem
    from pareto_monoped.study.session import Progress

__all__ = [
    "MEASURES", "PAPER_CASES", "VARIABLES", "Actuator", "ActuatorMap", "Alternative", "Calibration",
    "CalibrationError", "CheckError", "DatabaseError", "Design", "DesignError", "DiskError", "Export", "InputError",
    "LostTrialsError", "Measure", "MonopedProblem", "Motor", "MotorError", "OptunaObjective", "OutputError", "OwnLaw",
    "PaperCase", "ParetoMonopedError", "Picked", "Progress", "Robot", "Scores", "SecondSearch", "SelectionError",
    "ServerError", "SimulationError", "Space", "StoredStudy", "Study", "StudyError", "Variable", "Verification",
    "WorkerError", "__version__", "actuator_map", "build_robot", "export", "export_trial", "film", "limit",
    "load_calibration", "load_motor", "load_study", "plot_actuators", "plot_front", "plot_jump", "resume", "robust",
    "run", "run_campaign", "sensitivity", "simulate", "status", "table1", "trace", "verify", "write_report",
]  # fmt: skip

_HOMES = {
    "actuator.actuator": ("Actuator",),
    "actuator.motor": ("Motor",),
    "actuator.ratiomap": ("ActuatorMap",),
    "analysis.alternatives": ("Alternative",),
    "analysis.verify": ("Verification",),
    "api.jumps": ("actuator_map", "build_robot", "load_calibration", "load_motor", "simulate", "table1", "trace"),
    "api.outputs": ("Export", "export", "export_trial", "film", "write_report"),
    "api.plots": ("plot_actuators", "plot_front", "plot_jump"),
    "api.robustness": ("limit", "robust", "sensitivity", "status", "verify"),
    "api.running": ("resume", "run", "run_campaign"),
    "api.studies": ("Picked", "StoredStudy", "load_study"),
    "definition.study": ("Study",),
    "design": ("PAPER_CASES", "VARIABLES", "Design", "PaperCase", "Variable"),
    "errors": (
        "CalibrationError",
        "CheckError",
        "DatabaseError",
        "DesignError",
        "DiskError",
        "InputError",
        "LostTrialsError",
        "MotorError",
        "OutputError",
        "ParetoMonopedError",
        "SelectionError",
        "ServerError",
        "SimulationError",
        "StudyError",
        "WorkerError",
    ),
    "jump.calibration": ("Calibration",),
    "jump.laws": ("OwnLaw",),
    "measures": ("MEASURES", "Measure"),
    "pareto.growth": ("SecondSearch",),
    "robot.build": ("Robot",),
    "search.algorithm": ("Scores", "Space"),
    "study.outside": ("OptunaObjective",),
    "study.pymoo_problem": ("MonopedProblem",),
    "study.session": ("Progress",),
}  #: Module -> the public names that it defines.
_HOME = {name: home for home, names in _HOMES.items() for name in names}


if not TYPE_CHECKING:  # to a type checker every misspelt name would be there

    def __getattr__(name: str) -> Any:
        """Return a public name, imported now that it is used (PEP 562)."""
        if name not in _HOME:
            raise AttributeError(f"module 'pareto_monoped' has no attribute {name!r}")
        from importlib import import_module

        value = getattr(import_module(f"pareto_monoped.{_HOME[name]}"), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    """Return the public names."""
    return sorted(__all__)
