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
from render.labels.causes import HOLES, LEGEND, Cause, members
from render.labels.outcome import LEAST_FALSE
from render.world.bsdf import is_diffuse
from render.world.rig import CAMERA_MODELS
from studies.base.atomic_file import write_atomically
from studies.base.console import say, say_json
from studies.base.flags import parse
from studies.base.output_errors import output_errors
from studies.base.reading import MALFORMED
from studies.dataset.format.finished_scenes import Gathered, gather_scenes
from studies.dataset.format.folders import existing_dataset
from studies.dataset.format.reader import Dataset, DatasetView
from studies.dataset.format.statistics import BIN_DEG, FALSE_DEPTH
from studies.drawing.stacked_figure import StackedRow, stacked_figure
from studies.drawing.templates import environment, page_style
from studies.store.images import MM, coloured_depth, data_uri, photo_uri

_PROGRAM = "franbv dataset show"
_HELP = "Make a contact sheet (HTML) and statistics of a dataset: hole causes by material and angle."
MOST_MATERIALS = 40
"""Bars of the figure (choice: a page long)."""
FEWEST_PIXELS = 100
"""Below this many a share is not told (choice: its standard error would exceed 5 %)."""
PIECES = (*HOLES, *FALSE_DEPTH)
"""Labels of pictures and bars, in one legend."""


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
    command = parse(ShowCommand, args, _PROGRAM, _HELP)
    if command.views < 1:
        raise InputError(f"--views {command.views}: give 1 or more")
    root = existing_dataset(command.dir).resolve()
    out = command.out or root.with_name(f"{root.name}.html")
    if out.resolve().is_relative_to(root):
        raise InputError(f"{out}: lies in the dataset, which holds nothing but itself; choose another --out")
    try:
        page = page_html(root, command.views)
    except MALFORMED as error:
        words = " ".join(str(error).split())
        raise InputError(f"{root}: cannot be read ({words}); run `franbv dataset check {root}`") from error
    with output_errors(out.parent):
        write_atomically(out, page.encode())
    figures = headline(gather_scenes(root))
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
        **{f"image_{name}": share for name, share in _image_shares(data).items()},
    }


def _image_shares(data: Gathered) -> dict[str, float]:
    """The same shares of all pixels."""
    counts, whole = data.counts, max(data.counts.pixels(everywhere=True), 1)
    labels = {
        "hole_share": HOLES,
        "false_share": FALSE_DEPTH,
        "reflection_share": members("reflection"),
        "unexplained_share": [Cause.UNEXPLAINED],
    }
    return {name: counts.pixels(labels=kinds, everywhere=True) / whole for name, kinds in labels.items()}


