"""A jump as a film, drawn without a display and written as a GIF or, by ffmpeg, as a video.

It shows the robot as it is built, with its heights and torques beside it.
"""

import shutil
import subprocess
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import Pose, body_frames, instances, shift
from pareto_monoped.cad.picture.drawing import Faces, Shown, View, draw_faces, faces_of
from pareto_monoped.cad.shape.meshes import shell_of
from pareto_monoped.errors import InputError, SimulationError, complaint, require_extra
from pareto_monoped.files import replacing
from pareto_monoped.geometry.roles import Visibility
from pareto_monoped.robot.build import Robot

Floats = NDArray[np.float64]
Image = NDArray[np.uint8]

FRAMES_PER_S = 20
"""A GIF counts hundredths of a second, so that 25 and 50 would do as well; more only makes the file larger."""
SLOWER = 6.0
"""How many times slower than the jump a film is unless asked otherwise: a jump of half a second takes three."""
_HOLD_S = 0.8  # how long the film rests at the apex before it begins again
_TOLERANCE_MM = 0.6  # of curves; a pixel is about 3 mm
_WIDTH, _HEIGHT = 320, 480
_PANELS_WIDTH = 400
_VIEW = View(towards=(-0.45, 1.0, -0.16))
_FLOOR = (0.86, 0.87, 0.89)
_MARGIN_MM = 60.0
_COLOURS = ("#0072b2", "#d55e00")  # Okabe and Ito's blue and vermilion: base and foot, hip and knee
_STILL: Floats = np.zeros(3)
_GIF_COLOURS = 96  # shading needs no more, and each bit counts
VIDEOS = {
    ".mp4": ("mp4", ("-c:v", "libx264", "-crf", "20", "-pix_fmt", "yuv420p", "-movflags", "+faststart")),
    ".webm": ("webm", ("-c:v", "libvpx-vp9", "-crf", "30", "-b:v", "0", "-pix_fmt", "yuv420p")),
}
"""Suffix -> ffmpeg's name of the format, and the encoder. Both play in browsers; yuv420p is what all players know."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Piece:
    """The triangles of one visible part in the frame of its body."""

    body: str
    points_mm: Floats
    triangles: NDArray[np.int64]
    colour: tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Moment:
    """What a picture shows of a jump: time, place of the base, joint angles."""

    time_s: float
    base_x_m: float
    base_z_m: float
    hip_rad: float
    knee_rad: float


def moments(trace: Mapping[str, Floats], *, slower: float = SLOWER) -> list[Moment]:
    """Return the moments of a trace (columns of ``jump.single.TRACE_COLUMNS``) that the film shows, the apex last."""
    time = np.asarray(trace["time_s"], dtype=np.float64)
    shown = np.arange(time[0], time[-1], 1.0 / (FRAMES_PER_S * slower))
    rows = [*np.searchsorted(time, shown).tolist(), len(time) - 1]
    names = ("time_s", "base_x_m", "base_z_m", "hip_rad", "knee_rad")
    return [Moment(**{name: float(np.asarray(trace[name])[row]) for name in names}) for row in dict.fromkeys(rows)]


def hold_frames() -> int:
    """Return how many times the last picture is repeated."""
    return round(_HOLD_S * FRAMES_PER_S)


def film(robot: Robot, trace: Mapping[str, Floats], *, slower: float = SLOWER) -> Iterator[Image]:
    """Yield the pictures of a jump, each of shape (480, 720, 3): the robot, and beside it heights and torques."""
    pieces, floor, shown = _pieces(robot), _floor(), moments(trace, slower=slower)
    frame = _frame_of_the_film(robot, shown)
    panels, places = _panels(trace)
    for moment in shown:
        seen = [
            Shown(faces=faces_of(points, piece.triangles, _VIEW.axes()), colour=piece.colour, number=0, move_mm=_STILL)
            for piece, points in _placed(robot, pieces, moment)
        ]
        faces = faces_of(floor[0], floor[1], _VIEW.axes())
        seen += [Shown(faces=one, colour=_FLOOR, number=0, move_mm=_STILL) for one in (faces, frame)]
        picture = draw_faces(seen, width=_WIDTH, height=_HEIGHT).image
        yield np.hstack((picture, _with_cursor(panels, places, moment.time_s)))


def _pieces(robot: Robot) -> list[_Piece]:
    found = []
    for one in instances(robot, Pose(hip_rad=0.0, knee_rad=0.0)):
        if one.part.visibility is not Visibility.INSIDE:
            points, triangles = shell_of(one.part, _TOLERANCE_MM)
            points = points @ one.in_body[:3, :3].T + one.in_body[:3, 3]
            colour = one.part.material.colour
            found.append(_Piece(body=one.body, points_mm=points, triangles=triangles, colour=colour))
    return found


def _placed(robot: Robot, pieces: list[_Piece], moment: Moment) -> Iterator[tuple[_Piece, Floats]]:
    """Yield every piece with its points in the world's frame, whose origin is on the floor."""
    moved = shift(1000.0 * moment.base_x_m, 0.0, 1000.0 * moment.base_z_m)
    frames = body_frames(robot, Pose(hip_rad=moment.hip_rad, knee_rad=moment.knee_rad))
    for piece in pieces:
        at = moved @ frames[piece.body]
        yield piece, piece.points_mm @ at[:3, :3].T + at[:3, 3]


