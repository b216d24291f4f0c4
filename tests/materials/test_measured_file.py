"""Reading RGL tensor files, and what is said of files that are none."""

import numpy as np
import pytest

from materials.input_error import InputError
from materials.measured_file import check_measured_file, read_tensor, tensor_fields
from tests.materials.rgl_file import spectral_measurement, write_tensor_file

WAVELENGTHS = np.linspace(360.0, 1000.0, 17)


def test_arrays_come_back_as_they_were_written(tmp_path):
    """The writer of the test lays the bytes out by the published format; every array must survive."""
    arrays = spectral_measurement(WAVELENGTHS)
    path = write_tensor_file(tmp_path / "a.bsdf", arrays)
    check_measured_file(path)
    fields = tensor_fields(path)
    assert set(fields) == set(arrays)
    for name, array in arrays.items():
        np.testing.assert_array_equal(read_tensor(path, fields[name]), array)


def test_a_file_without_850_nm_is_refused(tmp_path):
    """Visible-only measurements say nothing about the projector's light."""
    path = write_tensor_file(tmp_path / "visible.bsdf", spectral_measurement(np.linspace(400, 700, 5)))
    with pytest.raises(InputError, match="covers 400 to 700 nm, not 850 nm"):
        check_measured_file(path)


def test_an_rgb_file_is_refused(tmp_path):
    """The database's _rgb files have three colours and no wavelengths."""
    arrays = spectral_measurement(WAVELENGTHS)
    del arrays["wavelengths"]
    arrays["rgb"] = arrays.pop("spectra")[:, :, :3]
    with pytest.raises(InputError, match="has no spectra, wavelengths; take the spectral file"):
        check_measured_file(write_tensor_file(tmp_path / "a_rgb.bsdf", arrays))


def damaged(content: bytes) -> dict[str, tuple[bytes, str]]:
    """Broken versions of a good file, with what must be said."""
    return {
        "png": (b"\x89PNG\r\n" + bytes(60), "is not an RGL tensor file"),
        "empty": (b"", "is not an RGL tensor file"),
        "header_only": (content[:14], "list of arrays is damaged"),
        "half_list": (content[:60], "list of arrays is damaged"),
        "cut": (content[: len(content) // 2], "ends before its array"),
        "newer": (content[:12] + b"\x02\x00" + content[14:], "unknown version"),
    }


@pytest.mark.parametrize("case", damaged(b"x" * 100))
def test_damaged_files_are_named_with_a_mend(tmp_path, case):
    """One line with the file and what to do."""
    good = write_tensor_file(tmp_path / "good.bsdf", spectral_measurement(WAVELENGTHS)).read_bytes()
    content, fault = damaged(good)[case]
    path = tmp_path / f"{case}.bsdf"
    path.write_bytes(content)
    with pytest.raises(InputError, match=fault) as raised:
        check_measured_file(path)
    assert str(raised.value).startswith(str(path))
    assert "\n" not in str(raised.value)


def test_a_missing_file_is_named(tmp_path):
    """The reason of the operating system, and the path."""
    with pytest.raises(InputError, match="cannot be read"):
        check_measured_file(tmp_path / "none.bsdf")
