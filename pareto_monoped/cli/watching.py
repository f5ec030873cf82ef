"""What ``simulate`` shows of a jump besides numbers: a film as a file, or MuJoCo's viewer."""

import math
import os
import sys
import time
import warnings
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cli.terminal import echo
from pareto_monoped.errors import InputError

if TYPE_CHECKING:
    from pareto_monoped.actuator.ratiomap import JointMaps
    from pareto_monoped.design import Design
    from pareto_monoped.jump.calibration import Calibration

Trace = Mapping[str, NDArray[np.float64]]

_QPOS = {"slide_x": "base_x_m", "slide_z": "base_z_m", "hip": "hip_rad", "knee": "knee_rad"}
_QPOS |= {f"{joint}_motor": _QPOS[joint] for joint in ("hip", "knee")}
"""Joint of the model -> column of the trace."""
_REST_S = 1.0  # at the apex, before the viewer begins again


def require_what_shows(gif: Path | None, video: Path | None, view: bool) -> None:
    """Raise ``InputError`` for a film or a viewer that cannot be had here, before anything is simulated."""
    if gif is None and video is None and not view:
        return
    from pareto_monoped.errors import require_extra

    require_extra("cad", "CAD")
    from pareto_monoped.cad.film import require_gif, require_video

    if gif is not None:
        require_gif(gif)
    if video is not None:
        require_video(video)
    if view and sys.platform == "linux":
        _require_display()


def _require_display() -> None:
    """Refuse to view where no window can be opened; MuJoCo would end the process, and leave a log behind."""
    import glfw

    wanted = [f"{key} is {os.environ[key]!r}" for key in ("DISPLAY", "WAYLAND_DISPLAY") if os.environ.get(key)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", glfw.GLFWError)
        there = bool(wanted) and glfw.init()
        glfw.terminate()
    if not there:
        said = f"cannot be opened ({', '.join(wanted)})" if wanted else "is not set (DISPLAY, WAYLAND_DISPLAY)"
        raise InputError(f"--view: the display {said}; use --gif FILE or --video FILE")


def write_films(
    design: "Design",
    maps: "JointMaps",
    trace: Trace,
    *,
    gif: Path | None,
    video: Path | None,
    slower: float,
    force: bool,
) -> None:
    """Draw the jump once, and write it to the files that are asked for."""
    from pareto_monoped.cad.film import film, write_gif, write_video
    from pareto_monoped.robot.build import build_robot

    pictures = list(film(build_robot(design, maps), trace, slower=slower))
    for path, write in ((gif, write_gif), (video, write_video)):
        if path is not None:
            count = write(path, pictures, force=force)
            echo(f"wrote {path} ({count} pictures, {path.stat().st_size / 1e6:.1f} MB)", err=True)


def view_jump(design: "Design", maps: "JointMaps", calibration: "Calibration", trace: Trace, *, slower: float) -> None:
    """Show the recorded jump in MuJoCo's viewer, with the parts' own meshes, until its window is closed."""
    import mujoco

    from pareto_monoped.cad.export import export_design

    with TemporaryDirectory() as folder:
        target = Path(folder) / "robot"
        export_design(design, maps, calibration, target, formats=("mjcf",), source={}, strength=False)
        model = mujoco.MjModel.from_xml_path(str(next(target.rglob("monoped.xml"))))
    data = mujoco.MjData(model)
    columns = [(int(model.joint(k).qposadr[0]), _QPOS[model.joint(k).name]) for k in range(model.njnt)]
    try:
        from mujoco import viewer

        with viewer.launch_passive(model, data, show_left_ui=False, show_right_ui=False) as window:
            _look(window.cam, trace)
            echo("close the window to go on", err=True)
            _play(window, model, data, columns, trace, slower)
    except RuntimeError as error:
        raise InputError(f"--view: the viewer cannot be opened ({error}); use --gif FILE or --video FILE") from error


def _look(camera: Any, trace: Trace) -> None:
    """From the robot's right and a little from above, so far away that the whole jump is in the picture."""
    top = float(trace["base_z_m"].max()) + 0.2
    camera.lookat[:] = (float(trace["base_x_m"].mean()), 0.0, 0.5 * top)
    # MuJoCo's viewer sees 45 degrees from top to bottom unless a model says otherwise.
    camera.distance = 1.15 * 0.5 * top / math.tan(math.radians(22.5))
    camera.azimuth, camera.elevation = 110.0, -8.0


def _play(window: Any, model: Any, data: Any, columns: list[tuple[int, str]], trace: Trace, slower: float) -> None:
    import mujoco

    times = trace["time_s"]
    began = time.monotonic()
    while window.is_running():
        at = (time.monotonic() - began) / slower
        if at > times[-1] + _REST_S / slower:
            began = time.monotonic()
            continue
        row = min(int(np.searchsorted(times, at)), len(times) - 1)
        for place, column in columns:
            data.qpos[place] = trace[column][row]
        mujoco.mj_forward(model, data)
        window.sync()
        time.sleep(1.0 / 60.0)
