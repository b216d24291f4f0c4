"""Write every file of the corpus anew: `python -m tests.corpus.make_corpus`. The same bytes at every run."""

from pathlib import Path

from tests.corpus.gltf_cases import GLTF_CASES
from tests.corpus.polygon_cases import OBJ_CASES, PLY_CASES
from tests.corpus.step_cases import STEP_CASES
from tests.corpus.stl_cases import STL_CASES
from tests.corpus.table import Case

FOLDER = Path(__file__).parent / "files"
CORPUS: tuple[Case, ...] = (*STL_CASES, *OBJ_CASES, *PLY_CASES, *GLTF_CASES, *STEP_CASES)

if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for case in CORPUS:
        (FOLDER / case.file).write_bytes(case.make())
