"""Every file of an export, and every sheet of a second robot, is as it was when ``signatures.json`` was made.

That was after all other tests had passed. It says that something changed, not that
it was right. After a change that is wanted, look at the files that the test names, and make it again:
``PARETO_MONOPED_SIGN=1 python -m pytest tests/cad/test_signatures.py tests/cad/drawing/test_sheets.py``.
"""

import json
import os
from pathlib import Path

import numpy as np

from tests.cad.signed import signature

SIGNED = Path(__file__).parent / "signatures.json"
# Other machines may round a number that lies between two, and colour a pixel on an edge, otherwise.
NEAR = {".stl": 2e-5, ".png": 0.02, ".urdf": 1e-5, ".xml": 1e-5}


def compare(found, known, folder=""):
    """Hold signatures to those that are kept, or keep them where that is asked for."""
    if os.environ.get("PARETO_MONOPED_SIGN"):
        kept = json.loads(SIGNED.read_text()) if SIGNED.exists() else {}
        kept[known] = found
        lines = (
            f" {json.dumps(name)}: {{\n"
            + ",\n".join(f"  {json.dumps(k)}: {json.dumps(v)}" for k, v in one.items())
            + "\n }"
            for name, one in sorted(kept.items())
        )
        SIGNED.write_text("{\n" + ",\n".join(lines) + "\n}\n")
    expected = json.loads(SIGNED.read_text())[known]
    assert list(found) == list(expected)
    wrong = [
        name
        for name, value in found.items()
        if len(value) != len(expected[name])
        or not np.allclose(value, expected[name], rtol=1e-8, atol=NEAR.get(Path(name).suffix, 0.03))
    ]
    assert not wrong, {name: (found[name], expected[name]) for name in wrong}


def test_every_file_of_an_export_has_its_signature(exported):
    files = sorted(path for path in exported.folder.rglob("*") if path.is_file())
    signed = {str(path.relative_to(exported.folder)): signature(path) for path in files}
    compare({name: value for name, value in signed.items() if value is not None}, "case C")
