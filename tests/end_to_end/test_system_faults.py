"""What the operating system does to the daemon: descriptors run out, the wall clock jumps, nobody reads the log, the
disk fills while a run is recorded, memory is refused. Each time an error or an event says so, and the simulation goes on.
"""

import fcntl
import json
import os
import pathlib
import resource
import signal
import socket
import struct
import time
import unittest

from harness import BIN, HANG_S
from system_case import Connection, SystemCase

LIBRARIES = pathlib.Path(os.environ.get("REGRASP_FAULT_LIBRARIES", BIN.parent / "tests"))


class Shared:
    """A number that a program under test has mapped: written in place."""

    def __init__(self, path, code):
        self.code = code
        path.write_bytes(struct.pack(code, 0))
        self.file = os.open(path, os.O_RDWR)

    def set(self, value):
        os.pwrite(self.file, struct.pack(self.code, value), 0)

    def close(self):
        os.close(self.file)


def preload(library):
    assert (LIBRARIES / f"{library}.so").exists()
    return str(LIBRARIES / f"{library}.so")


class Descriptors(SystemCase):
    def test_clients_that_take_every_descriptor_are_refused_and_the_others_live_on(self):
        wire = self.start("--speed", "max", preexec=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (32, 32)))
        wire.result("record.start", file="r.mcap")
        wire.result("record.stop")
        wire.result("checkpoint.save", name="x")
        crowd = []
        for _ in range(60):
            client = socket.socket(socket.AF_UNIX)
            client.connect(str(self.socket))
            client.sendall(b'{"jsonrpc":"2.0","id":1,"method":"version"}\n')
            crowd.append(client)
        while len(os.listdir(f"/proc/{self.daemon.pid}/fd")) < 32:
            wire.result("status")
        # There is none left: what needs one says so, instead of "there are no files".
        for method, params in (("record.list", {}), ("checkpoint.list", {}), ("record.start", {}), ("checkpoint.save", {"name": "x"}),
                               ("plot", {"name": "scene"}), ("checkpoint.restore", {"name": "x"})):
            answer = wire.ask(method, **params)
            self.assertIn("error", answer, f"{method}: {answer}")
            self.assertEqual(answer["error"]["code"], -32007, f"{method}: {answer}")
        self.assertIn("result", wire.ask("grasp"))
        for client in crowd:
            client.close()
        late = Connection(self.socket)  # one of those that had no descriptor
        self.assertEqual([r["file"] for r in late.result("record.list")["recordings"]], ["r.mcap"])
        self.assertEqual(sorted(os.listdir(self.out)), ["r.mcap", "x.checkpoint"])
        self.goes_on(late)


class WallClock(SystemCase):
    def test_an_hour_forth_and_back_changes_nothing(self):
        clock = Shared(self.dir / "wrong", "<q")
        self.addCleanup(clock.close)
        wire = self.start("--speed", "1.0", LD_PRELOAD=preload("wall_clock"), WALL_CLOCK=str(self.dir / "wrong"))
        wire.result("record.start", file="r.mcap")
        job = wire.result("grasp")["job"]
        times, wall = [], []
        for wrong in (3600, -3600, 0, -86400 * 20000, 0):
            wire.send("job.wait", id=job, timeout_s=0.5)
            clock.set(wrong)
            wire.result("status")
            answer = next((a for a in wire.events if "id" in a), None) or json.loads(wire.lines.readline())  # not in an hour
            self.assertTrue(answer.get("error", {}).get("code") == -32004 or answer["result"]["state"] == "done", answer)
            wire.events = []
            wire.result("checkpoint.save", name="c")
            wire.result("plot", name="scene", file="s.png", overwrite=True)
            times.append(wire.result("status")["time_s"])
            wall.append(time.monotonic())
        self.assertEqual(times, sorted(times))
        # In real time: the simulation has not caught up an hour, nor stood still.
        self.assertLess(times[-1] - times[0], wall[-1] - wall[0] + 5)
        wire.result("record.stop")
        self.assertEqual(self.json("replay", self.out / "r.mcap")["identical"], True)
        self.goes_on(wire)


class Log(SystemCase):
    def fill(self, wire):
        """More than a pipe of four pages holds: a line for each signal."""
        for _ in range(400):
            self.daemon.send_signal(signal.SIGHUP)
            wire.result("status")

    def test_nobody_reads_it(self):
        reader, writer = os.pipe()
        fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, 16384)
        wire = self.start("--speed", "max", stderr=writer)
        self.fill(wire)
        os.set_blocking(reader, False)
        self.assertGreater(len(os.read(reader, 65536)), 1000)
        self.fill(wire)
        self.assertIn(b"lines were lost", os.read(reader, 65536))
        os.close(writer)
        self.goes_on(wire)
        os.close(reader)

    def test_its_reader_has_gone(self):
        reader, writer = os.pipe()
        wire = self.start("--speed", "max", stderr=writer)
        os.close(reader)
        os.close(writer)
        self.fill(wire)
        self.goes_on(wire)


