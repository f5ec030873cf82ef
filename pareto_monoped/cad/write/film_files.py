"""The pictures of a film as a file: an animated GIF, or a video by ffmpeg."""

import shutil
import subprocess
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.film import FRAMES_PER_S, hold_frames
from pareto_monoped.errors import InputError, SimulationError, complaint
from pareto_monoped.extras import require_extra
from pareto_monoped.files import replacing

Image = NDArray[np.uint8]

VIDEOS = {
    ".mp4": ("mp4", ("-c:v", "libx264", "-crf", "20", "-pix_fmt", "yuv420p", "-movflags", "+faststart")),
    ".webm": ("webm", ("-c:v", "libvpx-vp9", "-crf", "30", "-b:v", "0", "-pix_fmt", "yuv420p")),
}
"""Suffix -> ffmpeg's name of the format, and the encoder. Both play in browsers; yuv420p is what all players know."""
_COLOURS = 96  # of a GIF; shading needs no more, and each bit counts


def write_gif(path: Path, pictures: Iterable[Image], *, force: bool = False) -> int:
    """Write an animated GIF that repeats; returns the number of pictures.

    Raises:
        OutputError: it cannot be written, or would replace a file of another kind.
    """
    from PIL import Image as Pillow

    frames = [Pillow.fromarray(picture) for picture in pictures]
    palette = frames[len(frames) // 2].quantize(colors=_COLOURS, dither=Pillow.Dither.NONE)
    drawn = [frame.quantize(palette=palette, dither=Pillow.Dither.NONE) for frame in frames]
    rest = 1000 // FRAMES_PER_S
    times = [rest] * (len(drawn) - 1) + [rest * hold_frames()]
    with replacing(path, force=force) as temporary:
        drawn[0].save(
            temporary, format="GIF", save_all=True, append_images=drawn[1:], duration=times, loop=0, optimize=False
        )
    return len(drawn)


def encoder() -> str:
    """The program ffmpeg: that of the system, else that of the extra ``video``.

    Raises:
        InputError: there is none.
    """
    found = shutil.which("ffmpeg")
    if found is not None:
        return found
    require_extra("video", "--video", instead="install the program ffmpeg, or use --gif")
    import imageio_ffmpeg

    program: str = imageio_ffmpeg.get_ffmpeg_exe()
    return program


def require_gif(path: Path) -> None:
    """Refuse a name that is not one of a GIF, before anything is drawn.

    Raises:
        InputError: the suffix is another one.
    """
    if path.suffix.lower() != ".gif":
        raise InputError(complaint("--gif", str(path), "a file ending in .gif", "correct the name, or use --video"))


def require_video(path: Path) -> str:
    """The encoder of a video file, before anything is drawn.

    Raises:
        InputError: the suffix is of no format that we write, or there is no encoder.
    """
    if path.suffix.lower() not in VIDEOS:
        raise InputError(complaint("--video", str(path), f"a file ending in {' or '.join(VIDEOS)}", "correct the name"))
    return encoder()


def write_video(path: Path, pictures: Iterable[Image], *, force: bool = False) -> int:
    """Write a video; returns the number of pictures.

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
    """The pictures, and the last one for a while longer."""
    last = None
    for last in pictures:
        yield last
    for _ in range(hold_frames() if last is not None else 0):
        assert last is not None
        yield last
