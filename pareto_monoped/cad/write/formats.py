"""The formats that an export can write, and the files that each of them makes."""

from collections.abc import Mapping, Sequence

from pareto_monoped.errors import InputError, complaint, unknown_name

FILES: Mapping[str, tuple[tuple[str, str], ...]] = {
    "step": (
        ("assembly.step", "the whole robot for any CAD program: named, coloured parts, mm"),
        ("parts/step/", "each part for machining or changing"),
    ),
    "stl": (("parts/stl/", "each part as triangles, mm"),),
    "3mf": (("print/", "the 3D-printed parts for the slicer, mm, lying as they are printed"),),
    "dxf": (
        (
            "laser/",
            "the plates for the laser cutter: true outline without kerf on the layer CUT, mm; NOTES says what follows",
        ),
        ("test_stand/", "two arms that hang the base on vertical rails, and how they are used, mm"),
    ),
    "glb": (("assembly.glb", "the robot to look at in a browser or viewer, m"),),
    "mjcf": (
        ("model/monoped.xml", "MuJoCo model that makes the simulated jump, with meshes and colliders, SI units"),
        ("model/jump.json", "every number that the jump needs besides the model: motors, controller, losses, SI units"),
        ("model/replay.py", "makes the jump again with MuJoCo and NumPy alone: `python model/replay.py`"),
    ),
    "urdf": (("model/monoped.urdf", "the same robot for other simulators, SI units"),),
    "pdf": (
        (
            "drawings/assembly.pdf",
            "the robot with sections and the list of items, its units pulled apart, with balloons, and its cables",
        ),
        ("drawings/", "a workshop drawing of each part that is made: dimensions, fits, tolerances, gear data"),
    ),
    "assembly": (
        (
            "assembly/index.html",
            "how the robot is put together: steps, torques, chain, cables, printing, casting",
        ),
        ("assembly/hardware.csv", "what is bought: designations, standards, counts, lengths of cables"),
        ("assembly/cables.csv", "where the cables run: every corner, bend radius, cut length, ties"),
        ("assembly/", "the pictures of the steps, and the mould for the foot"),
    ),
    "png": (
        ("assembly.png", "the robot in its start pose"),
        ("exploded.png", "the robot pulled apart along the joints' axis"),
        ("hip_actuator_section.png", "the hip actuator cut along its axis, with numbers and names of its parts"),
        ("knee_actuator_section.png", "the knee actuator, likewise"),
        ("knee_joint_section.png", "the knee joint, likewise"),
    ),
}
"""Per format: path and purpose of each file, or of each folder of files (path with a slash at its end)."""

RECORD = "design.json"
"""Name of the file that lists all files of an export; it is written last."""
ALWAYS = (
    "README.md",
    "bom.csv",
    "strength.csv",
    "parameters.csv",
    "monoped_equations.txt",
    "checks.json",
    RECORD,
)
"""Files of every export."""

FORMATS = tuple(FILES)
"""All formats, in the order in which they are listed; an export writes all of them by default."""


def chosen_formats(names: Sequence[str] | None) -> tuple[str, ...]:
    """The formats asked for, in the order of ``FORMATS``; all of them for None.

    Raises:
        InputError: an unknown name.
    """
    if names is None:
        return FORMATS
    if isinstance(names, str) or not isinstance(names, Sequence):
        raise InputError(complaint("formats", names, "a list of formats, such as ['step']", "give one"))
    for name in names:
        if name not in FORMATS:
            raise InputError(unknown_name("format", name, FORMATS))
    return tuple(name for name in FORMATS if name in names)
