"""Which database belongs to which study, also after the grid has changed."""

import os
import shutil
from dataclasses import replace

import pytest

from pareto_monoped.campaign.folder import held, is_ended, places_of, stored_state, strangers
from pareto_monoped.campaign.grid import load_campaign
from pareto_monoped.errors import DatabaseError, OutputError, StudyError
from pareto_monoped.storage.lock import locked
from pareto_monoped.storage.store import Store
from tests.campaign.test_grid import written
from tests.study.support import made_database


def begun(campaign, folder):
    """A database of two made generations for every study that has none."""
    folder.mkdir(exist_ok=True)
    for place in places_of(campaign, folder):
        if not place.db.exists():
            made_database(place.db, study=place.study)


def test_new_combinations_are_added_and_the_others_stay(tmp_path):
    folder = tmp_path / "grid"
    begun(load_campaign(written(tmp_path, 'motors = ["U8", "U10"]\nseeds = [1]')), folder)
    assert sorted(db.name for db in folder.glob("*.db")) == ["U10.db", "U8.db"]
    # The seed varies from now on: the studies have other names, but their databases are known by their settings.
    places = places_of(load_campaign(written(tmp_path, 'motors = ["U10", "U8"]\nseeds = [1, 2]')), folder)
    assert [(place.name, place.db.name) for place in places] == [
        ("U10_seed1", "U10.db"), ("U10_seed2", "U10_seed2.db"), ("U8_seed1", "U8.db"), ("U8_seed2", "U8_seed2.db"),
    ]  # fmt: skip
    assert [stored_state(place).state for place in places] == ["unfinished", "waiting"] * 2
    assert places[0].study.name == "U10"
    assert strangers(folder, places) == []


def test_databases_of_values_that_are_gone_are_told_and_left_alone(tmp_path):
    folder = tmp_path / "grid"
    begun(load_campaign(written(tmp_path, 'motors = ["U8", "U10"]\nseeds = [1, 2]')), folder)
    places = places_of(load_campaign(written(tmp_path, 'motors = ["U8"]\nseeds = [1, 2]')), folder)
    assert [place.db.name for place in places] == ["U8_seed1.db", "U8_seed2.db"]
    assert [db.name for db in strangers(folder, places)] == ["U10_seed1.db", "U10_seed2.db"]


@pytest.mark.parametrize(
    ("before", "now", "words"),
    [
        ("100", "90", ("evaluations: 100 -> 90 (only more is allowed)",)),
        ('case = "C"', 'case = "A"', ("case", '"C"', '"A"')),
        ("[axes]", "[study.variables]\nknee_ratio = 5.0\n[axes]", ("variables.knee_ratio",)),
    ],
)
def test_a_changed_study_is_refused_as_a_whole_with_the_difference(tmp_path, before, now, words):
    folder, path = tmp_path / "grid", written(tmp_path, 'motors = ["U8", "U10"]\nseeds = [1, 2]')
    begun(load_campaign(path), folder)
    path.write_text(path.read_text().replace(before, now))
    with pytest.raises(StudyError) as caught:
        places_of(load_campaign(path), folder)
    message = str(caught.value)
    assert message.startswith(f"campaign folder {str(folder)!r}: 4 databases began with other settings")
    assert "\n" not in message
    for word in (*words, "undo the change, or give another --folder"):
        assert word in message


def test_more_jumps_another_name_and_another_description_are_no_change(tmp_path):
    folder, path = tmp_path / "grid", written(tmp_path, "seeds = [1, 2]")
    begun(load_campaign(path), folder)
    path.write_text(path.read_text().replace("100", "200").replace('"grid"', '"other"'))
    assert all(place.study.evaluations == 200 for place in places_of(load_campaign(path), folder))


