"""The card of a dataset, `README.md`: what it holds, how it was drawn, counts and histograms. Derived, not trusted."""

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from render.causes import GROUPS, HOLES, LEGEND, members
from studies.cases import write_atomically
from studies.dataset.folders import CARD, DATASET, INDEX, MANIFEST, SCENE, SPLIT
from studies.dataset.gathered import Factor, Gathered, factors, gather
from studies.dataset.layers import MASKS, layers
from studies.dataset.statistics import BIN_DEG, FALSE_DEPTH, LABEL_NAMES

BAR = 40
"""Characters of the longest bar."""


def write_card(root: Path) -> None:
    """(Re)build the card."""
    write_atomically(root / CARD, card(gather(root)).encode())


def card(data: Gathered) -> str:
    """The whole text."""
    blocks = [
        f"# {data.config.title}",
        _lead(data),
        "## What is in it",
        _contents(data),
        "## Holes and false depth on the objects",
        shares_table(data),
        "Share of the objects' pixels without depth, by view:\n\n" + bars(hole_share_histogram(data), "views"),
        "Angle of incidence of the objects' pixels:\n\n" + bars(incidence_histogram(data), "pixels"),
        material_table(data),
        "## What was drawn",
        coverage_sentence(data),
        *(factor_block(factor) for factor in factors(data) if factor.levels),
        "## How to read it",
        _reading(data),
    ]
    return "\n\n".join(blocks) + "\n"


def _lead(data: Gathered) -> str:
    c = data.config
    frames = "one depth frame a view" if c.n_frames == 1 else f"the median of {c.n_frames} depth frames a view"
    return (
        f"{data.views} rendered views of {len(data.draws)} scenes, {frames}: infrared pair, depth with its holes, the "
        "cause of every hole, false depth, and the truth behind every pixel. The camera: a simulated RealSense D435i; "
        "light is traced at 850 nm from measured optical constants. Caustics are not rendered, metals have no wear or "
        "dirt, and parts in piles rest flat, up to 2 mm above what carries them.\n\n"
        f"Seed {c.seed}. The whole configuration is in `{DATASET}`; every draw of a scene in its `{SCENE}`."
    )


def _contents(data: Gathered) -> str:
    rows = ["| folder | a pixel says |", "|---|---|"]
    rows += [f"| `{layer.folder}/` | {layer.meaning} |" for layer in layers(data.config.n_frames)]
    rows += [
        f"| `{MASKS[0]}/` | silhouette of each object as if it were alone, 255 = object |",
        f"| `{MASKS[1]}/` | what is seen of each object, 255 = object |",
    ]
    return "\n".join(rows)


def shares_table(data: Gathered) -> str:
    """Hole share, its causes, false depth."""
    counts = data.counts
    whole, holes = counts.pixels(), counts.pixels(labels=HOLES)
    lines = [
        "| label | share of the objects' pixels | share of their holes |",
        "|---|---:|---:|",
        f"| **no depth** | {_percent(holes, whole)} | 100.0 % |",
    ]
    for group in GROUPS:
        kinds = members(group)
        found = counts.pixels(labels=kinds)
        lines.append(f"| {group} | {_percent(found, whole)} | {_percent(found, holes)} |")
        if len(kinds) > 1:
            for kind in kinds:
                found = counts.pixels(labels=[kind])
                lines.append(f"| - {LEGEND[kind].name} | {_percent(found, whole)} | {_percent(found, holes)} |")
    wrong = counts.pixels(labels=FALSE_DEPTH)
    lines.append(f"| **false depth** | {_percent(wrong, whole)} | |")
    for kind in FALSE_DEPTH:
        lines.append(f"| - {LEGEND[kind].name} | {_percent(counts.pixels(labels=[kind]), whole)} | |")
    return "\n".join(lines)


def hole_share_histogram(data: Gathered) -> dict[str, int]:
    """Views by the share of holes on their objects."""
    found, _ = np.histogram(data.hole_shares, bins=10, range=(0, 1))
    return {f"{10 * k} to {10 * (k + 1)} %": int(n) for k, n in enumerate(found)}


