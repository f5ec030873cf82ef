"""Damage a finished study by flipped bits, bursts, truncations and wrong pages, and check that no damage passes.

    python tools/damage_storm.py --damages 1000 --seed 1

The study is a real one, with audits and robustness. Each damage is made to a copy, which the commands then read:
``status``, ``front``, ``pick``, ``verify``, the readers of reports, exports and robustness, and ``resume``. Every
command must either print what it prints of the undamaged study, or refuse in one line. ``verify`` must refuse whenever
any row of any table is another one, or cannot be read. A resumed study must be equal to the undamaged one resumed.
Reading must leave the file as it is, and so must a resume that is refused. Each damage is tried in a process forked
from here, so that a crash or a runaway allocation is seen too. Exits with 1 if anything was found.
"""

import argparse
import contextlib
import io
import os
import random
import re
import shutil
import sqlite3
import sys
import tempfile
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from pareto_monoped.cli import main as command_line
from pareto_monoped.definition.study import Study, load_study
from pareto_monoped.storage.extra_rows import read_robustness
from pareto_monoped.storage.reader import StudyData, read_study
from pareto_monoped.study.run import run

MOST_MB = 200.0
"""Memory that no damage may make a command take on top of what the undamaged study takes: our own choice, a tenth of
what a small machine has."""
_EVALUATIONS, _MORE = 60, 10
_PAGE = 4096  #: Bytes of a page of SQLite, unless a database says otherwise (its file format, section 1.3.2).
_STUDY = f"""
name = "damaged"
evaluations = {_EVALUATIONS}
strength = false
motor = ["VT8020", "U8"]
[algorithm]
name = "nsga2"
population = 10
"""
_READING = (
    ("status", "{db}"),
    ("status", "{db}", "--json"),
    ("front", "{db}", "--json"),
    ("pick", "{db}", "--knee", "--json"),
    ("verify", "{db}"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Whole:
    """The undamaged study, what is read from it, and how it goes on."""

    db: Path
    earlier: bytes
    rows: dict[str, list[tuple[object, ...]]]
    said: dict[tuple[str, ...], str]
    data: StudyData
    robustness: object
    resumed: StudyData


def main() -> int:
    """Damage copies; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--damages", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--pages", action="store_true", help="only copies, exchanges and earlier states of pages")
    parser.add_argument("--keep", type=Path, help="folder for copies whose damage passed")
    arguments = parser.parse_args()
    generator, results, findings, most_mb = random.Random(arguments.seed), Counter[str](), [], 0.0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        whole = _whole(folder)
        content = whole.db.read_bytes()
        for number in range(arguments.damages):
            what, damaged = _damage(content, whole.earlier, generator, pages=arguments.pages)
            copy = folder / "copy" / whole.db.name
            copy.parent.mkdir()
            copy.write_bytes(damaged)
            said = _in_a_fork(partial(_findings, copy, whole))
            outcome, megabytes, lines = said[0], float(said[1]), said[2:]
            results[outcome] += 1
            most_mb = max(most_mb, megabytes)
            if megabytes > MOST_MB:
                lines.append(f"{megabytes:.0f} MB more than undamaged")
            if lines and arguments.keep is not None:
                arguments.keep.mkdir(parents=True, exist_ok=True)
                (arguments.keep / f"{number}.db").write_bytes(damaged)
            findings += [f"{number}: {what}: {line}" for line in lines]
            for line in findings[len(findings) - len(lines) :]:
                print(line, file=sys.stderr, flush=True)
            shutil.rmtree(copy.parent)
            if (number + 1) % 100 == 0:
                print(f"{number + 1} damages, {len(findings)} findings", file=sys.stderr, flush=True)
    print(f"seed {arguments.seed}: {arguments.damages} damages to a study of {len(content)} bytes")
    print("  " + ", ".join(f"{outcome} {count}" for outcome, count in sorted(results.items())))
    print(f"  memory: {most_mb:.1f} MB more than undamaged at most")
    print(f"  passed, crashed or said in more than a line: {len(findings)}")
    for line in findings:
        print(f"  {line}")
    return 1 if findings else 0


def _whole(folder: Path) -> Whole:
    (folder / "damaged.toml").write_text(_STUDY)
    study, db = load_study(folder / "damaged.toml"), folder / "damaged.db"
    run(study, db, evaluations=_EVALUATIONS - 2 * _MORE, workers=1)
    earlier = db.read_bytes()
    run(study, db, workers=1)
    _said(("robust", str(db), "--samples", "4", "--workers", "1"))
    later = folder / "later.db"
    shutil.copy(db, later)
    resumed = _resumed(study, later)
    return Whole(
        db=db,
        earlier=earlier,
        rows=_rows(db),
        said={words: _said(_filled(words, db))[1] for words in _READING},
        data=read_study(db),
        robustness=read_robustness(db),
        resumed=resumed,
    )


def _resumed(study: Study, db: Path) -> StudyData:
    run(study, db, evaluations=_EVALUATIONS + _MORE, workers=1)
    return read_study(db)


def _wrong_pages(content: bytes, earlier: bytes, generator: random.Random) -> tuple[str, bytes]:
    """A copy with one page over another, two exchanged, or one as it was earlier, and what was done to it."""
    pages = [content[k : k + _PAGE] for k in range(0, len(content), _PAGE)]
    before = [earlier[k : k + _PAGE] for k in range(0, len(earlier), _PAGE)]
    one, other = generator.sample(range(len(pages)), 2)
    kind = generator.choice(("copied over", "exchanged with", "left from earlier"))
    if kind == "left from earlier":
        one = generator.choice([k for k in range(min(len(before), len(pages))) if before[k] != pages[k]])
        pages[one] = before[one]
        return f"page {one} {kind}", b"".join(pages)
    first, second = pages[one], pages[other]
    pages[other] = first
    if kind == "exchanged with":
        pages[one] = second
    return f"page {one} {kind} {other}", b"".join(pages)


def _damage(content: bytes, earlier: bytes, generator: random.Random, *, pages: bool) -> tuple[str, bytes]:
    """A damaged copy, and what was done to it; one of five damages is to the first page, which describes all others."""
    bent, kind = bytearray(content), generator.random()
    if pages or generator.random() < 0.2:
        return _wrong_pages(content, earlier, generator)
    place = generator.randrange(4096 if generator.random() < 0.2 else len(content))
    if kind < 0.15:
        return f"cut off at byte {place}", content[:place]
    if kind < 0.2:
        return f"cut off at page {place // 4096}", content[: place // 4096 * 4096]
    if kind < 0.3:
        length = generator.choice((1, 8, 64, 512))
        bent[place : place + length] = generator.randbytes(len(bent[place : place + length]))
        return f"{length} bytes from {place} overwritten", bytes(bent)
    bit = generator.randrange(8)
    bent[place] ^= 1 << bit
    return f"bit {bit} of byte {place} flipped", bytes(bent)


def _in_a_fork(work: Callable[[], Iterator[str]]) -> list[str]:
    """The lines that ``work`` yields in a process of its own; a crash is one."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        try:
            with os.fdopen(writing, "w") as pipe:
                for line in work():
                    print(line.replace("\n", "\\n"), file=pipe, flush=True)
        except BaseException:
            traceback.print_exc()
            os._exit(1)
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        lines = pipe.read().splitlines()
    if code := os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]):
        return ["crashed", "0", *lines[2:], f"ended with {code}"]
    return lines


