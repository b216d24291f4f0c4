"""Matte parts on a matte table, by distance. `python -m docs.figures.matte` prints the table."""

from scenes.parts import EARLIER_PARTS
from tests.physics.matte_parts import DISTANCES, matte_shares


def main() -> None:
    """Print fill and false depth of parts A1 to D1."""
    print("part  distance  filled  false   on the part: filled  false")
    for distance in DISTANCES:
        for part in EARLIER_PARTS:
            s = matte_shares(part, distance)
            print(
                f"  {part}  {distance:6.2f} m  {100 * s.filled:5.1f}%  {100 * s.false:4.1f}%"
                f"   {100 * s.filled_part:20.1f}%  {100 * s.false_part:4.1f}%",
                flush=True,
            )


if __name__ == "__main__":
    main()
