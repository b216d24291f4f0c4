"""What decides a result's bytes is named, and those who differ in it are told apart."""

import re
from pathlib import Path

import pytest

from materials.input_error import InputError
from studies.work.maker import agreed_maker, instruction_set, maker, unlikeness, versions


def test_makers_must_agree():
    """Nobody, one, two alike, and a second one with another renderer."""
    cpu, gpu = ({"renderer": name, "numpy": "2.0"} for name in ("llvm", "cuda"))
    assert agreed_maker([]) is None
    assert agreed_maker([("a", cpu), ("b", dict(cpu))]) == cpu
    with pytest.raises(InputError, match="a has renderer llvm, not the cuda of c"):
        agreed_maker([("a", cpu), ("b", cpu), ("c", gpu)])


def test_one_that_says_less_is_another():
    """A result of an older version that does not name its instruction set may come from any."""
    assert unlikeness({"numpy": "2.0"}, {"numpy": "2.0", "llvm": "19"}) == "llvm None, not the 19"


@pytest.mark.skipif(not Path("/proc/cpuinfo").exists(), reason="the kernel does not tell the processor's features")
def test_instruction_set_is_the_kernels():
    """The kernel lists the processor's features, too; 512-bit vectors before 256-bit ones."""
    flags = set(re.findall(r"\w+", Path("/proc/cpuinfo").read_text()))
    expected = {"avx512f": "AVX-512", "avx2": "AVX2"}
    known = [name for flag, name in expected.items() if flag in flags]
    assert not known or instruction_set() == known[0]


def test_maker_names_llvm_and_instruction_set():
    """Both decide bytes: the same seed took other views on processors with and without AVX-512."""
    assert {"llvm", "instruction set", "python", "mitsuba", "numpy"} <= set(versions())
    assert re.fullmatch(r"\d+\.\d+\.\d+|none", versions()["llvm"])
    assert set(maker()) == {"renderer", *versions()}