def _findings(db: Path, whole: Whole) -> Iterator[str]:
    """What came of it in a word, the memory it took in MB, and one line per thing that must not be."""
    Path("/proc/self/clear_refs").write_text("5")  # the peak of the memory counts from here
    before_mb, content = _peak_mb(), db.read_bytes()
    found: list[str] = []
    same = _content_is(db, whole)
    refused = Counter[bool]()
    for words in _READING:
        code, said, errors = _said(_filled(words, db))
        refused[code != 0] += 1
        equal = said.replace(str(db), str(whole.db)) == whole.said[words]
        found += _wrong(words[0], code, equal, errors)
        if words[0] == "verify" and code == 0 and not same:
            found.append("verify finds nothing, but rows are other ones")
    found += _reader("report and export", lambda: _equal(read_study(db), whole.data))
    found += _reader("robustness", lambda: read_robustness(db) == whole.robustness)
    if db.read_bytes() != content or len(list(db.parent.iterdir())) > 1:
        found.append("reading changed the file, or left another beside it")
    code, _, errors = _said(("resume", str(db), "--evaluations", str(_EVALUATIONS + _MORE), "--workers", "1"))
    refused[code != 0] += 1
    found += _wrong("resume", code, code == 0 and _equal(read_study(db), whole.resumed), errors, ends_well=True)
    if code and (db.read_bytes() != content or len(list(db.parent.iterdir())) > 1):
        found.append("a refused resume changed the file, or left another beside it")
    yield "refused by all" if not refused[False] else "refused by some" if refused[True] else "harmless"
    yield f"{_peak_mb() - before_mb}"
    yield from found


