"""The folder of an export: it is complete or absent, nothing is written outside it, and foreign files stay.

A file is foreign unless the record of an earlier export lists it, under a name that an export writes. An interrupt does
not break off the folder's move into place, and temporary folders are deleted.
"""

import csv
import io
import re
import secrets
import shutil
import signal
import tempfile
import threading
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType

from pareto_monoped.config import read_json
from pareto_monoped.errors import InputError, OutputError, complaint, unknown_name
from pareto_monoped.files import FORCE, unwritable

_SIGNALS = (signal.SIGINT, signal.SIGTERM)  # Ctrl-C, and what ends the worker processes of a batch
_TRIES = 100  # to delete a folder: what a thread was writing when the folder got another name may come during the first
_moving = threading.Lock()
_unfinished: set[Path] = set()
_SAFE_NAME = re.compile(r"[a-z0-9_]+")

FILES: Mapping[str, tuple[tuple[str, str], ...]] = {
    "step": (
        ("assembly.step", "the whole robot for any CAD program: named, coloured parts, mm"),
        ("parts/step/", "each part for machining or changing"),
    ),
    "stl": (("parts/stl/", "each part as triangles, mm"),),
    "3mf": (("print/", "the 3D-printed parts for the slicer, mm, lying as they are printed"),),
    "dxf": (
        (
            "laser/",
            "the plates for the laser cutter: true outline without kerf on the layer CUT, mm; NOTES says what follows",
        ),
        ("test_stand/", "two arms that hang the base on vertical rails, how they are used, and what differs there, mm"),
    ),
    "glb": (("assembly.glb", "the robot to look at in a browser or viewer, m"),),
    "mjcf": (
        ("model/monoped.xml", "MuJoCo model that makes the simulated jump, with meshes and colliders, SI units"),
        ("model/jump.json", "every number that the jump needs besides the model: motors, controller, losses, SI units"),
        ("model/replay.py", "makes the jump again with MuJoCo and NumPy alone: `python model/replay.py`"),
        ("model/monoped_stand.xml", "the same robot on the rails of the test stand, with arms and carriages"),
        ("model/jump_stand.json", "what its jump needs there: `python model/replay.py stand`"),
    ),
    "urdf": (("model/monoped.urdf", "the same robot for other simulators, SI units"),),
    "pdf": (
        (
            "drawings/assembly.pdf",
            "the robot with sections and the list of items, its units pulled apart, with balloons, and its cables",
        ),
        ("drawings/", "a workshop drawing of each part that is made: dimensions, fits, tolerances, gear data"),
    ),
    "assembly": (
        ("assembly/index.html", "how the robot is put together: steps, torques, chain, cables, printing, casting"),
        (
            "assembly/hardware.csv",
            "what is bought: designations, alternatives, counts, adhesives, grease, cables",
        ),
        ("assembly/cables.csv", "where the cables run: every corner, bend radius, cut length, ties"),
        ("assembly/", "the pictures of the steps, and the mould for the foot"),
    ),
    "png": (
        ("assembly.png", "the robot in its start pose"),
        ("exploded.png", "the robot pulled apart along the joints' axis"),
        ("hip_actuator_section.png", "the hip actuator cut along its axis, with numbers and names of its parts"),
        ("knee_actuator_section.png", "the knee actuator, likewise"),
        ("knee_joint_section.png", "the knee joint, likewise"),
    ),
}
"""Per format: path and purpose of each file, or of each folder of files (path with a slash at its end)."""
RECORD = "design.json"  #: Name of the file that lists all files of an export; it is written last.
ALWAYS = (
    "README.md",
    "bom.csv",
    "strength.csv",
    "tolerances.csv",
    "cad/model.py",
    "parameters.csv",
    "monoped_equations.txt",
    "checks.json",
    RECORD,
)
"""Files of every export."""
FORMATS = tuple(FILES)  #: All formats, in the order in which they are listed; an export writes all of them by default.


@contextmanager
def unbroken() -> Iterator[None]:
    """Hold interrupts back until the block has ended, then deliver them."""
    with _moving:
        if threading.current_thread() is not threading.main_thread():
            # Python runs signal handlers in the main thread only.
            yield
            return
        came: list[tuple[int, FrameType | None]] = []
        before = {held: signal.signal(held, lambda number, frame: came.append((number, frame))) for held in _SIGNALS}
        try:
            yield
        finally:
            for held, handler in before.items():
                signal.signal(held, handler)
    for number, frame in came:
        handler = before[signal.Signals(number)]
        if callable(handler):
            handler(number, frame)
        elif handler is signal.SIG_DFL:
            signal.raise_signal(number)


@contextmanager
def noted(folder: Path) -> Iterator[None]:
    """Remember a temporary folder while the block runs, and delete what is still in it at the end."""
    _unfinished.add(folder)
    try:
        yield
    finally:
        _delete(folder)
        _unfinished.discard(folder)


@contextmanager
def without_unfinished() -> Iterator[None]:
    """Delete all temporary folders; nothing takes its place while the block runs."""
    with _moving:
        for folder in tuple(_unfinished):
            _delete(folder)
        yield


def _delete(folder: Path) -> None:
    """Delete a folder, to which another thread may still write: under another name, no thread finds it any more."""
    gone = folder.with_name(f"{folder.name}-deleted")
    with suppress(OSError):
        folder.rename(gone)
    for path in (gone, folder):
        for _ in range(_TRIES):
            shutil.rmtree(path, ignore_errors=True)
            if not path.exists():
                break


