"""Time of one complete export in a new process and in a running one, and the values its checks measured.

Run: python benchmarks/cad_export.py

Prints JSON. The aims are 15 s in a new process and 6 s in a running one, on two cores. The exports in ``later_s`` are
of other designs than the first, so that the process has to build most of their actuators' parts. The processor time of
a new process is that of both of its processes; on two cores that have nothing else to do, half of it is the least time.
"""

import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

_FRESH = 3
_LATER = ("nominal", "A", "B", "C", "nominal", "A")


def main() -> None:
    with tempfile.TemporaryDirectory() as place:
        fresh, processor = [], []
        for number in range(_FRESH):
            started, used = time.perf_counter(), _used_s()
            folder = Path(place) / f"fresh_{number}"
            command = [sys.executable, "-m", "pareto_monoped", "export", "--case", "C", "-o", str(folder)]
            subprocess.run(command, check=True, capture_output=True)
            fresh.append(round(time.perf_counter() - started, 2))
            processor.append(round(_used_s() - used, 2))

        from pareto_monoped.actuator.search import map_for
        from pareto_monoped.cad.export import export_design
        from pareto_monoped.design import PAPER_CASES
        from pareto_monoped.jump.calibration import load_calibration

        actuator_map, calibration = map_for("VT8020"), load_calibration()
        # Every export has another length, so that no design is exported twice.
        first = PAPER_CASES["C"].design.replace({"thigh_length_m": 0.4})
        export_design(first, actuator_map, calibration, Path(place) / "first")
        later = []
        for number, case in enumerate(_LATER):
            design = PAPER_CASES[case].design.replace({"shank_length_m": 0.36 + 0.01 * number})
            started = time.perf_counter()
            summary = export_design(design, actuator_map, calibration, Path(place) / f"later_{number}")
            later.append(round(time.perf_counter() - started, 2))
    found = {
        "fresh_s": {"median": statistics.median(fresh), "all": fresh},
        "fresh_processor_s": {"median": statistics.median(processor), "all": processor},
        "later_s": {"median": round(statistics.median(later), 2), "all": later},
        "load": [round(value, 1) for value in os.getloadavg()],
        "checks": {check.name: check.worst for check in summary.checks},
    }
    print(json.dumps(found, indent=2))


def _used_s() -> float:
    """Processor time of all processes that have ended, by user and system."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


if __name__ == "__main__":
    main()
