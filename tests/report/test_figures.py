import re
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from importlib import resources

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.errors import OutputError
from pareto_monoped.report.figures import (
    _along,
    _convergence,
    _links,
    _map,
    _states,
    _states_data,
    write_figures,
    write_map_figure,
)
from pareto_monoped.report.front_figure import JOINTS, STYLES, front_figure
from pareto_monoped.report.packing import unpacked
from tests.lazily import Lazily

matplotlib, agg = Lazily("matplotlib"), Lazily("matplotlib.backends.backend_agg")
mpl = Lazily("matplotlib.figure")

NAMES = ("front", "convergence", "along_the_front", "mass_over_ratio", "link_mass", "states_over_time")


@pytest.fixture(scope="module")
def figures(payload, tmp_path_factory):
    folder = tmp_path_factory.mktemp("figures") / "new"
    return write_figures(payload, folder)


def test_every_figure_comes_as_svg_and_png(figures):
    assert sorted(path.name for path in figures) == sorted(
        f"{name}.{kind}" for name in NAMES for kind in ("svg", "png")
    )
    for path in figures:
        head = path.read_bytes()[:8]
        assert head == b"\x89PNG\r\n\x1a\n" if path.suffix == ".png" else head.startswith(b"<?xml")


def test_svg_has_readable_text_and_the_width_of_a_column(figures):
    (path,) = (path for path in figures if path.name == "front.svg")
    root = ElementTree.parse(path).getroot()
    assert root.get("width") == "252pt"  # 3.5 in
    words = {node.text for node in root.iter("{http://www.w3.org/2000/svg}text")}
    assert {"energy (J)", "height (m)", "nominal", "paper, published"} <= words


def test_the_legend_of_the_front_lies_within_the_figure(payload):
    """It was cut off at the right for two studies with long names."""
    names = ("case_c by mechanical energy", "case_c by battery energy")
    long = tuple(replace(payload.studies[0], label=name) for name in names)
    figure = mpl.Figure(figsize=(3.5, 2.6), layout="constrained")
    with matplotlib.rc_context({"legend.fontsize": 7.0}):
        assert front_figure(replace(payload, studies=long), figure)
    agg.FigureCanvasAgg(figure).draw()
    legends = [*figure.legends, *(axes.get_legend() for axes in figure.axes if axes.get_legend())]
    for legend in legends:
        box = legend.get_window_extent()
        assert box.x0 >= 0.0
        assert box.x1 <= figure.bbox.x1
        assert box.y1 <= figure.bbox.y1 + 1.0


@pytest.fixture
def front_axes(payload):
    figure = mpl.Figure()
    assert front_figure(payload, figure)
    (axes,) = figure.axes
    return axes


def test_the_front_figure_shows_front_cases_and_floor(front_axes, payload, data):
    lines = {line.get_label(): np.column_stack(line.get_data()) for line in front_axes.lines}
    (card,) = payload.studies
    np.testing.assert_allclose(lines[card.label], data.front()[["energy_j", "height_m"]], rtol=1e-4)
    np.testing.assert_allclose(lines["paper, simulated here"], [(c.energy_j, c.height_m) for c in card.cases])
    published = [(case.energy_j, case.height_m) for case in PAPER_CASES.values()]
    np.testing.assert_allclose(lines["paper, published"], published)
    energies, heights = lines["physical floor"].T
    np.testing.assert_allclose(energies, np.interp(heights, payload.constants.floor_heights_m, card.floor_j))
    assert energies[0] == 0.0
    assert energies[1] > 0.0
    assert energies[-1] > front_axes.get_xlim()[1]
    dominated = front_axes.collections[0].get_offsets()
    assert len(dominated) == card.counts["feasible"] - len(card.front)


def test_the_front_figure_begins_at_the_start_height_and_holds_every_mark(front_axes, payload):
    (card,) = payload.studies
    energies = [card.trials.columns["energy_j"][row] for row in card.front]
    heights = [card.trials.columns["height_m"][row] for row in card.front]
    energies += [case.energy_j for case in (*card.cases, *PAPER_CASES.values())]
    heights += [case.height_m for case in (*card.cases, *PAPER_CASES.values())]
    assert front_axes.get_xlim() == pytest.approx((0.0, 1.06 * max(energies)))
    assert front_axes.get_ylim() == pytest.approx((0.5, max(heights) + 0.06))