def incidence_histogram(data: Gathered) -> dict[str, int]:
    """Pixels of the objects by angle of incidence."""
    return {f"{BIN_DEG * k} to {BIN_DEG * (k + 1)} deg": data.counts.pixels(angle=k) for k in range(90 // BIN_DEG)}


def material_table(data: Gathered) -> str:
    """Hole share of each material by angle of incidence."""
    counts, angles = data.counts, [(0, 3), (3, 6), (6, 9)]
    heads = [f"{BIN_DEG * a} to {BIN_DEG * b} deg" for a, b in angles]
    lines = [
        "Share without depth, and false, by material and angle of incidence (objects only):\n",
        "| material | pixels | no depth | " + " | ".join(heads) + " | false depth |",
        "|---|---:|---:|" + "---:|" * (len(angles) + 1),
    ]
    for number in data.counts.materials():
        whole = counts.pixels(material=number)
        cells = [_percent(counts.pixels(material=number, labels=HOLES), whole)]
        for a, b in angles:
            holes = sum(counts.pixels(material=number, angle=k, labels=HOLES) for k in range(a, b))
            cells.append(_percent(holes, sum(counts.pixels(material=number, angle=k) for k in range(a, b))))
        cells.append(_percent(counts.pixels(material=number, labels=FALSE_DEPTH), whole))
        lines.append(f"| {data.materials[number - 1]} | {whole:,} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def coverage_sentence(data: Gathered) -> str:
    """Whether every declared level occurs."""
    missing = [
        f"{factor.name}: {', '.join(factor.missing)}"
        if len(factor.missing) < len(factor.levels)
        else f"{factor.name}: none of {len(factor.levels)} levels"
        for factor in factors(data)
        if factor.missing
    ]
    left_out = sum(draw.left_out for draw in data.draws)
    words = "Every declared level of every factor occurs." if not missing else f"Never drawn: {'; '.join(missing)}."
    return f"{words} For {left_out} things no free place was found on their tables."


def factor_block(factor: Factor) -> str:
    """A factor's levels as bars."""
    return f"{factor.name[0].upper()}{factor.name[1:]}:\n\n" + bars(factor.levels, factor.of)


def bars(levels: Mapping[str, int], of: str) -> str:
    """A histogram in text."""
    return "```\n" + "\n".join(_bar_lines(levels, of)) + "\n```"


def _bar_lines(levels: Mapping[str, int], of: str) -> Iterator[str]:
    most, whole = max([*levels.values(), 1]), max(sum(levels.values()), 1)
    wide = max(map(len, levels))
    for level, count in levels.items():
        length = round(BAR * count / most)
        yield f"{level:<{wide}}  {'#' * length:<{BAR}}  {count:>10,} {of}  {100 * count / whole:5.1f} %"


def _reading(data: Gathered) -> str:
    codes = ", ".join(f"{code} {name}" for code, name in LABEL_NAMES.items())
    return (
        f"The layout is BOP's: `{SPLIT}/000000/` with `scene_camera.json`, `scene_gt.json`, `scene_gt_info.json`, "
        "`scene_gt_coco.json` (masks as COCO run lengths), `gray/`, `depth/`, `mask/`, `mask_visib/`; models in mm in "
        "`models/`. Other images lie in sibling folders under the same numbers. Labels: " + codes + ".\n\n"
        "In Python, every image in SI units as a numpy array:\n\n"
        "```python\nimport studies.dataset\n\nview = studies.dataset.open('DIR')[0]\n"
        "view.depth, view.cause, view.incidence\n```\n\n"
        f"`franbv dataset check DIR` verifies every byte against `{SPLIT}/*/{MANIFEST}` and `{INDEX}`, and every label "
        "against depth and truth."
    )  # fmt: skip


def _percent(part: int, whole: int) -> str:
    return f"{100 * part / whole:.1f} %" if whole else "-"
