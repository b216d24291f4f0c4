"""The projector: rendered dots beside real ones. `python -m docs.figures.projector` prints the tables."""

from dataclasses import astuple

import numpy as np

from docs.figures.drawing import panels, show_grey, write
from tests.physics.dot_statistics import DotStatistics, dot_statistics
from tests.physics.lit_wall import DISTANCE, ROOM_LIGHT, lamp_irradiance, lit_wall, middle_of_field
from tests.physics.real_dots_on_box import FOCAL_PX, SIDES, real_dots

COLUMNS = "density  p10   p50   p90   width  grey  peak/background  with pedestal  spread  white"


def line(name: str, s: DotStatistics) -> str:
    """One row of the table."""
    _, density, spacing, width, grey, peak, raw, spread, _, white = astuple(s)
    cells = (
        *(f"{value:5.1f}" for value in spacing),
        f"{width[1]:5.2f}",
        f"{grey:4.0f}",
        f"{peak:15.2f}",
        f"{raw:13.2f}",
    )
    return f"{name:22s} {density:7.2f} {' '.join(cells)}  {100 * spread:5.1f} %  {100 * white:.2f} %"


def main() -> None:
    """Print dot statistics and what lamps and distance do to them; draw real and rendered dots."""
    print(f"{'':22s} {COLUMNS}")
    for side in SIDES:
        print(line(f"real, {side}", dot_statistics(*real_dots(side), FOCAL_PX)))
    walls = {profile: lit_wall(DISTANCE, profile) for profile in ("1280x720", "848x480", "640x360")}
    for profile, wall in walls.items():
        for exposure, image in (
            ("third", wall.image_without_white(lamp_irradiance(ROOM_LIGHT))),
            ("auto", wall.image(lamp_irradiance(ROOM_LIGHT))),
        ):
            found = dot_statistics(image, middle_of_field(image.shape), wall.focal_px)
            print(line(f"{profile}, {exposure}", found))
    print("width by the setting dot_fwhm_px, 1280x720:")
    for fwhm in (3.7, 4.4, 4.8, 5.0, 6.0):
        wall = lit_wall(DISTANCE, dot_fwhm_px=fwhm)
        image = wall.image_without_white(lamp_irradiance(ROOM_LIGHT))
        found = dot_statistics(image, middle_of_field(image.shape), wall.focal_px)
        print(f"  {fwhm:.1f} px: {found.width[1]:.2f} px, peak over background {found.peak_over_background:.2f}")
    print("peak over background by lamps and distance, 1280x720:")
    for distance in (0.3, 0.44, 0.6, 1.0):
        wall, cells = lit_wall(distance), []
        for lamps in ("dim", "workshop", "bright"):
            image = wall.image_without_white(lamp_irradiance(lamps))
            found = dot_statistics(image, middle_of_field(image.shape), wall.focal_px)
            cells.append(f"{lamps} {found.peak_over_background:.2f}")
        print(f"  {distance:.2f} m  {'  '.join(cells)}")

    real, _ = real_dots("left")
    wall = walls["848x480"]
    rendered = wall.image_without_white(lamp_irradiance(ROOM_LIGHT))
    h, w = real.shape
    top, left = (np.array(rendered.shape) - real.shape) // 2
    figure, (first, second) = panels(2, height=2.5)
    show_grey(first, real, "real D435, side of a box at 0.44 m, 848x480", 180)
    show_grey(second, rendered[top : top + h, left : left + w], "rendered, matte wall at 0.44 m, 200 lx, 848x480", 180)
    write(figure, "projector")


if __name__ == "__main__":
    main()