def test_the_folder_can_be_moved_with_the_files_of_its_motors_and_calibrations(tmp_path):
    old, new = tmp_path / "old", tmp_path / "new"
    old.mkdir()
    axes = 'motors = ["mine.toml"]\ncalibrations = ["sand.toml"]\nseeds = [1, 2]'
    begun(load_campaign(written(old, axes)), old / "grid")
    shutil.move(old, new)
    places = places_of(load_campaign(new / "grid.toml"), new / "grid")
    assert [stored_state(place).state for place in places] == ["unfinished"] * 2


def test_a_database_that_cannot_be_read_fails_alone(tmp_path):
    folder, campaign = tmp_path / "grid", load_campaign(written(tmp_path, "seeds = [1, 2]"))
    begun(campaign, folder)
    (folder / "seed1.db").write_bytes(b"no database" * 100)
    first, second = (stored_state(place) for place in places_of(campaign, folder))
    assert (first.state, second.state) == ("failed", "unfinished")
    assert "seed1.db" in first.reason


def test_a_study_that_another_program_holds_is_running(tmp_path):
    folder, campaign = tmp_path / "grid", load_campaign(written(tmp_path, "seeds = [1, 2]"))
    begun(campaign, folder)
    with locked(folder / "seed1.db"):
        assert [stored_state(place).state for place in places_of(campaign, folder)] == ["running", "unfinished"]


def test_a_finished_study_that_shall_have_more_jumps_is_unfinished(tmp_path):
    """One that stopped because it found nothing better stays finished, but is not ended as its file says today."""
    head = 'name = "grid"\n[study]\nevaluations = 100\nstrength = false\n'
    campaign = load_campaign(written(tmp_path, "seeds = [1, 2]", head))
    begun(campaign, tmp_path / "grid")
    places = places_of(campaign, tmp_path / "grid")
    done = stored_state(places[0]).evaluations
    small = [replace(place, study=replace(place.study, evaluations=done)) for place in places]
    for place, reason in zip(small, ("budget", "plateau"), strict=True):
        with Store(place.db, place.study) as store:
            store.set_meta({"study": place.study.as_dict(), "finished": True, "stop_reason": reason})
    assert [stored_state(place).state for place in small] == ["finished", "finished"]
    assert [is_ended(place, stored_state(place)) for place in small] == [True, True]
    assert [stored_state(place).state for place in places] == ["unfinished", "finished"]
    assert [is_ended(place, stored_state(place)) for place in places] == [False, False]


def test_a_finished_study_with_a_motor_of_a_file_is_run_again_to_see_whether_it_has_changed(tmp_path):
    campaign = load_campaign(written(tmp_path, 'motors = ["mine.toml", "U8"]'))
    begun(campaign, tmp_path / "grid")
    places = places_of(campaign, tmp_path / "grid")
    for place in places:
        with Store(place.db, place.study) as store:
            store.set_meta({"study": place.study.as_dict(), "finished": True, "stop_reason": "plateau"})
    assert [is_ended(place, stored_state(place)) for place in places_of(campaign, tmp_path / "grid")] == [False, True]


def test_one_coordinator_at_a_time(tmp_path):
    folder = tmp_path / "grid"
    refused = pytest.raises(DatabaseError, match=f"is being run by process {os.getpid()}; wait for it")
    with held(folder), refused, held(folder):
        pass
    with held(folder):
        pass
    assert list(folder.iterdir()) == []


def test_a_folder_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "grid").write_text("")
    with pytest.raises(Exception, match="give another --folder"), held(tmp_path / "grid"):
        pass


def test_a_folder_that_cannot_be_written_to_is_refused_in_one_line(tmp_path, monkeypatch):
    """Root may write anywhere but to a file system for reading only, so the system's answer is put in its mouth."""
    folder = tmp_path / "grid"
    monkeypatch.setattr(os, "access", lambda path, mode: not (path == folder and mode & os.W_OK))
    with pytest.raises(OutputError) as caught, held(folder):
        pass
    assert str(caught.value) == (
        f"campaign folder {str(folder)!r}: cannot be written to; give another --folder, or look only, with --status"
    )
