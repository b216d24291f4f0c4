"""The parts of docs/fra_robust.md that fra-robust was not developed on (`python -m docs.figures.unseen_parts FOLDER`).

A flange, a screw and a sprocket of bd_warehouse, a pipe's elbow and an angle bracket; STL in millimetres, z up. Needs
the extra `authoring`, which is loaded when it is asked for alone.
"""

# pyright: reportMissingImports=false
import sys
from pathlib import Path


def main(folder: Path) -> None:
    """Write an STL file of each."""
    from build123d import export_stl

    folder.mkdir(parents=True, exist_ok=True)
    for name, solid in {**bought_parts(), "elbow": pipe_elbow(), "bracket": angle_bracket()}.items():
        export_stl(solid, str(folder / f"{name}.stl"), tolerance=0.05, angular_tolerance=0.2)


def bought_parts() -> dict:
    """Of a catalogue: flange of DN 50, M24 x 110, sprocket of 24 teeth for half-inch chains."""
    from bd_warehouse.fastener import HexHeadScrew
    from bd_warehouse.flange import WeldNeckFlange
    from bd_warehouse.sprocket import Sprocket

    return {
        "flange": WeldNeckFlange(nps="2", flange_class=150, face_type="Raised"),
        "bolt": HexHeadScrew(size="M24-3", length=110, simple=True),
        "sprocket": Sprocket(24, 12.7, 8, 0.1, 18, 0, 0, 0, 20),
    }


def pipe_elbow():
    """A solid of a pipe's bend, 48 mm across."""
    from build123d import BuildLine, BuildPart, BuildSketch, Circle, Line, Plane, RadiusArc, sweep

    with BuildPart() as part:
        with BuildLine():
            Line((0, 0, 0), (0, 0, 50))
            RadiusArc((0, 0, 50), (60, 0, 110), 60)
            Line((60, 0, 110), (100, 0, 110))
        with BuildSketch(Plane.XY):
            Circle(24)
        sweep()
    return part.part


def angle_bracket():
    """An angle of 12 mm plate with a bore."""
    from build123d import Align, Axis, Box, BuildPart, Hole, Locations, fillet

    on_table = (Align.CENTER, Align.CENTER, Align.MIN)
    with BuildPart() as part:
        Box(90, 60, 12, align=on_table)
        with Locations((-39, 0, 0)):
            Box(12, 60, 80, align=on_table)
        with Locations((20, 0, 12)):
            Hole(12)
        fillet(part.edges().filter_by(Axis.Y).sort_by(Axis.Z)[-2:], 3)
    return part.part


if __name__ == "__main__":
    main(Path(sys.argv[1]))
