"""Tables of a campaign's page, read with an HTML parser, against made studies whose numbers are known."""

import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from pareto_monoped.campaign import page as page_module
from pareto_monoped.campaign.page import _strip, campaign_page, write_results
from tests.campaign.support import content_of, made_campaign

AXES = 'motors = ["U8", "U10"]\nseeds = [1, 2, 3]'


class Tables(HTMLParser):
    """Tables by their heading, the row of heads first, as lists of texts."""

    def __init__(self, page):
        super().__init__()
        self.found, self.heading, self.cell = {}, None, None
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        if tag in ("h2", "h3"):
            self.heading = ""
        elif tag == "table":
            self.rows = self.found.setdefault(self.heading, [])
        elif tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.cell = []

    def handle_endtag(self, tag):
        if tag in ("td", "th"):
            self.rows[-1].append(" ".join(self.cell))
            self.cell = None

    def handle_data(self, data):
        if self.cell is not None:
            self.cell.append(data)
        elif self.heading == "":
            self.heading = data


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """U8's studies need 10, 11 and 12 J at 0.7 m, U10's 13, 14 and 15 J; each has its own time and hypervolume."""
    front = lambda number, _: ([0.7, 0.85, 1.0], [10.0 + number, 20.0 + number, 30.0 + number])  # noqa: E731
    campaign, results = made_campaign(tmp_path_factory.mktemp("page"), AXES, front)
    for n, result in enumerate(results):
        stored = replace(result.stored, seconds=10.0 * n, hypervolume=100.0 + n, reason="")
        results[n] = replace(result, stored=stored, feasible=0.1 * n)
    return campaign, results


def test_a_row_of_motors_has_medians_under_their_heads(made):
    head, *rows = Tables(campaign_page(*made)).found["By motor"]
    row = dict(zip(head, rows[0], strict=True))
    assert [one[0] for one in rows] == ["U8", "U10"]
    assert row["studies"] == "3"
    assert row["hypervolume, m J"] == "101.000 100.000 to 102.000"
    assert row["best height, m"].split()[0] == "1.000"
    assert row["knee: m, J"] == "0.700, 11.00"
    # The least energy of a design that gets at least so high.
    assert [row[f"J at {level} m"] for level in (0.7, 0.8, 0.9)] == [
        *("11.00 10.00 to 12.00", "21.00 20.00 to 22.00", "31.00 30.00 to 32.00")
    ]
    assert (row["feasible, %"], row["time, s"]) == ("10 0 to 20", "10.0 0.0 to 20.0")


def test_each_study_has_a_row_in_the_order_of_the_campaign(made):
    head, *rows = Tables(campaign_page(*made)).found["All studies"]
    assert [row[0] for row in rows] == [f"{motor}_seed{seed}" for motor in ("U8", "U10") for seed in (1, 2, 3)]
    assert dict(zip(head, rows[4], strict=True)) == {
        **{"study": "U10_seed2", "state": "finished", "jumps": "3 of 40", "feasible": "40 %", "front": "3"},
        **{"hypervolume": "104.000 m J", "time, s": "40.0"},
    }


def test_seeds_are_shares_of_the_median_of_their_motor(made):
    """Of 100, 101 and 102, and of 103, 104 and 105; of two values the lower one is the median."""
    rows = Tables(campaign_page(*made)).found["By seed"][1:]
    assert [row[:2] for row in rows] == [["1", "2"], ["2", "2"], ["3", "2"]]
    assert [row[2].split()[0] for row in rows] == [f"{100.0 * share:.2f}" for share in (100 / 101, 1.0, 105 / 104)]


def test_charts_have_five_digits_and_nothing_where_there_is_no_value(made):
    """U8's last study does not get to 1.0 m: nobody can say what the worst of the three needs there."""
    campaign, results = made
    grown = [replace(one, history=np.array([[1.0, 12345.678], [5.0, 23456.789]])) for one in results]
    grown[2] = replace(grown[2], front=grown[2].front[:2])
    (section,) = content_of(campaign_page(campaign, grown))["sections"]
    assert section["levels"][-1] == 1.0
    u8, u10 = section["groups"]
    assert u8["growth"] == {side: [12346] * 4 + [23457] for side in ("median", "low", "high")}
    assert {side: values[-1] for side, values in u8["attainment"].items()} == {"low": 30, "median": 31, "high": None}
    assert {side: values[-1] for side, values in u10["attainment"].items()} == {"low": 33, "median": 34, "high": 35}


def test_of_a_second_objective_that_is_maximised_the_most_is_told(tmp_path):
    axes = 'objectives = [["height_m", "gear_safety"]]\nseeds = [1, 2, 3]'
    campaign, results = made_campaign(tmp_path, axes, lambda *_: ([0.7, 1.0], [1.0, 1.0]))
    strong = [replace(one, front=np.array([[0.7, 4.0 + n], [1.0, 2.0 + n]])) for n, one in enumerate(results)]
    head, row = Tables(campaign_page(campaign, strong)).found["All studies"][:2]
    told = [cell.split() for name, cell in zip(head, row, strict=True) if " at " in name]
    # The median, and the band from the best to the worst of the three.
    assert [[float(word) for word in words if word != "to"] for words in told] == [[5, 6, 4], [3, 4, 2], [3, 4, 2]]


def test_dots_of_hypervolumes_lie_between_the_ends_of_their_strip():
    drawn = _strip([3.0, 13.0, 8.0], (3.0, 13.0))
    assert [float(x) for x in re.findall(r'cx="([^"]+)"', drawn)] == [6.0, 124.0, 65.0]
    assert re.findall(r'x[12]="([^"]+)"', drawn) == ["6", "124"]
    assert re.findall(r'cx="([^"]+)"', _strip([5.0], (5.0, 5.0))) == ["6.0"]


@pytest.mark.parametrize("asked", [(), ("page",), ("table",), ("page", "table")], ids="-".join)
def test_what_is_asked_for_is_written_and_nothing_else(tmp_path, monkeypatch, made, asked):
    campaign, results = made
    monkeypatch.setattr(page_module, "results_of", lambda *_: results)
    paths, wrote = {name: tmp_path / name for name in asked}, []
    write_results(campaign, [], {}, **{"page": None, "table": None} | paths, force=False, wrote=wrote.append)
    assert set(wrote) == set(tmp_path.iterdir()) == set(paths.values())
