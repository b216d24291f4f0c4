"""How well an advice of few poses ranks: Kendall's tau against all remedies measured at many more, other poses.

    franbv advise --part C --bench paper --out runs/advise_c
    franbv advise --part C --bench paper --poses 24 --seeds 1 --seed 100 --minutes 90 --out runs/advise_c_all
    python -m docs.figures.advice_ranking runs/advise_c runs/advise_c_all

The second starts at other poses and other noise, so that the two have nothing in common but the part.
"""

import argparse
from pathlib import Path

import numpy as np
from scipy.stats import kendalltau

from materials.input_error import InputError
from studies.advise.advice import Advice, RemedyScore
from studies.advise.stored_advice import StoredAdvice, read_stored_advice


def main(few: Path, many: Path) -> None:
    """Print it."""
    one, other = (read_stored_advice(folder) for folder in (few, many))
    if set(one.poses) & set(other.poses):
        raise InputError(f"{few}, {many}: have poses in common; give one of them another --seed")
    ours, theirs = (_by_title(stored) for stored in (one, other))
    common = sorted(set(ours) & set(theirs))
    shares = np.array([[ours[title].right_share, theirs[title].right_share] for title in common])
    ranks = np.array([theirs[title].rank for title in common])
    told = [name for name in common if theirs[name].verdict != "level"]
    told_shares = np.array([[ours[title].right_share, theirs[title].right_share] for title in told])
    print(
        f"{len(common)} remedies at {one.advice.poses} and at {other.advice.poses} other poses: "
        f"Kendall's tau {_tau(*shares.T):.2f}; "
        f"with those tied that the many do not tell apart {_tau(shares[:, 0], -ranks):.2f}; "
        f"of the {len(told)} that the many tell apart from the camera as it is set "
        f"{_tau(*told_shares.T):.2f}"
    )
    print(f"base {_base(one.advice)} and {_base(other.advice)}; first {_first(one.advice)} and {_first(other.advice)}")


def _by_title(stored: StoredAdvice) -> dict[tuple[str, str], RemedyScore]:
    return {(score.name, score.level): score for score in stored.advice.remedies}


def _tau(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.asarray(kendalltau(one, other))[0])


def _base(advice: Advice) -> str:
    return f"{100 * advice.base.right_share:.1f} %"


def _first(advice: Advice) -> str:
    best = next(score for score in advice.remedies if not score.is_ceiling)
    return f"{best.name}: {best.level} ({100 * best.right_share:.1f} %)"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m docs.figures.advice_ranking")
    parser.add_argument("few", type=Path)
    parser.add_argument("many", type=Path)
    said = parser.parse_args()
    main(said.few, said.many)