def _wrong(name: str, code: int, equal: bool, errors: str, *, ends_well: bool = False) -> Iterator[str]:
    """What is wrong with how a command ended."""
    lines = errors.splitlines()
    if code == 0 and not equal:
        yield f"{name} says other things than of the undamaged study"
    if code not in (0, 1, 2):
        yield f"{name} ended with {code}: {errors}"
    told = [line for line in lines if line.startswith("error: ")]
    others = [line for line in lines if not line.startswith(("error: ", "found: ", "note: "))]
    if code in (1, 2) and (len(told) != 1 or (others and not ends_well)):
        yield f"{name} did not refuse in one line: {errors}"


def _reader(name: str, works: Callable[[], bool]) -> Iterator[str]:
    from pareto_monoped.errors import ParetoMonopedError

    try:
        if not works():
            yield f"the reader of {name} gives other things than of the undamaged study"
    except ParetoMonopedError as error:
        if "\n" in str(error):
            yield f"the reader of {name} refused in several lines: {error}"
    except Exception:
        yield f"the reader of {name}: {traceback.format_exc()}"


def _equal(one: StudyData, other: StudyData) -> bool:
    tables = ("trials", "audits")
    return (
        all(getattr(one, name).equals(getattr(other, name)) for name in tables)
        and one.history.drop(columns="seconds").equals(other.history.drop(columns="seconds"))
        and one.checkpoint == other.checkpoint
        and one.study == other.study
        and one.meta.contents == other.meta.contents
        and one.meta.hash == other.meta.hash
    )


def _content_is(db: Path, whole: Whole) -> bool:
    """Whether every row of every table is as it was."""
    try:
        return _rows(db) == whole.rows
    except (sqlite3.Error, UnicodeError, OverflowError, MemoryError):
        return False


def _rows(db: Path) -> dict[str, list[tuple[object, ...]]]:
    """All that a database holds: every row of every table."""
    connection = sqlite3.connect(f"{db.as_uri()}?mode=ro", uri=True)
    connection.text_factory = bytes
    try:
        tables = connection.execute("SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name").fetchall()
        names = [name.decode() for (name,) in tables]
        return {name: connection.execute(f'SELECT * FROM "{name}" NOT INDEXED').fetchall() for name in names}
    finally:
        connection.close()


def _filled(words: tuple[str, ...], db: Path) -> tuple[str, ...]:
    return tuple(word.replace("{db}", str(db)) for word in words)


def _said(words: tuple[str, ...]) -> tuple[int, str, str]:
    """Run a command of the package here: its exit code, and what it printed to both streams."""
    out, err = io.StringIO(), io.StringIO()
    code: object = 0
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            command_line(list(words))
        except SystemExit as end:
            code = end.code
        except BaseException:
            traceback.print_exc()
            code = -1
    return int(code or 0) if isinstance(code, int) or code is None else -1, out.getvalue(), err.getvalue()


def _peak_mb() -> float:
    found = re.search(r"VmHWM:\s+(\d+)", Path("/proc/self/status").read_text())
    return float(found[1]) / 1e3 if found else 0.0


if __name__ == "__main__":
    sys.exit(main())
