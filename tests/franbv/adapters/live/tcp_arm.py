"""An arm in a process of its own, as a controller is: told to go, it goes on until it arrives or is told to stop.

python -m tests.franbv.adapters.live.tcp_arm LOG    prints its port, and writes what happens to it, a line each.
"""

import json
import socket
import socketserver
import sys
import threading
import time
from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import RigidTransform

from franbv.adapters.arms.driver import ArmError, FlangePath
from tests.franbv.adapters.live.cells import CELL, HOME, straight_way


class Controller:
    """Where the arm is, by the clock."""

    def __init__(self, log) -> None:
        self.lock, self.log = threading.Lock(), log
        self.poses, self.begun, self.duration = [CELL.flange_at(HOME).as_matrix().tolist()], 0.0, 0.0

    def answer(self, asked: dict) -> dict:
        with self.lock:
            now = time.monotonic()
            if asked["op"] == "go":
                self.poses, self.begun, self.duration = asked["poses"], now, asked["duration"]
                self.note(f"go {self.duration:.3f}")
            elif asked["op"] == "stop":
                if self.share(now) < 1.0:
                    self.note(f"stopped at {self.share(now):.3f}")
                self.poses, self.duration = [self.pose(now)], 0.0
            return {"pose": self.pose(now), "moving": self.share(now) < 1.0, "at": self.share(now)}

    def share(self, now: float) -> float:
        return 1.0 if self.duration == 0 else min(1.0, (now - self.begun) / self.duration)

    def pose(self, now: float) -> list:
        return self.poses[round(self.share(now) * (len(self.poses) - 1))]

    def note(self, words: str) -> None:
        self.log.write(f"{words}\n")
        self.log.flush()


class TcpArm:
    """Implements `ArmDriver` over a socket."""

    name = "TCP arm"

    def __init__(self, port: int, speed: float = 0.2) -> None:
        self.speed, self.lock = speed, threading.Lock()
        try:
            self.socket = socket.create_connection(("127.0.0.1", port), timeout=5.0)
        except OSError as error:
            raise ArmError(f"TCP arm at port {port}: {error.strerror}; start it") from None
        self.file = self.socket.makefile("rw")

    def ask(self, **asked) -> dict:
        try:
            with self.lock:
                self.file.write(json.dumps(asked) + "\n")
                self.file.flush()
                line = self.file.readline()
        except (OSError, ValueError):
            line = ""
        if not line:
            raise ArmError("TCP arm: does not answer; check it")
        return json.loads(line)

    def flange_pose(self) -> RigidTransform:
        return RigidTransform.from_matrix(np.array(self.ask(op="state")["pose"]))

    def can_reach(self, T_base_flange: RigidTransform) -> bool:
        return True

    def plan(self, T_base_flange: RigidTransform) -> FlangePath | None:
        return straight_way(self.flange_pose(), T_base_flange, self.speed)

    def execute(self, path: FlangePath, may_go_on: Callable[[], bool]) -> None:
        self.ask(op="go", poses=[T.as_matrix().tolist() for T in path.poses], duration=path.duration_s)
        while self.ask(op="state")["moving"]:
            if not may_go_on():
                self.stop()
                raise ArmError("TCP arm: stopped; look at it")
            time.sleep(0.02)

    def stop(self) -> None:
        try:
            self.ask(op="stop")
        except ArmError:
            return

    def close(self) -> None:
        self.stop()
        self.socket.close()


def open_tcp_arm(port: int, speed: float = 0.2) -> TcpArm:
    return TcpArm(port, speed)


def main(log_path: str) -> None:
    with open(log_path, "a") as log:
        controller = Controller(log)

        class Handler(socketserver.StreamRequestHandler):
            def handle(self) -> None:
                for line in self.rfile:
                    self.wfile.write((json.dumps(controller.answer(json.loads(line))) + "\n").encode())

        with socketserver.ThreadingTCPServer(("127.0.0.1", 0), Handler) as server:
            server.daemon_threads = True
            sys.stdout.write(f"{server.server_address[1]}\n")
            sys.stdout.flush()
            server.serve_forever()


if __name__ == "__main__":
    main(sys.argv[1])