def test_the_floor_is_the_least_of_all_studies(payload):
    (card,) = payload.studies
    figure = mpl.Figure()
    lower = [max(energy - 1.0, 0.0) for energy in card.floor_j]
    front_figure(replace(payload, studies=[card, replace(card, floor_j=lower), replace(card, floor_j=[])]), figure)
    (floor,) = (line for line in figure.axes[0].lines if line.get_label().startswith("physical"))
    energies, heights = floor.get_data()
    np.testing.assert_allclose(energies, np.interp(heights, payload.constants.floor_heights_m, lower))


def test_states_over_time_are_those_of_the_knees_jump(payload):
    (card,) = payload.studies
    row = card.picks[0].row
    assert {card.trials.trial[one.row] for one in card.picks} <= set(card.jumps.keys)  # also one behind the front
    data = _states_data(card, row)
    figure = mpl.Figure()
    _states(payload, figure)
    columns = [
        ("hip_motor_torque_n_m", "knee_motor_torque_n_m"),
        ("hip_rad_per_s", "knee_rad_per_s"),
        ("base_z_m", "foot_z_m"),
    ]
    for axes, names in zip(figure.axes, columns, strict=True):
        assert data["lift_off_s"] in [line.get_xdata()[0] for line in axes.lines if len(line.get_xdata()) == 2]
        for line, name in zip(axes.lines, names, strict=False):
            np.testing.assert_allclose(line.get_xdata(), data["time_s"])
            np.testing.assert_allclose(line.get_ydata(), data[name])
    trial = card.trials.trial[row]
    base = unpacked(card.jumps, trial)["base_z_m"].max()
    assert base == pytest.approx(card.trials.columns["height_m"][row], abs=1e-3)


def test_the_torques_stand_between_the_limits_of_their_gearboxes_in_the_pages_colours(payload):
    (card,) = payload.studies
    row = card.picks[0].row
    figure = mpl.Figure()
    _states(payload, figure)
    torques = figure.axes[0]
    for joint, line in zip(("hip", "knee"), torques.lines, strict=False):
        gearbox = payload.gearboxes[card.trials.columns[f"{joint}_gearbox"][row]]
        same = [one for one in torques.lines if one.get_color() == line.get_color() and one.get_linestyle() == ":"]
        assert sorted(one.get_ydata()[0] for one in same) == [-gearbox.peak_torque_n_m, gearbox.peak_torque_n_m]
        assert np.abs(line.get_ydata()).max() <= gearbox.peak_torque_n_m * 1.01


@pytest.mark.long
def test_no_legend_covers_data(both):
    for make in (front_figure, _links, _states, _map, _convergence, _along):
        figure = mpl.Figure(figsize=(3.5, 2.6), layout="constrained")
        assert make(both, figure)
        canvas = agg.FigureCanvasAgg(figure)
        canvas.draw()
        renderer = canvas.get_renderer()
        legends = [legend for legend in (*figure.legends, *(axes.get_legend() for axes in figure.axes)) if legend]
        assert legends, make.__name__
        for legend in legends:
            box = legend.get_window_extent(renderer)
            for axes in figure.axes:
                inside = axes.get_window_extent(renderer)
                assert box.y0 >= inside.y1 - 1.0 or not box.overlaps(inside), make.__name__


def test_colours_are_the_pages():
    style = (resources.files("pareto_monoped.report") / "assets" / "style.css").read_text(encoding="utf-8")
    light = style[: style.index("@media")]
    page = dict(re.findall(r"--(\w+): (#\w+);", light))
    assert [tint for tint, _ in STYLES] == [page[f"c{i}"] for i in range(len(STYLES))]
    assert {joint: page[joint] for joint in JOINTS} == JOINTS


def test_variables_along_the_front_are_in_their_shown_units(payload, data):
    figure = mpl.Figure()
    _along(payload, figure)
    thigh = figure.axes[0].lines[0]
    np.testing.assert_allclose(thigh.get_ydata(), 1000.0 * data.front()["thigh_length_m"], rtol=1e-4)
    np.testing.assert_allclose(thigh.get_xdata(), data.front()["height_m"], rtol=1e-4)


