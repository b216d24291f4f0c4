"""`franbv dataset show`: a contact sheet of the views and statistics of holes by material and angle, one HTML file."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tyro
from jaxtyping import UInt8
from markupsafe import Markup

from materials.catalog import material
from materials.input_error import InputError
from render.bsdf import is_diffuse
from render.causes import GROUPS, HOLES, LEGEND, Cause, members
from studies.cases import output_errors, write_atomically
from studies.command_line import parse
from studies.console import say, say_json
from studies.dataset.check_scene import UNREADABLE
from studies.dataset.folders import existing_dataset
from studies.dataset.gathered import Gathered, gather
from studies.dataset.reader import Dataset, View
from studies.dataset.statistics import BIN_DEG, FALSE_DEPTH
from studies.images import coloured_depth, data_uri, photo_uri
from studies.report.stacked_figure import StackedRow, stacked_figure
from studies.report.templates import asset, environment

PROGRAM = "franbv dataset show"
HELP = "Make a contact sheet (HTML) and statistics of a dataset: hole causes by material and angle."
MOST_MATERIALS = 40
"""Bars of the figure (choice: a page long)."""


@dataclass(frozen=True)
class ShowCommand:
    """The flags of `franbv dataset show`."""

    dir: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="DIR")]
    """Folder of the dataset."""
    out: Annotated[Path | None, tyro.conf.arg(metavar="FILE.html")] = None
    """The page; beside the folder by default, because a dataset holds nothing but itself."""
    views: Annotated[int, tyro.conf.arg(metavar="N")] = 24
    """How many views are shown."""
    json: Annotated[bool, tyro.conf.FlagCreatePairsOff] = False
    """Print one JSON object as the last line of stdout."""


def run(args: list[str]) -> int:
    """Make the page."""
    command = parse(ShowCommand, args, PROGRAM, HELP)
    if command.views < 1:
        raise InputError(f"--views {command.views}: give 1 or more")
    root = existing_dataset(command.dir).resolve()
    out = command.out or root.with_name(f"{root.name}.html")
    try:
        page = page_html(root, command.views)
    except UNREADABLE as error:
        words = " ".join(str(error).split())
        raise InputError(f"{root}: cannot be read ({words}); run `franbv dataset check {root}`") from None
    with output_errors(out.parent):
        write_atomically(out, page.encode())
    figures = headline(gather(root))
    say(f"{figures['views']} views, {100 * figures['hole_share']:.1f} % of the objects' pixels without depth: {out}")
    if command.json:
        say_json({"page": str(out), **figures})
    return 0


def headline(data: Gathered) -> dict[str, Any]:
    """The figures in short."""
    whole, counts = max(data.counts.pixels(), 1), data.counts
    return {
        "views": data.views,
        "scenes": len(data.draws),
        "hole_share": counts.pixels(labels=HOLES) / whole,
        "false_share": counts.pixels(labels=FALSE_DEPTH) / whole,
        "reflection_share": counts.pixels(labels=members("reflection")) / whole,
        "unexplained_share": counts.pixels(labels=[Cause.UNEXPLAINED]) / whole,
    }


def page_html(root: Path, n_shown: int) -> str:
    """The whole page."""
    data, dataset = gather(root), Dataset(root)
    shown = np.unique(np.linspace(0, len(dataset) - 1, min(n_shown, len(dataset))).round().astype(int)).tolist()
    return (
        environment()
        .get_template("dataset.html.j2")
        .render(
            title=data.config.title,
            seed=data.config.seed,
            views=data.views,
            lead=_lead(data),
            tiles=list(_tiles(headline(data))),
            legend=[(LEGEND[cause].name, css(LEGEND[cause].colour)) for cause in (*HOLES, *FALSE_DEPTH)],
            rows=[sheet_row(dataset[index]) for index in shown],
            groups=[(name, colour) for name, colour, _ in pieces()],
            by_material=material_figure(data),
            by_angle=angle_figure(data),
            style=Markup(asset("style.css")),
        )
    )


def _lead(data: Gathered) -> str:
    piles = sum(draw.arrangement == "pile" for draw in data.draws)
    return (
        f"{data.views} views of {len(data.draws)} scenes, {piles} of them piles. Every pixel without depth has one "
        "cause, found by changing one thing at a time and measuring again."
    )


def _tiles(figures: dict[str, Any]) -> Iterable[tuple[str, str, str]]:
    yield str(figures["views"]), "views", f"{figures['scenes']} scenes"
    for key, name, against in (
        ("hole_share", "without depth", "of the objects' pixels"),
        ("reflection_share", "lost to reflection", "of the objects' pixels"),
        ("false_share", "false depth", "of the objects' pixels"),
        ("unexplained_share", "unexplained", "of the objects' pixels"),
    ):
        yield f"{100 * figures[key]:.1f} %", name, against


def sheet_row(view: View) -> dict[str, Any]:
    """One view: words and pictures."""
    depth, true, draw = view.depth, view.depth_true, view.draw
    drawn = draw["views"][view.number]
    on_object = view.masks().any(axis=0)
    reach = true[on_object] if on_object.any() else true[true > 0]
    near, far = (float(x) for x in np.percentile(reach, [0, 100])) if reach.size else (0.2, 1.0)
    far += 0.3 * (far - near) + 0.02  # so that the table around is not all dark
    objects = ", ".join(f"{thing['object']} ({thing['material']})" for thing in draw["objects"])
    return {
        "name": f"{view.folder.name} / {view.number}",
        "words": f"{objects}; {draw['lamps']} lamps, {draw['laser_mw']:.0f} mW; {drawn['elevation_deg']:.0f} deg up, "
        f"{1000 * drawn['distance_m']:.0f} mm away",
        "pictures": [
            ("Left infrared image", photo_uri(view.gray)),
            ("Depth", data_uri(coloured_depth(depth, near, far))),
            ("True depth", data_uri(coloured_depth(true, near, far))),
            ("Causes", data_uri(cause_picture(view))),
            ("Incidence", photo_uri(incidence_picture(view))),
        ],
    }


def cause_picture(view: View) -> UInt8[np.ndarray, "h w 3"]:
    """Label map in the legend's colours, over the infrared image where depth is right."""
    label = np.where(view.false_depth > 0, view.false_depth, view.cause)
    colours = np.zeros((256, 3), np.uint8)
    for cause, entry in LEGEND.items():
        colours[cause] = entry.colour
    faint = np.repeat((view.gray // 2)[..., None], 3, axis=-1)
    return np.where((label == 0)[..., None], faint, colours[label])


def incidence_picture(view: View) -> UInt8[np.ndarray, "h w"]:
    """White at 0 deg, dark at 90, black for nothing."""
    return np.nan_to_num(255 * (1 - view.incidence / (np.pi / 2)), nan=0.0).clip(0, 255).astype(np.uint8)


def pieces() -> list[tuple[str, str, tuple[Cause, ...]]]:
    """Name, colour and labels of a bar's pieces: groups of causes, but reflection by its kinds, then false depth."""
    found: list[tuple[str, str, tuple[Cause, ...]]] = []
    for group in ("reflection", *(name for name in GROUPS if name != "reflection")):
        kinds = members(group)
        if group == "reflection":
            found += [(LEGEND[kind].name, css(LEGEND[kind].colour), (kind,)) for kind in kinds]
        else:
            found.append((group, css(LEGEND[kinds[0]].colour), kinds))
    return [*found, *((LEGEND[kind].name, css(LEGEND[kind].colour), (kind,)) for kind in FALSE_DEPTH)]


def material_figure(data: Gathered) -> Markup:
    """One bar for each material."""
    numbers = data.counts.materials()[:MOST_MATERIALS]
    rows = [_row(data, data.materials[number - 1], [number], None) for number in numbers]
    return stacked_figure("Missing and false depth by material", rows, "share of pixels [%]", "px")


def angle_figure(data: Gathered) -> Markup:
    """One bar for each bin of incidence, over all materials that are not matte."""
    numbers = [n for n in data.counts.materials() if not is_diffuse(material(data.materials[n - 1]))]
    rows = [
        _row(data, f"{BIN_DEG * k} to {BIN_DEG * (k + 1)} deg", numbers, k) for k in range(90 // BIN_DEG)
    ]  # fmt: skip
    return stacked_figure("Missing and false depth by angle of incidence", rows, "share of pixels [%]", "px")


def _row(data: Gathered, name: str, numbers: list[int], angle: int | None) -> StackedRow:
    def count(labels: Iterable[int] | None = None) -> int:
        return sum(data.counts.pixels(material=number, angle=angle, labels=labels) for number in numbers)

    whole = count()
    return StackedRow(name, whole, [(what, colour, count(labels) / max(whole, 1)) for what, colour, labels in pieces()])


def css(colour: tuple[int, int, int]) -> str:
    """A colour of the legend."""
    return "#{:02x}{:02x}{:02x}".format(*colour)
