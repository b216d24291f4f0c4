"""Tables and histograms of a dataset's card, in Markdown."""

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from render.labels.causes import GROUPS, HOLES, LEGEND, Cause, members
from studies.dataset.card.factors import Factor
from studies.dataset.format.finished_scenes import Gathered
from studies.dataset.format.layers import MASKS, layers
from studies.dataset.format.statistics import BIN_DEG, FALSE_DEPTH

LONGEST_BAR = 40
"""Characters of the longest bar."""
ANGLES = ((0, 3), (3, 6), (6, 9))
"""Bins of incidence that the table of materials takes together."""


def layer_table(data: Gathered) -> str:
    """Folders and what a pixel in them says."""
    rows = ["| folder | a pixel says |", "|---|---|"]
    rows += [f"| `{layer.folder}/` | {layer.meaning} |" for layer in layers(data.config.n_frames)]
    rows += [
        f"| `{MASKS[0]}/` | silhouette of each object as if it were alone, 255 = object |",
        f"| `{MASKS[1]}/` | what is seen of each object, 255 = object |",
    ]
    return "\n".join(rows)


def label_table() -> str:
    """Codes of the label maps."""
    rows = ["| code | name | a pixel of this code |", "|---:|---|---|"]
    rows += [
        f"| {int(cause)} | {LEGEND[cause].name} | {LEGEND[cause].meaning} |"
        for cause in (Cause.MEASURED, *HOLES, *FALSE_DEPTH)
    ]
    return "\n".join(rows)


def shares_table(data: Gathered) -> str:
    """Hole share, its causes, false depth; of the objects and of whole images."""
    rows = [
        "| label | of the objects' pixels | of their holes | of all pixels | of all holes |",
        "|---|---:|---:|---:|---:|",
        _share_row(data, "**no depth**", HOLES, True),
    ]
    for group in GROUPS:
        kinds = members(group)
        codes = ", ".join(str(int(kind)) for kind in kinds)
        rows.append(_share_row(data, f"{group}: code{'s' if len(kinds) > 1 else ''} {codes}", kinds, True))
        rows += [_share_row(data, f"- {int(k)} {LEGEND[k].name}", [k], True) for k in kinds if len(kinds) > 1]
    rows.append(_share_row(data, "**false depth**", FALSE_DEPTH, False))
    rows += [_share_row(data, f"- {int(k)} {LEGEND[k].name}", [k], False) for k in FALSE_DEPTH]
    return "\n".join(rows)


def _share_row(data: Gathered, name: str, labels: Iterable[Cause], is_hole: bool) -> str:
    cells = []
    for everywhere in (False, True):
        found = data.counts.pixels(labels=labels, everywhere=everywhere)
        cells.append(_percent(found, data.counts.pixels(everywhere=everywhere)))
        holes = data.counts.pixels(labels=HOLES, everywhere=everywhere)
        cells.append(_percent(found, holes) if is_hole else "")
    return f"| {name} | {' | '.join(cells)} |"


def hole_share_histogram(data: Gathered) -> dict[str, int]:
    """Views by the share of holes on their objects."""
    found, _ = np.histogram(data.hole_shares, bins=10, range=(0, 1))
    return {f"{10 * k} to {10 * (k + 1)} %": int(n) for k, n in enumerate(found)}


def incidence_histogram(data: Gathered) -> dict[str, int]:
    """Pixels of the objects by angle of incidence."""
    return {f"{BIN_DEG * k} to {BIN_DEG * (k + 1)} deg": data.counts.pixels(angle=k) for k in range(90 // BIN_DEG)}


def material_table(data: Gathered) -> str:
    """Hole share of each material by angle of incidence."""
    counts = data.counts
    heads = [f"no depth, {BIN_DEG * a} to {BIN_DEG * b} deg" for a, b in ANGLES]
    lines = [
        "Share of the objects' pixels without depth by material and angle of incidence, and with false depth at all "
        "angles:\n",
        f"| material | pixels | no depth, all angles | {' | '.join(heads)} | false depth |",
        "|---|" + "---:|" * (len(ANGLES) + 3),
    ]
    for number in counts.materials():
        whole = counts.pixels(material=number)
        cells = [_percent(counts.pixels(material=number, labels=HOLES), whole)]
        for a, b in ANGLES:
            holes = sum(counts.pixels(material=number, angle=k, labels=HOLES) for k in range(a, b))
            cells.append(_percent(holes, sum(counts.pixels(material=number, angle=k) for k in range(a, b))))
        cells.append(_percent(counts.pixels(material=number, labels=FALSE_DEPTH), whole))
        lines.append(f"| {data.materials[number - 1]} | {whole:,} | {' | '.join(cells)} |")
    return "\n".join(lines)


def coverage(found: list[Factor], left_out: int) -> str:
    """Whether every declared level occurs, one line for each factor of which one does not."""
    lines = []
    for factor in (factor for factor in found if factor.missing):
        drawn, all_levels = len(factor.levels) - len(factor.missing), len(factor.levels)
        words = f"{drawn} of {all_levels} parts of its range" if factor.is_range else f"no {', '.join(factor.missing)}"
        lines.append(f"- {factor.name}: {words}")
    text = "Every declared level of every factor occurs."
    if lines:
        text = "Not everything that was declared was drawn:\n\n" + "\n".join(lines)
    if left_out:
        text += f"\n\nLeft out because no free place was found: {grouped(left_out, 'things')}, objects or clutter."
    return text


def factor_block(factor: Factor) -> str:
    """A factor's levels as bars."""
    return f"{factor.name[0].upper()}{factor.name[1:]}:\n\n" + bars(factor.levels, factor.of, factor.declared)


def bars(levels: Mapping[str, int], of: str, declared: Mapping[str, float] | None = None) -> str:
    """A histogram in text, beside each share the declared one."""
    return "```\n" + "\n".join(_bar_lines(levels, of, declared or {})) + "\n```"


def _bar_lines(levels: Mapping[str, int], of: str, declared: Mapping[str, float]) -> Iterator[str]:
    most, whole = max([*levels.values(), 1]), max(sum(levels.values()), 1)
    wide = max(map(len, levels), default=0)
    for level, count in levels.items():
        asked = f"  declared {100 * declared[level]:5.1f} %" if level in declared else ""
        bar = "#" * round(LONGEST_BAR * count / most)
        yield f"{level:<{wide}}  {bar:<{LONGEST_BAR}}  {grouped(count, of):>18}  {100 * count / whole:5.1f} %{asked}"


def grouped(number: int, of: str) -> str:
    """1 view, 2 views."""
    return f"{number:,} {of.removesuffix('s') if number == 1 else of}"


def _percent(part: int, whole: int) -> str:
    return f"{100 * part / whole:.1f} %" if whole else "-"
