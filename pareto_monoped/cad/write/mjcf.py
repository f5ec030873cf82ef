"""MJCF: the simulated model with visual meshes and colliders added."""

import xml.etree.ElementTree as ET
from collections.abc import Sequence

from pareto_monoped.cad.write.visuals import Collider, Visual, numbers


def mjcf_with_meshes(document: str, shown: Sequence[Visual], solid: Sequence[Collider]) -> str:
    """The simulation's MJCF with visual meshes (group 2) and colliders (group 3) added.

    The colliders meet each other but not the floor (contype and conaffinity 2). The document therefore still makes the
    very jump that was simulated, in which only the foot touches the ground.

    Args:
        document: the MJCF that the simulation compiles.
        shown: meshes, each in a file ``meshes/NAME.stl`` beside the document, in metres.
        solid: primitives.
    """
    root = ET.fromstring(document, parser=ET.XMLParser(target=ET.TreeBuilder(insert_comments=True)))
    compiler = root.find("compiler")
    assert compiler is not None
    compiler.set("meshdir", "meshes")
    asset = ET.Element("asset")
    for visual in shown:
        ET.SubElement(asset, "mesh", name=visual.name, file=f"{visual.name}.stl")
    root.insert(list(root).index(compiler) + 1, asset)
    for body in root.iter("body"):
        for visual in shown:
            if visual.body == body.get("name"):
                _add_visual(body, visual)
        for collider in solid:
            if collider.body == body.get("name"):
                _add_collider(body, collider)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def _add_visual(body: ET.Element, visual: Visual) -> None:
    ET.SubElement(
        body,
        "geom",
        name=f"{visual.name}_visual",
        type="mesh",
        mesh=visual.name,
        contype="0",
        conaffinity="0",
        group="2",
        rgba=numbers(*visual.colour, 1.0),
    )


def _add_collider(body: ET.Element, collider: Collider) -> None:
    geom = ET.SubElement(
        body,
        "geom",
        name=f"{collider.name}_collider",
        type=collider.shape,
        size=numbers(*collider.size),
        pos=numbers(*collider.position),
        contype="2",
        conaffinity="2",
        group="3",
        rgba="0.2 0.5 0.9 0.2",
    )
    if collider.shape == "cylinder":
        geom.set("zaxis", "0 1 0")
