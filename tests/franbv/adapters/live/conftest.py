"""An arm that goes on by itself, for the tests of this folder."""

import subprocess
import sys

import pytest

from tests.conftest import ROOT


@pytest.fixture
def controller(tmp_path):
    """A running arm: its port and its log."""
    log = tmp_path / "arm.log"
    command = [sys.executable, "-m", "tests.franbv.adapters.live.tcp_arm", str(log)]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        yield int(process.stdout.readline()), log
        process.kill()
