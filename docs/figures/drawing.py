"""How the figures of docs/sensor.md look and where they are written."""

from pathlib import Path

import cv2
import matplotlib as mpl
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

mpl.use("Agg")
plt.rcParams.update({"font.size": 8, "axes.titlesize": 8, "figure.dpi": 110, "axes.spines.top": False})
plt.rcParams.update({"axes.spines.right": False, "legend.frameon": False, "image.interpolation": "nearest"})

FOLDER = Path(__file__).parent
MOST_BYTES = 150_000
"""A figure larger than this does not belong into the repository."""
INVALID = "black"
"""Colour of pixels without depth."""


def panels(columns: int, rows: int = 1, width: float = 8.4, height: float = 2.6) -> tuple[Figure, list[Axes]]:
    """A figure of `width` x `height` inches and its axes in reading order."""
    figure, axes = plt.subplots(rows, columns, figsize=(width, height), squeeze=False, layout="constrained")
    return figure, list(axes.ravel())


def show_grey(axes: Axes, image: np.ndarray, title: str, white: float = 255) -> None:
    """A grey picture without axes; `white` [unit of the image] becomes white."""
    axes.imshow(image, cmap="gray", vmin=0, vmax=white)
    axes.set_title(title)
    axes.set_axis_off()


def show_error(figure: Figure, axes: Axes, error_mm: np.ndarray, title: str, span_mm: float) -> None:
    """Depth error (NaN = no depth, black) on a scale of +- `span_mm`, red too far, blue too near."""
    colours = plt.get_cmap("coolwarm").with_extremes(bad=INVALID)
    picture = axes.imshow(np.ma.masked_invalid(error_mm), cmap=colours, vmin=-span_mm, vmax=span_mm)
    axes.set_title(title)
    axes.set_axis_off()
    figure.colorbar(picture, ax=axes, shrink=0.8, label="too far [mm]")


def write(figure: Figure, name: str) -> None:
    """Write `name`.png beside the scripts."""
    figure.canvas.draw()
    colours = np.asarray(figure.canvas.buffer_rgba())[..., :3]  # type: ignore[attr-defined]
    _, png = cv2.imencode(".png", colours[..., ::-1], [cv2.IMWRITE_PNG_COMPRESSION, 9])
    plt.close(figure)
    if len(png) > MOST_BYTES:
        raise ValueError(f"{name}.png has {len(png)} bytes, more than {MOST_BYTES}; draw it smaller")
    (FOLDER / f"{name}.png").write_bytes(png.tobytes())
