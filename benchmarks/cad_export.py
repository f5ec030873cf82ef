"""Time of one complete export, cold and again in the same process, and the largest difference from the records.

Run with ``python benchmarks/cad_export.py``; prints JSON. The bounds are 15 s cold and 6 s after, on two cores.
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path


def main() -> None:
    with tempfile.TemporaryDirectory() as place:
        started = time.perf_counter()
        command = [sys.executable, "-m", "pareto_monoped", "export", "--case", "C", "-o", str(Path(place) / "cold")]
        subprocess.run(command, check=True, capture_output=True)
        cold = time.perf_counter() - started

        from pareto_monoped.actuator.search import map_for
        from pareto_monoped.cad.export import export_design
        from pareto_monoped.design import PAPER_CASES
        from pareto_monoped.jump.calibration import load_calibration

        actuator_map, calibration = map_for("VT8020"), load_calibration()
        later = {}
        for case in ("nominal", "A", "B", "C"):
            started = time.perf_counter()
            summary = export_design(PAPER_CASES[case].design, actuator_map, calibration, Path(place) / case)
            later[case] = round(time.perf_counter() - started, 2)
    checks = {check.name: check.worst for check in summary.checks}
    print(json.dumps({"cold_s": round(cold, 2), "later_s": later, "checks_case_c": checks}, indent=2))


if __name__ == "__main__":
    main()
