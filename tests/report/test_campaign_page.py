"""The page of a campaign: its tables as text, its charts in headless Chromium without a network."""

import re
from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.campaign.page import campaign_page
from tests.campaign.support import content_of, made_campaign

AXES = 'motors = ["U8", "U10"]\nrules = ["iso6336", "paper"]\nseeds = [1, 2, 3]'


def fronts(number, place):
    """Fronts that differ; one study is missing and one has no feasible design."""
    if place.name == "U10_paper_seed3":
        return None
    if place.name == "U10_paper_seed2":
        return [0.3], [5.0]
    return [0.7, 0.85, 1.0], [10.0 + number, 20.0 + number, 30.0 + 2 * number]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    campaign, results = made_campaign(folder, AXES, fronts)
    file = folder / "page.html"
    file.write_text(campaign_page(campaign, results), encoding="utf-8")
    return file, results


def cells(text, title):
    """Rows of the table under a heading, as lists of texts."""
    table = text.split(f"<h3>{title}</h3>")[1].split("</table>")[0]
    rows = re.findall(r"<tr>(.*?)</tr>", table.split("<tbody>")[1], re.S)
    return [[re.sub(r"<small>|<[^>]+>", " ", cell).split() for cell in re.split(r"</t[hd]>", row)][:-1] for row in rows]


def test_tables_have_a_row_per_group_per_value_and_per_seed(made):
    text = made[0].read_text()
    groups = cells(text, "By motor and gearbox rules")
    assert [(" ".join(row[0]), row[1]) for row in groups] == [
        ("U8, iso6336", ["3"]), ("U8, paper", ["3"]), ("U10, iso6336", ["3"]), ("U10, paper", ["1"]),
    ]  # fmt: skip
    # U8, iso6336 are the first three studies: 10, 11 and 12 J at 0.7 m.
    at_0_7_m = next(cell for cell in groups[0] if cell[:1] == ["11.00"])
    assert at_0_7_m == ["11.00", "10.00", "to", "12.00"]
    assert [row[0] for row in cells(text, "By motor alone")] == [["U8"], ["U10"]]
    assert [(row[0], row[1]) for row in cells(text, "By seed")] == [(["1"], ["4"]), (["2"], ["3"]), (["3"], ["3"])]


def test_what_is_in_no_median_is_said_and_names_are_escaped(made):
    text = made[0].read_text()
    assert "U10_paper_seed2 failed: no feasible design" in text
    assert "1 study is not finished and in no median: U10_paper_seed3" in text
    assert "of an even number, one of the middle two" not in text
    assert "made &lt;b&gt;" in text
    assert "made <b>" not in text


def test_a_campaign_without_a_finished_study_has_a_page(tmp_path):
    campaign, results = made_campaign(tmp_path, AXES, lambda *_: None)
    page = campaign_page(campaign, results)
    assert "0 of 12 studies are finished" in page
    assert "12 studies are not finished and in no median" in page  # those that have not begun are among them


HEAD = 'name = "made"\ndescription = "links < 0.4 m <script>"\n[study]\nevaluations = 40\nstrength = false\n'


@pytest.fixture(scope="module")
def three(tmp_path_factory):
    """One group of three seeds, which need 10, 11 and 12 J at 0.7 m; the last does not get to 1.0 m."""

    def front(number, _):
        return [0.7, 1.0 - 0.1 * (number == 2)], [10.0 + number, 30.0 + number]

    campaign, results = made_campaign(tmp_path_factory.mktemp("three"), "seeds = [1, 2, 3]", front, HEAD)
    grown = [np.array([[1.0, 5.0 + n], [2.0, 20.0 + n]]) for n in range(3)]
    return campaign, [replace(result, history=grown[n]) for n, result in enumerate(results)]


def test_curves_are_medians_and_bands_at_their_levels(three):
    (section,) = content_of(campaign_page(*three))["sections"]
    assert (section["pair"], section["first"]) == (["height_m", "energy_j"], [0])
    assert (section["levels"][0], section["levels"][-1]) == (0.7, 1.0)
    (group,) = section["groups"]
    assert (group["label"], group["studies"]) == ("all", 3)
    needs = group["attainment"]
    assert [needs[side][0] for side in ("low", "median", "high")] == [10.0, 11.0, 12.0]
    assert [needs[side][-1] for side in ("low", "median", "high")] == [30.0, 31.0, None]
    assert group["evaluations"] == [1, 2]
    assert group["growth"] == {"low": [5, 20], "median": [6, 21], "high": [7, 22]}


def test_the_description_is_escaped(three):
    text = campaign_page(*three)
    assert '<p class="small">links &lt; 0.4 m &lt;script&gt;</p>' in text
    assert "0.4 m <script>" not in text


@pytest.mark.parametrize(
    ("seconds", "words"), [(39.0, "117 seconds"), (41.0, "2 minutes"), (2300.0, "115 minutes"), (2700.0, "2.2 hours")]
)
def test_the_summary_counts_jumps_that_were_made_and_their_time(three, seconds, words):
    campaign, results = three
    slow = [replace(result, stored=replace(result.stored, seconds=seconds)) for result in results]
    text = campaign_page(campaign, slow)
    assert f"3 of 3 studies are finished: 6 jumps in {words} of running time." in text


