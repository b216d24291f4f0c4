"""A connection to ROS 2 through rosbridge: calls that end, goals that can be watched, and no message that is sent late.

roslibpy keeps what is sent without a connection and sends it after the next one; for an arm that would be a way begun
when nobody watches. So a connection here lives once: what is lost is never taken up again, a new one is opened instead.
"""

import importlib
import logging
import threading
import time
from collections.abc import Callable, Mapping
from functools import cache
from types import TracebackType
from typing import Any

from franbv.adapters.arms.driver import POLL_S, ArmError

_CLOSING_S = 2.0
"""How long a connection is given to close [s] (choice: then the other side has gone)."""
_LOGGER = logging.getLogger("roslibpy")


@cache
def roslibpy() -> Any:
    """The module `roslibpy`; ArmError that names the mend where it is missing. Its functions have no types."""
    try:
        return importlib.import_module("roslibpy")
    except ImportError:
        raise ArmError("roslibpy: not installed here; pip install 'franbv[ros]'") from None


class Answer:
    """What comes back, once, from another thread."""

    def __init__(self) -> None:
        self.values: Any = None
        self.refused = False
        self._came = threading.Event()

    def give(self, values: Any) -> None:
        """It came."""
        self.values = values
        self._came.set()

    def refuse(self, values: Any) -> None:
        """It came, and says that rosbridge could not do it."""
        self.refused = True
        self.give(values)

    def wait(self, timeout_s: float) -> bool:
        """Whether it is there, after at most this long [s]."""
        return self._came.wait(timeout_s)


class BridgeGoal(Answer):
    """A goal of an action that was sent: its result, when there is one."""

    def __init__(self, client: Any) -> None:
        super().__init__()
        self.client = client
        self.name = ""


class _Complaints(logging.Handler):
    """Hears when roslibpy could not make sense of a message, which it drops otherwise, and tells the connection."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        super().__init__(logging.ERROR)
        self._tell = tell

    def emit(self, record: logging.LogRecord) -> None:
        """One message was dropped, or not sent."""
        cause = record.exc_info[1] if record.exc_info else None
        words = " ".join(f"{type(cause).__name__} {cause}".split()) if cause else record.getMessage()
        if "for operation" not in words:  # kinds of messages that we ask nothing of, such as `status`
            self._tell(f"a message could not be read or sent ({words})")


class RosBridge:
    """One connection. Methods raise ArmError, in one line that begins with the URL."""

    def __init__(self, url: str, connect_timeout_s: float) -> None:
        self.url = url
        self._fault = ""
        self._closed = False
        self._topics: dict[str, Any] = {}
        self._complaints = _Complaints(self._told)
        ros = self._ros = roslibpy().Ros(url, transport="twisted")
        ros.factory.maxRetries = 0  # twisted's: a lost connection stays lost
        ros.factory.noisy = False
        _LOGGER.addHandler(self._complaints)
        try:
            ros.run(timeout=connect_timeout_s)
        except Exception as error:
            self.close()
            raise ArmError(
                f"{url}: no rosbridge answers; start it on the robot (ros2 launch rosbridge_server "
                "rosbridge_websocket_launch.xml), and check address, port and firewall"
            ) from error
        ros.on("close", lambda *_: self._told("the connection was lost"))

    def __enter__(self) -> "RosBridge":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def fault(self) -> str:
        """Why nothing more can be done through this connection; empty while it is well."""
        return self._fault if self._fault or self._ros.is_connected else "the connection was lost"

    def check(self) -> None:
        """ArmError unless the connection is well."""
        if self.fault:
            raise ArmError(f"{self.url}: {self.fault}; check network and rosbridge, and open the arm anew")

    def call(self, service: str, args: Mapping[str, Any], timeout_s: float) -> dict[str, Any]:
        """What a service answers."""
        self.check()
        answer = Answer()
        message = {"op": "call_service", "service": service, "args": dict(args), "timeout": timeout_s}
        message["id"] = f"call_service:{service}:{self._ros.id_counter}"
        self._ros.call_async_service(roslibpy().Message(message), answer.give, answer.refuse)
        deadline = time.monotonic() + timeout_s
        while not answer.wait(POLL_S):
            self.check()
            if time.monotonic() > deadline:
                raise ArmError(
                    f"{self.url}: {service} did not answer within {timeout_s:g} s; is MoveIt (move_group) running?"
                )
        if answer.refused:
            raise ArmError(
                f"{self.url}: {service} was not called ({in_one_line(answer.values)}); is MoveIt (move_group) running?"
            )
        return dict(answer.values)

    def subscribe(
        self, topic: str, message_type: str, heard: Callable[[Mapping[str, Any]], None], every_ms: int
    ) -> None:
        """Hear a topic, no more often than that [ms]; `heard` runs in another thread."""
        self._topic(topic, message_type, throttle_rate=every_ms, queue_length=1).subscribe(heard)

    def advertise(self, topic: str, message_type: str) -> None:
        """Announce a topic, so that those who listen to it find us before it matters."""
        self._topic(topic, message_type).advertise()

    def publish(self, topic: str, message: Mapping[str, Any]) -> None:
        """Send on a topic that was announced, as far as there is a connection."""
        if self._ros.is_connected:
            self._topics[topic].publish(roslibpy().Message(dict(message)))

    def send_goal(self, action: str, action_type: str, goal: Mapping[str, Any]) -> BridgeGoal:
        """Begin an action."""
        self.check()
        sent = BridgeGoal(roslibpy().ActionClient(self._ros, action, action_type))
        sent.name = sent.client.send_goal(roslibpy().Goal(dict(goal)), sent.give, lambda feedback: None, sent.refuse)
        return sent

    def cancel(self, goal: BridgeGoal) -> None:
        """Ask for a goal's end, as far as there is a connection."""
        if self._ros.is_connected and not goal.wait(0):
            goal.client.cancel_goal(goal.name)

    def close(self) -> None:
        """Let go; again and again, and never raises."""
        if self._closed:
            return
        self._closed = True
        self._told("the connection is closed")
        ros = self._ros
        try:
            ros.call_later(0, ros.factory.stopTrying)
            ros.close(timeout=1)
            end = time.monotonic() + _CLOSING_S
            while ros.is_connected and time.monotonic() < end:  # what was sent last, a stop, goes out first
                time.sleep(POLL_S)
        except Exception as error:  # of a connection that is closing already
            _LOGGER.debug("closing: %s", error)
        _LOGGER.removeHandler(self._complaints)

    def _topic(self, name: str, message_type: str, **options: Any) -> Any:
        self.check()
        if name not in self._topics:
            self._topics[name] = roslibpy().Topic(self._ros, name, message_type, reconnect_on_close=False, **options)
        return self._topics[name]

    def _told(self, fault: str) -> None:
        self._fault = self._fault or fault


def in_one_line(words: object) -> str:
    """What somebody else's program says, in one line that is not endless."""
    line = " ".join(str(words).split())
    return line if len(line) <= 200 else f"{line[:200]}..."
