"""The card of a dataset, `README.md`: what it holds, how it was drawn, counts and histograms. Derived, not trusted."""

from pathlib import Path

from franbv.frames import block_centre_intrinsics
from materials.catalog import TWIN_REFLECTANCE
from render.labels.outcome import LEAST_FALSE, SIGMAS, SUBPIXEL_RMS
from render.world.rig import CAMERA_MODELS
from studies.base.atomic_file import write_atomically
from studies.dataset.card.card_tables import (
    bars,
    coverage,
    factor_block,
    grouped,
    hole_share_histogram,
    incidence_histogram,
    label_table,
    layer_table,
    material_table,
    shares_table,
)  # fmt: skip
from studies.dataset.card.factors import factors
from studies.dataset.config import Camera
from studies.dataset.format.finished_scenes import Gathered, gather_scenes
from studies.dataset.format.folders import CARD, DATASET, INDEX, MANIFEST, SCENE, SPLIT
from studies.store.images import MM


def write_card(root: Path) -> None:
    """(Re)build the card."""
    write_atomically(root / CARD, card(gather_scenes(root)).encode())


def card(data: Gathered) -> str:
    """The whole text."""
    found = factors(data)
    blocks = [
        f"# {data.config.title}",
        _lead(data),
        "## What is in it",
        layer_table(data),
        "## The camera",
        camera_facts(data),
        "## Why depth is missing, and where it is false",
        _labels(data),
        label_table(),
        shares_table(data),
        "Share of the objects' pixels without depth, by view:\n\n" + bars(hole_share_histogram(data), "views"),
        "Angle of incidence of the objects' pixels:\n\n" + bars(incidence_histogram(data), "pixels"),
        material_table(data),
        "## How to read it, and to train on it",
        _reading(),
        _advice(),
        "## What was drawn",
        "How often each level occurs, beside the share that the configuration asks for. The two differ where scenes "
        "are few, and where a choice depends on others.",
        coverage(found, sum(draw.left_out for draw in data.draws)),
        *(factor_block(factor) for factor in found),
        "## Made by",
        _origin(data),
    ]
    return "\n\n".join(blocks) + "\n"


def _lead(data: Gathered) -> str:
    n = data.config.n_frames
    frames = "one depth frame a view" if n == 1 else f"the median of {n} depth frames a view"
    return (
        f"{grouped(data.views, 'rendered views')} of {grouped(len(data.draws), 'scenes')}, {frames}: infrared pair, "
        "depth with its holes, the cause of every hole, false depth, and the truth behind every pixel. The camera is a "
        f"simulated {CAMERA_MODELS[data.config.camera.model].title}; light is traced at 850 nm from measured optical "
        "constants. Nothing was photographed. Caustics are not rendered, metals have no wear or dirt, and parts in "
        "piles rest flat, up to 2 mm above what carries them."
    )


def camera_facts(data: Gathered) -> str:
    """Sizes, intrinsics and what depth means."""
    k, lines = data.config.camera, []
    for name in sorted(name for name, weight in k.profiles.items() if weight):
        rig = k.rig(name)
        full, reduced = rig.intrinsics, block_centre_intrinsics(rig.intrinsics, k.decimation)
        lines += [
            f"- Images of {full.width} x {full.height} pixels: fx = fy = {full.fx:g}, cx = {full.cx:g}, "
            f"cy = {full.cy:g} px, pixel centres at whole numbers, no distortion; nearest measurable depth "
            f"{MM * rig.min_z:.0f} mm.",
            f"- Decimated by {k.decimation} to {reduced.width} x {reduced.height}: fx = fy = {reduced.fx:g}, "
            f"cx = {reduced.cx:g}, cy = {reduced.cy:g} px, through the middle of each block.",
        ]
    return "\n".join(
        [
            *lines,
            f"- The right imager stands {MM * CAMERA_MODELS[k.model].baseline:g} mm to the right of the left one, in "
            "parallel and with the same intrinsics; rows of the pair are aligned.",
            "- Depth is Z along the optical axis of the left imager, not the distance; x points right, y down. "
            "Whole millimetres, 0 = none.",
            f"- Stereo matcher: {k.matcher}{_preset_words(k)}.",
        ]
    )


