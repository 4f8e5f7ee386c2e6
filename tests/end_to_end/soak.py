"""A daemon that people use for a long time: grasps, explorations, turns, drops, recordings, pictures, checkpoints, a random
client, clients that leave in the middle. Its memory and its descriptors must stay what they were.

    REGRASP_BIN_DIR=build/release/bin REGRASP_SOURCE_DIR=. python3 tests/end_to_end/soak.py [MINUTES]

Prints a line per sample and fails when memory grew by more than 5 MB after the first quarter of the time, when the number
of descriptors or of threads changed, or when a request was answered wrongly.
"""

import os
import pathlib
import random
import socket
import statistics
import struct
import sys
import time
import unittest

from harness import DaemonCase
from test_answers import Client, request

MINUTES = float(sys.argv.pop() if len(sys.argv) > 1 and sys.argv[-1].replace(".", "").isdigit() else 30)
MOST_GROWTH_KB = 5 * 1024


class Soak(DaemonCase):
    ARGUMENTS = ["--speed", "max", "--seed", "1", "--clock", "lockstep"]

    def look(self):
        """Resident memory [kB], descriptors and threads of the daemon."""
        status = pathlib.Path(f"/proc/{self.pid}/status").read_text(encoding="utf-8")
        resident = int(next(line for line in status.splitlines() if line.startswith("VmRSS:")).split()[1])
        return resident, len(os.listdir(f"/proc/{self.pid}/fd")), len(os.listdir(f"/proc/{self.pid}/task"))

    def job(self, client, method, **params):
        answer = client.ask(method, **params)
        if "result" in answer:
            client.ask("job.wait", id=answer["result"]["job"])

    def cycle(self, r, number):
        """One user's hour in a few seconds."""
        client = Client(self.socket)
        client.ask("reset", seed=r.randint(0, 99), object=r.choice(["sphere", "cube_40mm"]))
        client.ask("resume")
        client.ask("record.start", file="soak.mcap")
        self.job(client, "grasp")
        self.job(client, "explore", finger=r.choice(["first", "middle", "ring", "little"]), max_cycles=3)
        self.job(client, "rotate", angle_rad=0.1)
        client.ask("checkpoint.save", name="soak")
        client.ask("plot", name="scene", file="soak.png", overwrite=True)
        self.job(client, "checkpoint.restore", name="soak", seed=number)
        if number % 3 == 0:
            client.ask("push", force_n=[0, 0, -50], duration_s=0.2)
            self.job(client, "grasp")
        client.ask("record.stop")
        (self.dir / "out" / "soak.mcap").unlink(missing_ok=True)
        client.close()
        for _ in range(4):  # who leaves with answers open
            leaves = Client(self.socket)
            leaves.send([request(r) for _ in range(50)])
            leaves.close()
        stays = Client(self.socket)
        stays.send([request(r) for _ in range(100)])
        stays.read_all()
        stays.ask("record.stop")
        for file in (self.dir / "out").glob("r*.mcap"):
            file.unlink()
        stays.ask("reset", seed=1)
        while stays.ask("status")["result"]["clients"] != 1:
            pass
        stays.close()

    def test_nothing_grows(self):
        client = Client(self.socket)
        self.pid = struct.unpack("3i", client.socket.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12))[0]
        client.close()
        r = random.Random(7)
        start = time.monotonic()
        samples = []
        number = 0
        while time.monotonic() - start < 60 * MINUTES:
            number += 1
            self.cycle(r, number)
            elapsed = time.monotonic() - start
            samples.append((elapsed, *self.look()))
            if number % 10 == 1:
                print(f"{elapsed:7.0f} s  cycle {number:4}  {samples[-1][1]} kB, {samples[-1][2]} descriptors, {samples[-1][3]} threads", flush=True)
        settled = [s for s in samples if s[0] > 15 * MINUTES]
        tenth = max(1, len(settled) // 10)
        first = statistics.median(s[1] for s in settled[:tenth])
        last = statistics.median(s[1] for s in settled[-tenth:])
        print(f"{number} cycles in {samples[-1][0]:.0f} s: {first:.0f} to {last:.0f} kB, descriptors {sorted({s[2] for s in settled})}, "
              f"threads {sorted({s[3] for s in settled})}")
        self.assertLess(last - first, MOST_GROWTH_KB)
        quarter = max(1, len(settled) // 4)  # some are open for a moment
        for what in (2, 3):
            self.assertEqual(max(s[what] for s in settled[:quarter]), max(s[what] for s in settled[-quarter:]))


if __name__ == "__main__":
    unittest.main()