def test_studies_that_cannot_be_compared_have_sections_that_links_lead_to(tmp_path):
    axes = 'objectives = [["height_m", "energy_j"], ["height_m", "gear_safety"]]'
    text = campaign_page(*made_campaign(tmp_path, axes, lambda *_: ([0.7, 1.0], [10.0, 30.0]), HEAD))
    assert "Studies with other objectives or another calibration cannot be compared" in text
    assert set(re.findall(r'href="#(.*?)"', text)) == {"section-0", "section-1", "studies"}
    assert set(re.findall(r'<section id="(.*?)"', text)) == {"section-0", "section-1", "studies"}
    headings = re.findall(r"<figure><h3>(.*?)</h3>", text)[::2]
    assert headings == ["Least mechanical energy over height", "Most strength of the gears over height"]
    assert text.count("One study each: there are no bands.") == 2


def test_a_group_of_several_studies_has_bands_and_one_section_is_compared_with_none(three):
    text = campaign_page(*three)
    assert "bands go from what the best tenth" in text
    assert "One study each" not in text
    assert "cannot be compared" not in text


@pytest.fixture(scope="module")
def wide(tmp_path_factory):
    """Twelve groups of two studies; the later ones need less energy."""
    folder = tmp_path_factory.mktemp("wide")
    axes = 'motors = ["U8", "U10", "VT8020"]\nrules = ["iso6336", "paper"]\n'
    axes += "variables = [{ knee_ratio = 5.0 }, { knee_ratio = 6.0 }]\nseeds = [1, 2]"
    campaign, results = made_campaign(folder, axes, lambda n, _: ([0.7, 1.0], [30.0 - n / 2.0, 40.0 - n / 2.0]))
    file = folder / "wide.html"
    file.write_text(campaign_page(campaign, results), encoding="utf-8")
    return file


def test_a_median_of_two_studies_is_one_of_them_and_the_page_says_so(wide):
    text = wide.read_text()
    assert "of an even number, one of the middle two" in text
    assert content_of(text)["sections"][0]["first"] == [4, 5, 6, 7, 8, 9, 10, 11]
    first = cells(text, "By motor and gearbox rules and variables")[0]
    assert first[2][0] == first[2][1]


@pytest.mark.browser
def test_of_many_groups_the_best_are_shown_first_and_buttons_show_all_or_none(wide, browser):
    assert "The charts begin with the 8 groups of most hypervolume" in wide.read_text()
    tab = browser.new_page(viewport={"width": 1280, "height": 900})
    tab.goto(wide.as_uri())
    tab.wait_for_function("() => document.getElementById('attainment-0')?.layers !== undefined")
    lines = """document.getElementById('attainment-0').layers.filter((layer) => layer.mode === 'lines')
        .map((layer) => `${layer.line.color} ${layer.line.dash}`)"""
    boxes = tab.locator("#switches-0 input")
    assert [boxes.nth(k).is_checked() for k in range(12)] == [False] * 4 + [True] * 8
    shown = tab.evaluate(lines)
    assert len(shown) == len(set(shown)) == 8
    tab.get_by_role("button", name="All").click()
    assert len(set(tab.evaluate(lines))) == 12
    tab.get_by_role("button", name="None").click()
    assert tab.evaluate(lines) == []
    boxes.first.click()
    assert len(tab.evaluate(lines)) == 1
    tab.close()


@pytest.mark.browser
@pytest.mark.parametrize(("width", "scheme"), [pytest.param(1440, "light", marks=pytest.mark.long), (390, "dark")])
def test_charts_are_drawn_offline_and_a_group_can_be_switched_off(made, browser, width, scheme):
    file, _ = made
    context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme)
    context.set_offline(True)
    tab = context.new_page()
    complaints, requests = [], []
    tab.on("console", lambda message: complaints.append(message.text))
    tab.on("pageerror", lambda error: complaints.append(str(error)))
    tab.on("request", lambda request: requests.append(request.url))
    tab.goto(file.as_uri())
    tab.wait_for_function("() => document.getElementById('attainment-0')?.layers !== undefined")
    names = "document.getElementById('attainment-0').layers.map((layer) => layer.name)"
    assert tab.evaluate(names) == [
        "U8, iso6336, band", "U8, iso6336", "U8, paper, band", "U8, paper",
        "U10, iso6336, band", "U10, iso6336", "U10, paper",
    ]  # fmt: skip
    tab.locator("#switches-0 input").first.click()
    assert tab.evaluate(names)[0] == "U8, paper, band"
    words = "document.getElementById('attainment-0').layers.find((layer) => layer.name === 'U10, iso6336').text(0)"
    assert "mechanical energy" not in tab.evaluate(words)
    assert "band" in tab.evaluate(words)
    tab.locator("#growth-0").scroll_into_view_if_needed()
    tab.wait_for_function("() => document.getElementById('growth-0')?.layers !== undefined")
    assert tab.locator("#attainment-0 path.js-line").count() > 0
    assert tab.evaluate("document.documentElement.scrollWidth") == width
    assert complaints == []
    assert [url for url in requests if not url.startswith("data:")] == [file.as_uri()]
    context.close()
