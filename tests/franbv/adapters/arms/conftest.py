"""An arm behind a stub of MoveIt, patient where the test does not say otherwise: the machine may be busy."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import Any

import pytest

from franbv.adapters.arms.ros_arm import RosArm
from franbv.adapters.arms.ros_settings import RosArmSettings
from tests.franbv.adapters.arms.stub_moveit import StubMoveIt

PATIENCE: dict[str, Any] = {"connect_timeout_s": 60.0, "call_timeout_s": 30.0, "state_timeout_s": 10.0}


@pytest.fixture
def opened() -> Iterator[Callable[..., RosArm]]:
    """Opens the stub and an arm upon it; flags of the arm's settings beside. All messages must have been in order."""
    pytest.importorskip("roslibpy")
    stubs = []
    with ExitStack() as stack:

        def open_arm(stub: StubMoveIt, **flags: Any) -> RosArm:
            stubs.append(stack.enter_context(stub.running()))
            named = {"url": stub.url, "group": "arm", "flange_link": "flange"}
            return stack.enter_context(RosArm(RosArmSettings(**(PATIENCE | named | flags))))

        yield open_arm
    assert [stub.wrong for stub in stubs] == [[]] * len(stubs)
