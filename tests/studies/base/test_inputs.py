"""What a command reads it does not write over: files are told by what they are, and links of the user's stay."""

import pytest

from materials.input_error import InputError
from studies.base.inputs import check_not_overwritten, check_outside
from studies.base.latest import LATEST, point_latest


@pytest.mark.parametrize("name", ["a.txt", "soft", "hard", "sub/../a.txt"])
def test_one_file_by_any_path(tmp_path, name):
    """The path itself, a symbolic link, a hard link, a way round."""
    (tmp_path / "sub").mkdir()
    (tmp_path / "a.txt").write_text("kept")
    (tmp_path / "soft").symlink_to(tmp_path / "a.txt")
    (tmp_path / "hard").hardlink_to(tmp_path / "a.txt")
    with pytest.raises(InputError, match="would be lost"):
        check_not_overwritten([None, tmp_path / "a.txt"], [tmp_path / "new", tmp_path / name])
    check_not_overwritten([tmp_path / "a.txt", tmp_path / "missing"], [tmp_path / "new"])


def test_inputs_lie_outside_a_folder_that_is_renewed(tmp_path):
    """Inside it, through a link too, they are refused; beside it they are welcome."""
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "a.yaml").write_text("")
    (tmp_path / "link.yaml").symlink_to(tmp_path / "out" / "a.yaml")
    for name in ("out/a.yaml", "link.yaml"):
        with pytest.raises(InputError, match="move it out of there"):
            check_outside([tmp_path / name], tmp_path / "out")
    check_outside([None, tmp_path / "outside.yaml"], tmp_path / "out")


def test_links_of_the_user_stay(tmp_path):
    """Of two files that the case shows, one is the user's link to a mesh: it stays, the other is ours and moves."""
    mesh = tmp_path / "mesh.ply"
    mesh.write_text("the user's")
    for case in ("0" * 16, "1" * 16):
        (tmp_path / case).mkdir()
        for name in ("cloud.ply", "run.json"):
            (tmp_path / case / name).write_text(case)
    (tmp_path / "cloud.ply").symlink_to(mesh)
    for case in ("0" * 16, "1" * 16):
        point_latest(tmp_path / case, ["cloud.ply", "run.json"])
        assert (tmp_path / "run.json").read_text() == case
        assert (tmp_path / LATEST / "cloud.ply").read_text() == case
    assert (tmp_path / "cloud.ply").readlink() == mesh
    assert mesh.read_text() == "the user's"
