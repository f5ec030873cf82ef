from dataclasses import replace
from itertools import pairwise

import pandas as pd
import pytest

from pareto_monoped.report.packing import unpacked_column
from pareto_monoped.report.tables import MOST_ROWS, designs_table, evenly


def read(text: str) -> list[pd.DataFrame]:
    """The tables as a browser without scripts shows them."""
    from html.parser import HTMLParser

    class Tables(HTMLParser):
        def __init__(self):
            super().__init__()
            self.tables, self.cell = [], None

        def handle_starttag(self, tag, attrs):
            if tag == "table":
                self.tables.append([])
            elif tag == "tr":
                self.tables[-1].append([])
            elif tag in ("th", "td"):
                self.cell = ""

        def handle_data(self, data):
            if self.cell is not None:
                self.cell += data

        def handle_endtag(self, tag):
            if tag in ("th", "td"):
                self.tables[-1][-1].append(self.cell)
                self.cell = None

    parser = Tables()
    parser.feed(text)
    return [pd.DataFrame(rows[1:], columns=rows[0]) for rows in parser.tables]


def test_the_plain_table_has_the_front_with_both_energies(payload, data):
    (table,) = read(designs_table(payload))
    front = data.front()
    front = front.iloc[evenly(list(range(len(front))), MOST_ROWS)]
    assert table["trial"].astype(int).tolist() == front["trial"].tolist()
    for name, title, scale, decimals in (
        ("height_m", "height, m", 1.0, 3),
        ("energy_j", "mechanical energy, J", 1.0, 2),
        ("electrical_energy_j", "energy from the battery, J", 1.0, 2),
        ("thigh_length_m", "thigh length, mm", 1000.0, 1),
        ("knee_ratio", "knee ratio", 1.0, 2),
    ):
        shown = table[title].astype(float).to_numpy()
        stored = scale * front[name].to_numpy()
        assert shown == pytest.approx(stored, abs=0.51 * 10.0**-decimals + 3e-5 * stored.max())


def test_a_long_front_is_shown_evenly_with_both_ends():
    rows = list(range(1000, 5000))
    chosen = evenly(rows, 60)
    assert (len(chosen), chosen[0], chosen[-1]) == (60, 1000, 4999)
    steps = [after - before for before, after in pairwise(chosen)]
    assert max(steps) - min(steps) <= 1
    assert evenly(rows[:7], 60) == rows[:7]


def test_without_a_front_there_is_a_sentence(payload):
    (card,) = payload.studies
    assert "There is no front yet" in designs_table(replace(payload, studies=[replace(card, front=[])]))


def test_each_study_has_its_table_under_its_name(both):
    payload = both
    text = designs_table(payload)
    assert [len(table) for table in read(text)] == [min(len(card.front), MOST_ROWS) for card in payload.studies]
    for card in payload.studies:
        assert f"{card.label}: {'All' if len(card.front) <= MOST_ROWS else f'{MOST_ROWS} of'} " in text


def test_packed_columns_are_read_as_they_were_written(payload, data):
    (card,) = payload.studies
    heat = data.trials["electrical_energy_j"].to_numpy()
    assert unpacked_column(card.trials.packed["electrical_energy_j"]) == pytest.approx(heat, rel=2.0**-15, nan_ok=True)
