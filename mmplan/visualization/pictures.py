"""Pictures, strips of pictures, animations and videos of an exhibit, as files."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mmplan.atomic_file import write_whole
from mmplan.exceptions import InputError
from mmplan.visualization.camera import camera_of, sun_of
from mmplan.visualization.exhibit import Exhibit
from mmplan.visualization.film import Film, film_at, film_of_plan
from mmplan.visualization.offscreen import Image, Studio

if TYPE_CHECKING:
    from collections.abc import Callable

STILLS = (".png", ".webp")
ANIMATIONS = (".webp", ".gif", ".mp4")
# Between the pictures of a strip, px.
_GAP = 4
_COLOURS = 128  # of a GIF
_QUALITY = 80  # of WebP, up to 100


@dataclass(frozen=True)
class Look:
    """How pictures are to look.

    `times` (s) asks for still pictures, side by side; without any, a picture shows the
    middle of the motion, and a file that can move shows all of it.
    """

    size: tuple[int, int] = (1280, 800)  # px, width and height
    camera: str = "auto"
    times: tuple[float, ...] = ()
    rate: float = 15.0  # pictures a second
    hidden: frozenset[str] = frozenset()  # layers


def write_pictures(
    path: Path,
    exhibit: Exhibit,
    look: Look,
    progress: Callable[[int, int], None] | None = None,
) -> None:
    """Draw an exhibit into a file whose name says what kind it is.

    `progress` is called with the pictures done and those there are.

    Raises:
        InputError: The kind, the camera or a library is not there, or the file cannot
            be written.
    """
    kind = path.suffix.lower()
    moving = kind in ANIMATIONS and not look.times and exhibit.plan is not None
    if not moving and kind not in STILLS:
        raise InputError(f"{path}: {kind} moves; a still picture is .png or .webp")
    film = _moving_film(exhibit, look) if moving else _still_film(exhibit, look)
    pictures = _pictures(exhibit, film, look, progress)
    if not moving:
        write_whole(path, _still(_strip(list(pictures)), kind))
    elif kind == ".mp4":
        write_whole(path, _video(pictures, look))
    else:
        write_whole(path, _animation(pictures, look, kind))


def _moving_film(exhibit: Exhibit, look: Look) -> Film:
    assert exhibit.plan is not None, "only a plan moves"
    return film_of_plan(exhibit.problem, exhibit.plan, look.rate)


def _still_film(exhibit: Exhibit, look: Look) -> Film:
    if exhibit.plan is None:
        return exhibit.film
    times = np.array(look.times or (exhibit.film.duration / 2.0,))
    return film_at(exhibit.problem, exhibit.plan, times)


def _pictures(
    exhibit: Exhibit,
    film: Film,
    look: Look,
    progress: Callable[[int, int], None] | None,
) -> Iterator[Image]:
    parts = [part for part in exhibit.parts if part.layer not in look.hidden]
    width, height = look.size
    camera = camera_of(exhibit, look.camera, width / height)
    with Studio(parts, look.size, camera, sun_of(exhibit, camera)) as studio:
        for moment in range(len(film.times)):
            yield studio.picture({n: T[moment] for n, T in film.poses.items()})
            if progress is not None:
                progress(moment + 1, len(film.times))


def _strip(pictures: list[Image]) -> Image:
    """The pictures side by side."""
    gap = np.full((len(pictures[0]), _GAP, 3), 255, np.uint8)
    row = [piece for picture in pictures for piece in (gap, picture)][1:]
    return np.concatenate(row, axis=1)


def _still(picture: Image, kind: str) -> bytes:
    file = io.BytesIO()
    _pillow().fromarray(picture).save(
        file, format=kind[1:].upper(), optimize=True, quality=_QUALITY
    )
    return file.getvalue()


def _animation(pictures: Iterator[Image], look: Look, kind: str) -> bytes:
    """A WebP or GIF that repeats for ever."""
    pillow = _pillow()
    frames = [pillow.fromarray(picture) for picture in pictures]
    file = io.BytesIO()
    settings: dict[str, Any] = {"quality": _QUALITY, "method": 4}
    if kind == ".gif":
        palette = frames[0].quantize(_COLOURS)
        plain = pillow.Dither.NONE
        frames = [f.quantize(palette=palette, dither=plain) for f in frames]
        settings = {"optimize": True, "disposal": 1}
    frames[0].save(
        file,
        format=kind[1:].upper(),
        save_all=True,
        append_images=frames[1:],
        duration=round(1000.0 / look.rate),
        loop=0,
        **settings,
    )
    return file.getvalue()


def _video(pictures: Iterator[Image], look: Look) -> bytes:
    """An MP4 by ffmpeg (H.264)."""
    try:
        import imageio_ffmpeg
    except ImportError as error:
        raise InputError(
            "MP4 needs the extra: pip install 'mmplan[video]'; .webp and .gif do not"
        ) from error
    if any(pixels % 2 for pixels in look.size):
        raise InputError(f"--size: MP4 needs even numbers; got {look.size}")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "video.mp4"
        writer = imageio_ffmpeg.write_frames(
            str(path), look.size, fps=look.rate, quality=7, macro_block_size=2
        )
        writer.send(None)
        for picture in pictures:
            writer.send(np.ascontiguousarray(picture))
        writer.close()
        return path.read_bytes()


def _pillow() -> Any:
    try:
        import PIL.Image
    except ImportError as error:
        raise InputError(
            "pictures need the extra: pip install 'mmplan[render]'"
        ) from error
    return PIL.Image


def moments_of(film: Film, text: str) -> tuple[float, ...]:
    """Times (s) from a list of numbers and of names: `start`, `goal`, `end`.

    The object has been grasped at `start` and is about to be released at `goal`.

    Raises:
        InputError: It is something else, or before or after the motion.
    """
    return tuple(_moment(film, part.strip()) for part in text.split(","))


def _moment(film: Film, text: str) -> float:
    named = {"end": film.duration}
    for mark in reversed(film.marks):
        if mark.name == "grasp":
            named["start"] = mark.end
        if mark.name == "release":
            named["goal"] = mark.start
    try:
        time = named[text] if text in named else float(text)
    except ValueError:
        names = ", ".join(sorted(named))
        raise InputError(f"--time: expected seconds or {names}; got '{text}'") from None
    if not 0.0 <= time <= film.duration:
        message = f"the motion lasts from 0 to {film.duration:.2f} s; got '{text}'"
        raise InputError(f"--time: {message}")
    return time
