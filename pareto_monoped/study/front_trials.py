"""The trials of the front that a study keeps, in a moment: for a shell that completes their numbers."""

from pareto_monoped.config import parsed_json
from pareto_monoped.study.database import reading
from pareto_monoped.study.goals import objectives_of
from pareto_monoped.study.kept_front import rows_of
from pareto_monoped.study.place import StudyPlace


def front_trials(db: StudyPlace) -> dict[int, str]:
    """Number of each trial of the kept front -> its objectives in words, by the first objective.

    They are not checked against the study's seals, which takes longer than a key press: good for choosing a trial, and
    for no more.

    Raises:
        DatabaseError: missing, not a study, damaged, of a newer version, or of format 1, which kept no front.
        ServerError: the server is away.
    """
    with reading(db) as connection:
        (study,) = connection.execute("SELECT value FROM monoped_meta WHERE key = 'study'").fetchone()
        (numbers,) = connection.execute("SELECT trials FROM monoped_front").fetchone()
        objectives = objectives_of(parsed_json(study)["objectives"])
        rows = rows_of(connection, ("trial", *objectives.names), parsed_json(numbers))
    rows.sort(key=lambda row: (row[1], row[0]))
    return {row[0]: objectives.text(row[1:]) for row in rows}
