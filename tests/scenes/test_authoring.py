"""The authoring scripts make the committed meshes again, where CAD kernel and libraries are those of the manifest."""

import importlib.metadata
import importlib.util
import json

import pytest

from scenes.parts import manifest


def _installed(package: str) -> str | None:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return None


@pytest.mark.slow
@pytest.mark.skipif(importlib.util.find_spec("build123d") is None, reason="needs the extra `authoring`")
@pytest.mark.filterwarnings("default")  # the CAD libraries warn about themselves
def test_scripts_reproduce_the_committed_meshes(tmp_path):
    """Same scripts and same kernel: the same triangles to the last bit, by the content hash of each file."""
    made_with = manifest()["made_with"]
    if {name: _installed(name) for name in made_with} != made_with:
        pytest.skip(f"meshes were made with {made_with}")
    from scenes.authoring.write_meshes import write_meshes

    write_meshes(tmp_path)
    assert json.loads((tmp_path / "manifest.json").read_text()) == manifest()
