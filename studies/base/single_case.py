"""What `frame` and `reconstruct` have in common: one command, one case, made once and shown at the top of `--out`."""

from collections.abc import Callable, Iterable
from pathlib import Path

from studies.base.case_folder import case_digest, finished_case, writing
from studies.base.config import Config
from studies.base.latest import point_latest
from studies.base.output_errors import prepare_output


def made_once(
    command: str, config: Config, out: Path, files: Iterable[str], make: Callable[[Path], None]
) -> tuple[Path, bool]:
    """The case of `config` in `out`, and whether it was there already; `make` fills its folder when it was not.

    files: what of it `out` itself shows, as links.
    """
    prepare_output(out)
    digest = case_digest(command, config)
    case = finished_case(out, digest)
    found = case is not None
    if case is None:
        with writing(out, digest) as folder:
            make(folder)
        case = out / digest
    point_latest(case, files)
    return case, found
