"""Campaigns of made studies, for tests that no physics matters to."""

import base64
import json
import re
import zlib

from pareto_monoped.campaign.folder import places_of
from pareto_monoped.campaign.grid import load_campaign
from pareto_monoped.campaign.results import results_of
from pareto_monoped.storage.store import Store
from tests.campaign.test_grid import written
from tests.study.support import made_database, made_evaluations, made_generation


def finished(place, heights_m, energies_j, number=1):
    """Store a study whose trials have these heights and energies, all feasible, and say that it has ended."""
    place.db.parent.mkdir(exist_ok=True)
    generation = made_generation(
        place.study, 0, 0, made_evaluations(heights_m, energies_j, seed=number), state={"after": 0}
    )
    made_database(place.db, [generation], study=place.study)
    with Store(place.db, place.study) as store:
        store.set_meta({"finished": True, "stop_reason": "plateau"})


def made_campaign(folder, axes, front_of, head=None):
    """A campaign and the results of its studies; ``front_of`` gives heights and energies, or None to leave one out."""
    head = head or 'name = "made <b>"\n[study]\nevaluations = 40\nstrength = false\n'
    campaign = load_campaign(written(folder, axes, head))
    places = places_of(campaign, campaign.folder)
    for number, place in enumerate(places):
        made = front_of(number, place)
        if made is not None:
            finished(place, *made, number)
    return campaign, results_of(places)


def content_of(page):
    """What the charts of a page are drawn from."""
    length, text = re.search(r'id="payload">(\d+) (.*?)</script>', page, re.S).groups()
    return json.loads(zlib.decompress(base64.b64decode(text))[int(length) :])