def chosen_formats(names: Sequence[str] | None) -> tuple[str, ...]:
    """Return the formats asked for, in the order of ``FORMATS``, all for None; ``InputError`` for an unknown name."""
    if names is None:
        return FORMATS
    if isinstance(names, str) or not isinstance(names, Sequence):
        raise InputError(complaint("formats", names, "a list of formats, such as ['step']", "give one"))
    for name in names:
        if name not in FORMATS:
            raise InputError(unknown_name("format", name, FORMATS))
    return tuple(name for name in FORMATS if name in names)


def require_free(out_dir: Path, *, force: bool) -> None:
    """Refuse a place that cannot or must not be written to, before work is done for it.

    Raises:
        OutputError: a file, a folder that is not empty without ``force``, one with foreign files in the way, or one in
            which nothing can be made.
        DiskError: the disk fails.
    """
    try:
        if out_dir.exists() and not out_dir.is_dir():
            raise OutputError(f"output {str(out_dir)!r}: is a file; give the name of a folder")
        filled = out_dir.is_dir() and any(out_dir.iterdir())
    except OSError as error:
        raise unwritable(out_dir, error, "give a folder that can be read and written") from error
    try:
        nearest = next(folder for folder in out_dir.absolute().parents if folder.exists())
        tempfile.TemporaryDirectory(dir=nearest, prefix=f".{out_dir.name}-").cleanup()
    except OSError as error:
        raise unwritable(out_dir, error, "give a writable folder") from error
    if filled and not force:
        raise OutputError(
            f"output {str(out_dir)!r}: is not empty; give another folder, or {FORCE} to replace an export"
        )
    if filled:  # before the work of an export, not only after it
        _require_own(out_dir, ALWAYS, _earlier_files(out_dir))


def safe(name: str) -> str:
    """Return a name that cannot lead out of the folder, or raise ``OutputError``."""
    if not _SAFE_NAME.fullmatch(name):
        raise OutputError(f"part name {name!r}: must be letters, digits and underscores to become a file; rename it")
    return name


def write(folder: Path, name: str, content: str | bytes) -> None:
    """Write a file of the folder."""
    path = _path(folder, name)
    if isinstance(content, str):
        path.write_text(content, encoding="utf-8", newline="\n")
    else:
        path.write_bytes(content)


def csv_text(columns: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table as CSV."""
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows((columns, *rows))
    return stream.getvalue()


def files_in(folder: Path) -> list[str]:
    """Return all files of a folder, as paths relative to it."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


@contextmanager
def beside(out_dir: Path) -> Iterator[Path]:
    """Make a temporary folder beside the target; what is still in it when the block ends is deleted."""
    # The name is noted before there is a folder, because an interrupt may come as soon as it has been made. With 64
    # random bits it is nobody else's.
    folder = out_dir.parent / f".{out_dir.name}-{secrets.token_hex(8)}"
    with noted(folder):
        try:
            out_dir.parent.mkdir(parents=True, exist_ok=True)
            folder.mkdir()
        except OSError as error:
            raise unwritable(out_dir, error, "give a writable folder") from error
        try:
            yield folder
        except OSError as error:
            raise unwritable(out_dir, error, "make room or give another") from error


def move_in(folder: Path, out_dir: Path) -> None:
    """Put a finished folder in its place, instead of the files of an earlier export; other files stay.

    An interrupt waits until this is done.

    Raises:
        OutputError: a foreign file has the name of one of the new files; nothing has changed then.
    """
    with unbroken():
        _move(folder, out_dir)


def _move(folder: Path, out_dir: Path) -> None:
    if not out_dir.exists() or not any(out_dir.iterdir()):
        folder.replace(out_dir)
        return
    earlier = _earlier_files(out_dir)
    _require_own(out_dir, files_in(folder), earlier)
    for path in earlier:
        path.unlink(missing_ok=True)
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.name != RECORD:
            path.replace(_path(out_dir, str(path.relative_to(folder))))
    # Last, so that a folder with a record is whole.
    (folder / RECORD).replace(out_dir / RECORD)


def _path(folder: Path, name: str) -> Path:
    # The folder itself is not made: once it has been deleted, a thread that still writes must not bring it back.
    path = folder / name
    for parent in reversed(path.relative_to(folder).parents[:-1]):
        (folder / parent).mkdir(exist_ok=True)
    return path


def _require_own(out_dir: Path, names: Iterable[str], earlier: Collection[Path]) -> None:
    """Refuse to replace what no earlier export made: a foreign file, or anything else that has a file's name."""
    own = set(earlier)
    for name in names:
        path = out_dir / name
        taken = [parent for parent in path.parents[: name.count("/")] if parent.exists() and not parent.is_dir()]
        if not taken and path not in own and (path.is_symlink() or path.exists()):
            taken = [path]
        if taken:
            raise OutputError(
                f"output {str(out_dir)!r}: {str(taken[0].relative_to(out_dir))!r} is not of an earlier export and "
                "would be lost; move it away, or give another folder"
            )


def _earlier_files(out_dir: Path) -> list[Path]:
    """Return the files that an earlier export wrote here, its record first."""
    try:
        names = [str(name) for name in read_json(out_dir / RECORD)["files"]]
    except (OSError, ValueError, KeyError, TypeError):
        return []  # nothing here is known to be ours
    # The record is a file like any other: it may neither point outside, nor at what no export writes.
    paths = [out_dir / name for name in (RECORD, *filter(_written_by_exports, names))]
    return [
        path
        for path in paths
        if path.is_file() and not path.is_symlink() and path.parent.resolve().is_relative_to(out_dir.resolve())
    ]


def _written_by_exports(name: str) -> bool:
    """Return whether an export writes a file of this name, or at least into its folder, whose files vary."""
    made = (*ALWAYS, *(path for files in FILES.values() for path, _ in files))
    first, *rest = Path(name).parts or ("",)
    folders = {path.partition("/")[0] for path in made if "/" in path}
    return ".." not in rest and (first in folders if rest else name in made)
