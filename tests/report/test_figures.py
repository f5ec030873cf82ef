import xml.etree.ElementTree as ElementTree

import pytest

from pareto_monoped.errors import OutputError
from pareto_monoped.report.figures import write_figures

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


def test_the_same_study_gives_the_same_bytes(figures, payload, tmp_path):
    again = {path.name: path.read_bytes() for path in write_figures(payload, tmp_path)}
    assert again == {path.name: path.read_bytes() for path in figures}


def test_a_folder_that_cannot_be_made_is_refused(payload, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be made"):
        write_figures(payload, tmp_path / "file" / "folder")