def test_more_than_eight_variables_have_a_third_row(payload):
    """Two studies that free ten variables together ended with matplotlib's own error."""
    figure = mpl.Figure()
    many = replace(payload, variables=[*payload.variables, *payload.variables][:10])
    _along(many, figure)
    places = [axes.get_subplotspec().get_geometry() for axes in figure.axes]
    assert [(rows, columns, first) for rows, columns, first, _ in places] == [(3, 4, k) for k in range(10)]


def test_link_masses_have_a_line_per_motor(both):
    figure = mpl.Figure()
    _links(both, figure)
    labels = [line.get_label() for line in figure.axes[0].lines]
    assert labels == ["thigh, VT8020", "shank, VT8020", "thigh, U12", "shank, U12"]


@pytest.mark.long
def test_the_same_study_gives_the_same_bytes(figures, payload, tmp_path):
    again = {path.name: path.read_bytes() for path in write_figures(payload, tmp_path)}
    assert again == {path.name: path.read_bytes() for path in figures}


def test_a_folder_that_cannot_be_made_is_refused(payload, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be made"):
        write_figures(payload, tmp_path / "file" / "folder")


SVG = "{http://www.w3.org/2000/svg}"


def drawn(path):
    """Words in a figure, and the number of markers."""
    root = ElementTree.parse(path).getroot()
    words = {node.text.strip() for node in root.iter(f"{SVG}text") if node.text}
    return words, sum(1 for _ in root.iter(f"{SVG}use"))


def test_the_figure_of_a_map_has_a_point_for_every_gearbox_of_either_family(tmp_path):
    found = map_for("VT8020")
    write_map_figure({"": found}, tmp_path / "map.svg")
    words, markers = drawn(tmp_path / "map.svg")
    assert {"VT8020", "ISSPG", "ESSPG", "gear ratio", "actuator mass (kg)"} <= words
    points = sum(int(np.isfinite(found.masses_kg(family)).sum()) for family in ("ISSPG", "ESSPG"))
    ticks = sum(1 for word in words if word.replace(".", "").isdigit())
    assert markers == points + 2 + ticks  # the legend has one marker for each family, the axes one for each tick


def test_two_maps_of_a_motor_lie_over_each_other(tmp_path):
    found = map_for("VT8020")
    write_map_figure({"paper": found, "ISO 6336": map_for("VT8020", "iso6336")}, tmp_path / "maps.svg")
    words, _ = drawn(tmp_path / "maps.svg")
    assert {"ISSPG, paper", "ESSPG, paper", "ISSPG, ISO 6336", "ESSPG, ISO 6336"} <= words
    assert "VT8020" in words


def test_a_motor_of_one_family_has_no_entry_for_the_other(tmp_path):
    write_map_figure({"": map_for("MAD_M6C12")}, tmp_path / "map.svg")
    words, _ = drawn(tmp_path / "map.svg")
    assert "ESSPG" in words
    assert "ISSPG" not in words


def test_the_same_map_gives_the_same_bytes(tmp_path):
    for name in ("a.svg", "b.svg"):
        write_map_figure({"": map_for("VT8020")}, tmp_path / name)
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


@pytest.mark.parametrize("objectives", [("drift_m", "energy_j"), ("energy_j", "drift_m")])
def test_the_papers_designs_stand_in_the_units_that_axes_show(payload, objectives):
    """A drift is shown in millimetres; with either scale in place of the other, they would lie far from the front."""
    (card,), figure = payload.studies, mpl.Figure()
    trials = replace(card.trials, columns={**card.trials.columns, "drift_m": card.trials.columns["energy_j"]})
    front_figure(replace(payload, objectives=objectives, studies=[replace(card, trials=trials)]), figure)
    (axes,) = figure.axes
    lines = {line.get_label(): np.column_stack(line.get_data()) for line in axes.lines}
    expected = [(case.energy_j, 1000.0 * case.measures["drift_m"]) for case in card.cases]
    expected = expected if objectives[0] == "drift_m" else [pair[::-1] for pair in expected]
    np.testing.assert_allclose(lines["paper, simulated here"], expected)