def _preset_words(k: Camera) -> str:
    """What the camera has of its own: preset and mount."""
    preset = "" if k.preset == "default" else f", preset {k.preset}"
    return preset + (f". The camera is turned by {k.roll_deg:g} deg in its mount" if k.roll_deg else "")


def _labels(data: Gathered) -> str:
    rig = data.config.camera.rig(next(name for name, weight in sorted(data.config.camera.profiles.items()) if weight))
    sigma = MM * SUBPIXEL_RMS * 0.5**2 / rig.focal_baseline
    return (
        "Every pixel without depth has exactly one cause. It was found by changing one thing at a time in the "
        "simulation, such as making all surfaces matte, and measuring the same pose again. Depth is false where it is "
        f"off the truth by more than {MM * LEAST_FALSE:g} mm and by more than {SIGMAS:g} standard deviations of the "
        f"camera's noise, Z^2 x {SUBPIXEL_RMS:g} px / (f B), {sigma:.1f} mm at 0.5 m.\n\n"
        "A hole is called reflection where the matte twin has right depth at the pixel (the same shapes, lights and "
        f"pose, every surface that is not matte made matte with albedo {TWIN_REFLECTANCE:g}, the exposure set as for "
        "any scene), and something that is not matte lies in the matcher's window, or an over-exposure drowns it. "
        "Where the twin has no depth or a false one, the hole is given to the window, the projector's shadow, the "
        "exposure or the dots' reach: a matte surface would not be measured there either. So holes along the edges of "
        "metal are mostly not called reflection, even if metal had a part in them. Left out: second causes of a hole, "
        "how sure a label is, what flickers from frame to frame, and causes of false depth beyond whether the twin is "
        "right there. The codes of `cause/` and "
        "`false_depth/`:"
    )


def _reading() -> str:
    return (
        f"The layout is BOP's: `{SPLIT}/000000/` with `scene_camera.json`, `scene_gt.json`, `scene_gt_info.json`, "
        "`scene_gt_coco.json` (masks as COCO run lengths), `gray/`, `depth/`, `mask/`, `mask_visib/`; models in mm in "
        "`models/`. Other images lie in sibling folders under the same numbers.\n\n"
        "In Python, every image in SI units as a numpy array:\n\n"
        "```python\nimport studies.dataset\n\nview = studies.dataset.open('DIR')[0]\n"
        "view.depth, view.cause, view.incidence\n```\n\n"
        "This needs the package `franbv`, the study tool that made the dataset (`pip install .` in its source tree); "
        "any PNG and JSON reader will do without it.\n\n"
        f"`franbv dataset check DIR` verifies every byte against `{SPLIT}/*/{MANIFEST}` and `{INDEX}`, derives again "
        "what follows from the configuration and from other files, and says what it cannot."
    )  # fmt: skip


def _advice() -> str:
    return (
        "All views of a scene show the same objects on the same table under the same lamps: split by scene, never by "
        f"view, or a test has seen its answers. BOP's folder `{SPLIT}/` holds all scenes; they are independent draws, "
        "so the last fifth of their numbers is as good a test set as any. To test on metals or parts that were not "
        f"seen, split by `draw.objects` in `{SCENE}`, or make a second dataset with another seed and other weights."
    )


def _origin(data: Gathered) -> str:
    made = "\n".join(f"- {line}" for line in data.makers)
    return (
        f"{made}\n\nSeed {data.config.seed}. The whole configuration is in `{DATASET}`, every draw of a scene in its "
        f"`{SCENE}`; the same configuration and versions give the same bytes. The tool, with its parts, is under "
        "the MIT licence; CAD files of others keep their own."
    )