class FullDisk(SystemCase):
    def test_a_recording_that_the_disk_cannot_take_is_told_at_once(self):
        env = {"LD_PRELOAD": preload("fail_at"), "FAIL_UNDER": str(self.dir / "out"), "FAIL_CALL": "write", "FAIL_AT": "40", "FAIL_ON": "1"}
        wire = self.start("--speed", "max", **env)
        wire.result("subscribe", topic="events", rate_hz=100)
        wire.result("record.start", file="r.mcap")
        wire.result("grasp")
        event = wire.event("recording_failed")
        self.assertIn("r.mcap", event["text"])
        self.assertIn("No space left", event["text"])
        listed = {r["file"]: r for r in wire.result("record.list")["recordings"]}
        self.assertFalse(listed["r.mcap"]["recording"])
        told = wire.ask("record.stop")["error"]
        self.assertEqual(told["code"], -32007)
        self.assertIn("No space left", told["message"])
        for method, params in (("checkpoint.save", {"name": "c"}), ("record.start", {"file": "s.mcap"})):
            self.assertEqual(wire.ask(method, **params)["error"]["code"], -32007)
        self.goes_on(wire)
        self.assertEqual([f for f in os.listdir(self.out) if f.startswith(".draft") or f.endswith(".checkpoint")], [])


class Memory(SystemCase):
    REQUESTS = (("status", {}), ("describe", {}), ("events", {}), ("param.set", {"name": "object.friction", "value": 0.5}), ("grasp", {}),
                ("job.list", {}), ("job.wait", {"id": 1, "timeout_s": 60}), ("stop", {}), ("plot", {"name": "scene"}),
                ("checkpoint.save", {"name": "c"}), ("checkpoint.list", {}), ("subscribe", {"topic": "quality", "rate_hz": 50}),
                ("record.start", {}), ("record.stop", {}), ("quality", {}))

    def test_whichever_allocation_fails_the_reserve_lets_everything_come_to_its_end(self):
        countdown = Shared(self.dir / "countdown", "<i")
        self.addCleanup(countdown.close)
        log = open(self.dir / "log", "w+b")
        self.addCleanup(log.close)
        other = self.start("--clock", "lockstep", "--speed", "max", stderr=log, LD_PRELOAD=preload("no_memory"),
                           NO_MEMORY=str(self.dir / "countdown"))
        for method, params in self.REQUESTS:
            for number in (1, 3, 9, 40, 200, 1000):
                # A new client each time: who is accepted, asks and leaves while memory is short.
                countdown.set(number)
                wire = Connection(self.socket)
                answer = wire.ask(method, **params)
                wire.close()
                countdown.set(0)
                self.assertIsNone(self.daemon.poll(), f"{method}, allocation {number}: the daemon has ended")
                self.assertIsNotNone(answer, f"{method}, allocation {number}: the connection was given up")
                self.assertNotIn("bad_alloc", json.dumps(answer))
                other.result("version")  # the reserve is taken again with the next request
        other.close()
        wire = Connection(self.socket)
        while wire.result("status")["clients"] != 1:
            pass
        while b"memory was short: the reserve was used, and is there again" not in (self.dir / "log").read_bytes():
            wire.result("version")
        wire.result("job.wait", id=wire.result("step", ticks=10)["job"])
        wire.close()
        self.daemon.terminate()
        self.assertEqual(self.daemon.wait(HANG_S), 0)

    def test_a_limit_of_memory_costs_what_needs_more_and_not_the_rest(self):
        wire = self.start("--clock", "lockstep", "--speed", "max")
        sizes = dict(line.split(":") for line in pathlib.Path(f"/proc/{self.daemon.pid}/status").read_text().splitlines())
        before = resource.prlimit(self.daemon.pid, resource.RLIMIT_AS)
        # What the process has, and no page more.
        resource.prlimit(self.daemon.pid, resource.RLIMIT_AS, (1024 * int(sizes["VmSize"].split()[0]), before[1]))
        for _ in range(4):
            for method, params in self.REQUESTS:
                answer = wire.ask(method, **params)
                self.assertIsNotNone(answer, f"{method}: the connection was given up")
                if method in ("status", "stop"):
                    self.assertIn("result", answer)
                self.assertIsNone(self.daemon.poll(), f"{method}: the daemon has ended")
        resource.prlimit(self.daemon.pid, resource.RLIMIT_AS, before)
        wire.result("plot", name="scene", file="after.png")
        wire.result("job.wait", id=wire.result("step", ticks=10)["job"])
        wire.close()
        self.daemon.terminate()
        self.assertEqual(self.daemon.wait(HANG_S), 0)


class Turns(SystemCase):
    def test_one_client_with_many_lines_does_not_hold_the_others_up(self):
        watcher = self.start("--clock", "lockstep", "--speed", "max")
        watcher.result("subscribe", topic="events")
        many, one = Connection(self.socket), Connection(self.socket)
        many.result("version")
        one.result("version")
        # Both are there when the daemon next looks, the 300 lines first.
        self.daemon.send_signal(signal.SIGSTOP)
        line = {"jsonrpc": "2.0", "method": "noise.set", "params": {"position_m": 0.001}}
        many.socket.sendall(300 * (json.dumps(line) + "\n").encode())
        one.send("noise.set", position_m=0.002)
        self.daemon.send_signal(signal.SIGCONT)
        texts = [watcher.event("noise")["text"] for _ in range(301)]
        others = [i for i, text in enumerate(texts) if text != max(set(texts), key=texts.count)]
        self.assertEqual(len(others), 1, others)
        self.assertLessEqual(others[0], 2 * 32)  # a turn is 32 lines
        for wire in (watcher, many, one):
            wire.close()


if __name__ == "__main__":
    unittest.main()