def _floor() -> tuple[Floats, NDArray[np.int64]]:
    """Return a plate on which the robot stands."""
    x, y = 260.0, 160.0
    points = np.array([(a, b, c) for c in (-8.0, 0.0) for a, b in ((-x, -y), (x, -y), (x, y), (-x, y))])
    quads = ((3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
    triangles = [tri for a, b, c, d in quads for tri in ((a, b, c), (a, c, d))]
    return points, np.array(triangles, dtype=np.int64)


def _frame_of_the_film(robot: Robot, shown: list[Moment]) -> Faces:
    """Return faces without triangles, as large as the whole jump, so that all pictures have one scale and place."""
    reach = 1000.0 * (robot.design.thigh_length_m + robot.design.shank_length_m)
    top = 1000.0 * max(moment.base_z_m for moment in shown) + 160.0
    x = np.array([1000.0 * moment.base_x_m for moment in shown])
    low = np.array([x.min() - 0.5 * reach, -180.0, -_MARGIN_MM])
    high = np.array([x.max() + 0.5 * reach, 180.0, top])
    corners = np.array([[(low, high)[k][i] for i, k in enumerate(which)] for which in np.ndindex(2, 2, 2)])
    seen = corners @ _VIEW.axes().T
    box = np.stack([seen.min(axis=0), seen.max(axis=0)])
    return Faces(box_mm=box, corners_mm=np.zeros((0, 3, 3)), light=np.zeros(0))


def _panels(trace: Mapping[str, Floats]) -> tuple[Image, tuple[float, float, float, int, int]]:
    """Return curves of the whole jump; time at left and right edge, and these edges with top and bottom in pixels."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(_PANELS_WIDTH / 100.0, _HEIGHT / 100.0), dpi=100, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    upper, lower = figure.subplots(2, sharex=True)
    time = np.asarray(trace["time_s"], dtype=np.float64)
    rows = (
        (upper, "height (m)", (("base", "base_z_m"), ("foot", "foot_z_m"))),
        (lower, "motor torque (N m)", (("hip", "hip_motor_torque_n_m"), ("knee", "knee_motor_torque_n_m"))),
    )
    for axes, title, pairs in rows:
        for (name, column), colour in zip(pairs, _COLOURS, strict=True):
            axes.plot(time, trace[column], color=colour, lw=1.6, label=name)
        axes.set(ylabel=title)
        axes.grid(color="#dddddd", lw=0.5)
        axes.legend(frameon=False)
    lower.set(xlabel="time (s)", xlim=(time[0], time[-1]))
    canvas.draw()
    image = np.asarray(canvas.buffer_rgba())[..., :3].copy()
    left, right = (float(lower.transData.transform((t, 0.0))[0]) for t in (time[0], time[-1]))
    top, bottom = (round(_HEIGHT - y) for y in (upper.bbox.y1, lower.bbox.y0))
    return image, (float(time[-1] - time[0]), left, right, top, bottom)


def _with_cursor(panels: Image, places: tuple[float, float, float, int, int], time_s: float) -> Image:
    """Return the curves with a line at a moment."""
    span, left, right, top, bottom = places
    image = panels.copy()
    column = min(round(left + (right - left) * time_s / span), image.shape[1] - 1)
    image[top:bottom, column] = (60, 60, 60)
    return image


def write_gif(path: Path, pictures: Iterable[Image], *, force: bool = False) -> int:
    """Write an animated GIF that repeats, and return the number of pictures.

    Raises:
        OutputError: it cannot be written, or would replace a file of another kind.
    """
    from PIL import Image as Pillow

    frames = [Pillow.fromarray(picture) for picture in pictures]
    palette = frames[len(frames) // 2].quantize(colors=_GIF_COLOURS, dither=Pillow.Dither.NONE)
    drawn = [frame.quantize(palette=palette, dither=Pillow.Dither.NONE) for frame in frames]
    rest = 1000 // FRAMES_PER_S
    times = [rest] * (len(drawn) - 1) + [rest * hold_frames()]
    with replacing(path, force=force) as temporary:
        drawn[0].save(
            temporary, format="GIF", save_all=True, append_images=drawn[1:], duration=times, loop=0, optimize=False
        )
    return len(drawn)


def encoder() -> str:
    """Return the program ffmpeg of the system, else of the extra ``video``; ``InputError`` if there is none."""
    found = shutil.which("ffmpeg")
    if found is not None:
        return found
    require_extra("video", "--video", instead="install the program ffmpeg, or use --gif")
    import imageio_ffmpeg

    return str(imageio_ffmpeg.get_ffmpeg_exe())


def require_gif(path: Path) -> None:
    """Refuse a name that is not one of a GIF, with ``InputError``, before anything is drawn."""
    if path.suffix.lower() != ".gif":
        raise InputError(complaint("--gif", str(path), "a file ending in .gif", "correct the name, or use --video"))


def require_video(path: Path) -> str:
    """Return the encoder of a video file, before anything is drawn; ``InputError`` if it has no format or encoder."""
    if path.suffix.lower() not in VIDEOS:
        raise InputError(complaint("--video", str(path), f"a file ending in {' or '.join(VIDEOS)}", "correct the name"))
    return encoder()


def write_video(path: Path, pictures: Iterable[Image], *, force: bool = False) -> int:
    """Write a video, and return the number of pictures.

    Raises:
        InputError: see ``require_video``.
        OutputError: it cannot be written, or would replace a file of another kind.
        SimulationError: the encoder failed.
    """
    program = require_video(path)
    name, options = VIDEOS[path.suffix.lower()]
    frames = list(_held(pictures))
    height, width, _ = frames[0].shape
    given = ("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(FRAMES_PER_S), "-i", "-")
    with replacing(path, force=force) as temporary:
        command = [program, "-loglevel", "error", "-y", *given, *options, "-f", name, str(temporary)]
        done = subprocess.run(command, input=b"".join(frame.tobytes() for frame in frames), capture_output=True)
        if done.returncode:
            said = done.stderr.decode(errors="replace").strip().splitlines() or ["no message"]
            raise SimulationError(f"--video: ffmpeg failed ({said[-1]}); try another format, or --gif")
    return len(frames)


def _held(pictures: Iterable[Image]) -> Iterator[Image]:
    """Yield the pictures, and the last one for a while longer."""
    last: Image | None = None
    for last in pictures:
        yield last
    if last is not None:
        yield from [last] * hold_frames()
