"""`mmplan view` and `mmplan render`: plans and scenes to look at."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mmplan.commands.arguments import natural, positive
from mmplan.commands.plans import load_plan
from mmplan.commands.results import SOLVED, require_folder
from mmplan.exceptions import InputError

if TYPE_CHECKING:
    from mmplan.plan import Plan
    from mmplan.problem import Problem
    from mmplan.terminal import ProgressDisplay
    from mmplan.visualization.exhibit import Exhibit

_KINDS = (".html", ".png", ".webp", ".gif", ".mp4")
_WHAT = "a plan file (.json), a scene file, or the name of a shipped scene"
_PORT = 8080


def add(commands: Any) -> None:
    """Add the commands to the parser's."""
    text = "show a plan or a scene in the browser, on this machine alone"
    view = commands.add_parser("view", help=text, description=text)
    _add_subject(view)
    view.add_argument(
        "--port",
        type=natural,
        default=_PORT,
        help=f"the first one tried; default: {_PORT}",
    )
    view.set_defaults(run=_view)
    _add_render(commands)


def _add_render(commands: Any) -> None:
    text = "draw a plan or a scene: a page for any browser, a picture, a video"
    render = commands.add_parser("render", help=text, description=text)
    _add_subject(render)
    render.add_argument(
        "-o",
        "--output",
        type=Path,
        required=True,
        help=f"the file to write; its ending says what: {', '.join(_KINDS)}",
    )
    render.add_argument(
        "--size", type=size_in_pixels, metavar="WxH", default=(1280, 800), help="pixels"
    )
    render.add_argument(
        "--camera",
        default="auto",
        help="auto, top, start, goal, or AZIMUTH,ELEVATION[,DISTANCE[,X,Y,Z]] in "
        "degrees and metres",
    )
    render.add_argument(
        "--time",
        help="a still picture at this time, s, or at start, goal or end; several with "
        "commas, for a strip of pictures",
    )
    render.add_argument(
        "--rate", type=positive, default=15, help="pictures a second; default: 15"
    )
    render.add_argument(
        "--hide",
        default="",
        metavar="LAYERS",
        help="of ghosts, grasps, paths, reach, robot, scene, tool frame, with commas",
    )
    quiet = "no progress and no result on the terminal"
    render.add_argument("--quiet", action="store_true", help=quiet)
    render.set_defaults(run=_render)


def _add_subject(command: argparse.ArgumentParser) -> None:
    command.add_argument("subject", metavar="plan|scene", help=_WHAT)
    command.add_argument("--scene", help="the scene, if it is not where the plan says")


def _view(options: argparse.Namespace) -> int:
    show_live(load_exhibit(options.subject, options.scene), options.port)
    return SOLVED


def _render(options: argparse.Namespace) -> int:
    kind = kind_of(options.output, _KINDS)
    exhibit = load_exhibit(options.subject, options.scene)

    from mmplan.terminal import progress_display, show

    with progress_display(quiet=options.quiet) as progress:
        if kind == ".html":
            write_page_of(exhibit, options.output)
        else:
            _write_pictures(exhibit, options, progress)
    if not options.quiet:
        show(f"written to {options.output}")
    return SOLVED


def kind_of(output: Path, kinds: Sequence[str]) -> str:
    """The ending of a file that is to be drawn, one of some kinds.

    Raises:
        InputError: It is none of them, or the file's folder is not there.
    """
    kind = output.suffix.lower()
    if kind not in kinds:
        raise InputError(f"{output}: expected a name in {', '.join(kinds)}")
    require_folder(output)
    return kind


def load_exhibit(subject: str, scene: str | None = None) -> Exhibit:
    """What there is to see of a plan file or of a scene.

    Raises:
        InputError: It cannot be read, or plan and scene do not fit each other.
    """
    from mmplan.scene_file import load_problem

    if subject.lower().endswith(".json"):
        return exhibit_of(*load_plan(Path(subject), scene), subject)
    problem = load_problem(subject)

    from mmplan.visualization.exhibit import exhibit_of_scene

    return exhibit_of_scene(problem)


def exhibit_of(plan: Plan, problem: Problem, name: str) -> Exhibit:
    """What there is to see of a plan; `name` is its name in errors."""
    from mmplan.verification.structure import structure_faults
    from mmplan.visualization.exhibit import exhibit_of_plan

    faults = [f"{name}: {fault}" for fault in structure_faults(plan, problem)]
    if faults:
        raise InputError(*faults)
    return exhibit_of_plan(problem, plan)


def show_live(
    exhibit: Exhibit, port: int = _PORT, *, stdout_is_taken: bool = False
) -> None:
    """Serve the live viewer until Ctrl-C, which is how it ends well.

    Its address goes to stdout unless that is taken by other results.
    """
    try:
        from mmplan.visualization.viewer import Viewer
    except ImportError as error:
        if error.name is None or error.name.startswith("mmplan"):
            raise
        message = "the viewer needs the extra: pip install 'mmplan[view]'"
        raise InputError(f"{message}; 'mmplan render -o plan.html' does not") from error
    viewer = Viewer(exhibit, port)
    try:
        place = sys.stderr if stdout_is_taken else sys.stdout
        print(viewer.url, file=place, flush=True)
        print("open this in a browser; Ctrl-C ends", file=sys.stderr)
        viewer.run()
    except KeyboardInterrupt:
        pass
    finally:
        viewer.close()


def write_page_of(exhibit: Exhibit, output: Path) -> None:
    """Write the page of a plan, with its clearances and candidates, or of a scene."""
    from mmplan.visualization.clearance import clearance_curve
    from mmplan.visualization.page import write_page
    from mmplan.visualization.search import searches

    problem, plan = exhibit.problem, exhibit.plan
    if plan is None:
        write_page(output, exhibit)
        return
    curve = clearance_curve(problem, plan, exhibit.film)
    write_page(output, exhibit, curve, list(searches(problem, plan)))


def _write_pictures(
    exhibit: Exhibit, options: argparse.Namespace, progress: ProgressDisplay | None
) -> None:
    from mmplan.visualization.pictures import Look, moments_of, write_pictures

    times: Sequence[float] = ()
    if options.time is not None:
        times = moments_of(exhibit.film, options.time)
    layers = {part.layer for part in exhibit.parts}
    look = Look(
        size=options.size,
        camera=options.camera,
        times=tuple(times),
        rate=float(options.rate),
        hidden=frozenset(_layers(options.hide, layers)),
    )
    report = partial(progress, "pictures") if progress is not None else None
    write_pictures(options.output, exhibit, look, report)


def _layers(text: str, known: set[str]) -> list[str]:
    from mmplan.files.suggestions import unknown

    names = [name.strip() for name in text.split(",") if name.strip()]
    for name in names:
        if name not in known:
            raise InputError(f"--hide: {unknown('layer', name, tuple(sorted(known)))}")
    return names


def size_in_pixels(text: str) -> tuple[int, int]:
    """Width and height in pixels: `1280x800`."""
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise argparse.ArgumentTypeError(f"expected WIDTHxHEIGHT, got '{text}'")
    size = (int(width), int(height))
    if not all(16 <= pixels <= 4096 for pixels in size):
        raise argparse.ArgumentTypeError(f"expected 16 to 4096 pixels, got '{text}'")
    return size