def page_html(root: Path, n_shown: int) -> str:
    """The whole page."""
    data, dataset = gather_scenes(root), Dataset(root)
    shown = np.unique(np.linspace(0, len(dataset) - 1, min(n_shown, len(dataset))).round().astype(int)).tolist()
    return (
        environment("studies.dataset.show")
        .get_template("dataset.html.j2")
        .render(
            title=data.config.title,
            camera=CAMERA_MODELS[data.config.camera.model].title,
            seed=data.config.seed,
            views=data.views,
            lead=_lead(data),
            tiles=list(_tiles(headline(data))),
            legend=[(words(cause), css(LEGEND[cause].colour), LEGEND[cause].meaning) for cause in PIECES],
            rows=[sheet_row(dataset[index]) for index in shown],
            by_material=material_figure(data),
            by_angle=angle_figure(data),
            bins=[f"{BIN_DEG * k} to {BIN_DEG * (k + 1)} deg" for k in range(90 // BIN_DEG)],
            by_both=list(material_rows(data)),
            fewest=FEWEST_PIXELS,
            least_false=f"{MM * LEAST_FALSE:g}",
            style=page_style(),
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
    for key, name in (
        ("hole_share", "without depth"),
        ("reflection_share", "lost to reflection"),
        ("false_share", "false depth"),
        ("unexplained_share", "unexplained"),
    ):
        everywhere = f"of the objects' pixels; {100 * figures[f'image_{key}']:.1f} % of all pixels"
        yield f"{100 * figures[key]:.1f} %", name, everywhere


def sheet_row(view: DatasetView) -> dict[str, Any]:
    """One view: words and pictures."""
    depth, true, draw = view.depth, view.depth_true, view.draw
    drawn = draw["views"][view.number]
    on_object = view.masks().any(axis=0)
    reach = true[on_object] if on_object.any() else true[true > 0]
    near, far = (float(x) for x in np.percentile(reach, [0, 100])) if reach.size else (0.2, 1.0)
    far += 0.3 * (far - near) + 0.02  # so that the table around is not all dark
    objects = ", ".join(f"{thing['object']} ({made_of(thing['material'])})" for thing in draw["objects"])
    return {
        "name": f"Scene {int(view.folder.name)}, view {view.number}",
        "words": f"{objects}; lamps: {draw['lamps']}; laser {draw['laser_mw']:.0f} mW; from "
        f"{drawn['elevation_deg']:.0f} deg above the table, {MM * drawn['distance_m']:.0f} mm away. Colours of depth: "
        f"{MM * near:.0f} mm bright, {MM * far:.0f} mm and beyond dark.",
        "pictures": [
            ("Left infrared image", photo_uri(view.gray)),
            ("Depth", data_uri(coloured_depth(depth, near, far))),
            ("True depth", data_uri(coloured_depth(true, near, far))),
            ("Causes", data_uri(cause_picture(view))),
            ("Incidence", photo_uri(incidence_picture(view))),
        ],
    }


def made_of(name: str) -> str:
    """A drawn material for people: `brass:brushed@alpha=0.0512,0.2034` is "brass:brushed, alpha 0.051 and 0.2"."""
    known_as, _, alphas = name.partition("@alpha=")
    if not alphas:
        return known_as
    return f"{known_as}, alpha " + " and ".join(f"{float(alpha):.2g}" for alpha in alphas.split(","))


def cause_picture(view: DatasetView) -> UInt8[np.ndarray, "h w 3"]:
    """Label map in the legend's colours, over the infrared image where depth is right."""
    label = np.where(view.false_depth > 0, view.false_depth, view.cause)
    colours = np.zeros((256, 3), np.uint8)
    for cause, entry in LEGEND.items():
        colours[cause] = entry.colour
    faint = np.repeat((view.gray // 2)[..., None], 3, axis=-1)
    return np.where((label == 0)[..., None], faint, colours[label])


def incidence_picture(view: DatasetView) -> UInt8[np.ndarray, "h w"]:
    """White at 0 deg, dark at 90, black for nothing."""
    return np.nan_to_num(255 * (1 - view.incidence / (np.pi / 2)), nan=0.0).clip(0, 255).astype(np.uint8)


def words(cause: Cause) -> str:
    """Its name for people."""
    return LEGEND[cause].name.replace("_", " ")


def material_rows(data: Gathered) -> Iterable[tuple[str, list[tuple[str, str]]]]:
    """Of each material: share of its objects' pixels without depth in each bin of incidence, and a colour for it."""
    for number in data.counts.materials()[:MOST_MATERIALS]:
        cells = []
        for k in range(90 // BIN_DEG):
            whole = data.counts.pixels(material=number, angle=k)
            share = data.counts.pixels(material=number, angle=k, labels=HOLES) / max(whole, 1)
            told = whole >= FEWEST_PIXELS
            cells.append((f"{100 * share:.0f} %" if told else "", f"rgba(200, 69, 59, {0.75 * share * told:.2f})"))
        yield data.materials[number - 1], cells


def material_figure(data: Gathered) -> Markup:
    """One bar for each material."""
    numbers = data.counts.materials()[:MOST_MATERIALS]
    rows = [_row(data, data.materials[number - 1], [number], None) for number in numbers]
    return stacked_figure("Missing and false depth by material", rows, "share of pixels [%]", "px")


def angle_figure(data: Gathered) -> Markup:
    """One bar for each bin of incidence, over all materials that are not matte."""
    user = data.config.materials.of_user
    numbers = [n for n in data.counts.materials() if not is_diffuse(material(data.materials[n - 1], user))]
    rows = [
        _row(data, f"{BIN_DEG * k} to {BIN_DEG * (k + 1)} deg", numbers, k) for k in range(90 // BIN_DEG)
    ]  # fmt: skip
    return stacked_figure("Missing and false depth by angle of incidence", rows, "share of pixels [%]", "px")


def _row(data: Gathered, name: str, numbers: list[int], angle: int | None) -> StackedRow:
    def count(labels: Iterable[int] | None = None) -> int:
        return sum(data.counts.pixels(material=number, angle=angle, labels=labels) for number in numbers)

    whole = count()
    pieces = [(words(cause), css(LEGEND[cause].colour), count([cause]) / max(whole, 1)) for cause in PIECES]
    return StackedRow(name, whole, pieces)


def css(colour: tuple[int, int, int]) -> str:
    """A colour of the legend."""
    return "#{:02x}{:02x}{:02x}".format(*colour)
