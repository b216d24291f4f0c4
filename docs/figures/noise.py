"""Matcher: noise and holes beside those of 24 real D415 frames. `python -m docs.figures.noise` prints the table."""

import numpy as np

from docs.figures.drawing import panels, show_grey, write
from tests.physics.depth_statistics import LAGS, PROFILE, Frame, autocorrelation, edge_profile, smooth_patches
from tests.physics.furnished_room import D415, LAMPS, room_frames
from tests.physics.real_d415_statistics import REAL, is_met, statistics

SHOWN = 1
"""The view that is drawn."""
FALSE_PX = 1.0
"""Disparity error that is drawn as false [px]."""
STEPS_PX = (3.0, 5.0, 8.0)
"""Least steps of an edge, to see how much their choice matters [px]."""
FEW_MODES = 3.0
"""Of the laser, to see what more speckle does to the noise."""
COLOURS = {"hole": (0.85, 0.1, 0.1), "hidden hole": (0.1, 0.6, 0.1), "false": (0.1, 0.2, 0.9)}


def outcome(frame: Frame) -> np.ndarray:
    """The left image (h, w, 3) with holes and false depth in colours."""
    picture = np.repeat(frame.left[..., None] / 255.0, 3, axis=-1)
    hole = (frame.found == 0) & frame.counted
    picture[hole] = COLOURS["hole"]
    picture[hole & ~frame.visible] = COLOURS["hidden hole"]
    picture[frame.counted & ~hole & (np.abs(frame.found - frame.true) > FALSE_PX)] = COLOURS["false"]
    return picture


def cell(name: str, value: float) -> str:
    """A number, its ratio to the real one, and whether that is near 1."""
    return f"{value:11.3f} {value / REAL[name]:6.2f} {'*' if is_met(name, value) else ' '}"


def main() -> None:
    """Print every number beside the real one and its ratio to it; draw a view, the correlation and the edges."""
    views = list(room_frames())
    frames = {lamps: [view[lamps] for view in views] for lamps in LAMPS}
    found = {lamps: statistics(frames[lamps]) for lamps in LAMPS}
    print(f"{len(views)} views of a furnished room, D415 at 1280x720; * = within 25 % of the real one")
    print(f"{'':46s}{'real':>7s}" + "".join(f"{f'{lamps}, {level:g} lx':>20s}" for lamps, level in LAMPS.items()))
    for name, real in REAL.items():
        print(f"{name:46s}{real:7.3f}" + "".join(cell(name, found[lamps][name]) for lamps in LAMPS))
    for lamps in LAMPS:
        print(f"met under {lamps}: {sum(is_met(name, value) for name, value in found[lamps].items())} of {len(REAL)}")
    for step in STEPS_PX:
        shares = edge_profile(frames["dim"], "left", step)[:, 0]
        print(f"left of edges of {step:g} px and more, hole at {PROFILE} px: {shares.round(2).tolist()}")
    speckled = D415.model_copy(update={"imager": D415.imager.model_copy(update={"laser_modes": FEW_MODES})})
    other = statistics([view["dim"] for view in room_frames(("dim",), speckled)])
    sigma = ", ".join(f"{other[name]:.3f}" for name in list(REAL)[:3])
    print(f"noise of smooth patches with {FEW_MODES:g} laser modes instead of {D415.imager.laser_modes:g}: {sigma} px")
    draw(frames, found)


def draw(frames: dict[str, list[Frame]], found: dict[str, dict[str, float]]) -> None:
    """A view with its holes, autocorrelation, shares beside edges."""
    figure, axes = panels(4, width=11.0, height=2.3)
    shown = frames["dim"][SHOWN]
    show_grey(axes[0], shown.left[::2, ::2], "left image")
    axes[1].imshow(outcome(shown)[::2, ::2])
    axes[1].set_title("holes red (hidden: green), false blue")
    axes[1].set_axis_off()
    patches = [patch for frame in frames["dim"] for patch in smooth_patches(frame)]
    for axis, name, colour in ((1, "x", "C0"), (0, "y", "C1")):
        ours = np.mean([autocorrelation(patch, axis) for patch in patches], axis=0)
        axes[2].plot(LAGS, ours, color=colour, label=f"ours, {name}")
        real = [REAL[f"autocorrelation along {name} at {lag} px"] for lag in LAGS]
        axes[2].plot(LAGS, real, "o", color=colour, label=f"real, {name}")
    axes[2].set(xlabel="lag [px]", ylabel="autocorrelation of the noise")
    axes[2].legend(fontsize=7)
    for what, colour in (("hole", "C3"), ("foreground", "C2")):
        names = [f"left of a near edge, {what} at {k} px" for k in PROFILE]
        axes[3].plot(PROFILE, [found["dim"][name] for name in names], color=colour, label=f"ours, {what}")
        axes[3].plot(PROFILE, [REAL[name] for name in names], "o", color=colour, label=f"real, {what}")
    axes[3].set(xlabel="left of a near edge [px]", ylabel="share", ylim=(0, 1))
    axes[3].legend(fontsize=7)
    write(figure, "noise")


if __name__ == "__main__":
    main()
