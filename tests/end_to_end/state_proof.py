"""The long proof of saved states, not part of ./check (some minutes):

    REGRASP_BIN_DIR=build/release/bin REGRASP_SOURCE_DIR=. python3 tests/end_to_end/state_proof.py

A run with grasp, explorations, rotations, pushes and changes of noise, saved at 200 random ticks. Another process
loads each of them and goes on for 5 s of simulated time: the same state hashes as the run that never stopped; and
for every tenth, as the commands executed again from tick 0."""

import os
import random
import time
import unittest

from harness import DaemonCase
from long_run import Caller

SAVES = int(os.environ.get("SAVES", "200"))
GO_ON = 5000  # ticks
LENGTH = 60000  # ticks
# What happens, by tick; jobs that are refused because another runs are part of it.
SCRIPT = {
    0: [("grasp", {})],
    3000: [("explore", {"finger": "ring", "seed": 3})],
    6000: [("noise.set", {"preset": "coarse"}), ("push", {"force_n": [0.2, 0, 0], "duration_s": 0.2})],
    12000: [("stop", {}), ("noise.set", {"preset": "paper"})],
    15000: [("rotate", {"turns": 1, "axis": [0, 0, -1]})],
    22000: [("push", {"force_n": [0, 0.2, 0], "duration_s": 0.3})],
    30000: [("stop", {})],
    31000: [("param.set", {"name": "gait.mode", "value": 0})],
    32000: [("rotate", {"continuous": True, "axis": [0, 0, -1]})],
    44000: [("noise.set", {"preset": "fine"})],
    50000: [("stop", {})],
    52000: [("move", {"offset_m": [0.003, 0, 0.002]})],
}


class StateProof(DaemonCase):
    ARGUMENTS = ["--speed", "max", "--seed", "1", "--paused"]

    def step_to(self, wire, tick):
        """Steps, giving the commands of the script at their ticks."""
        now = wire("status")["tick"]
        for at in sorted(t for t in SCRIPT if now <= t < tick):
            if at > now:
                wire.wait(wire("step", ticks=at - now))
            now = at
            for method, params in SCRIPT[at]:
                wire.ask(method, **params)  # a refusal is the same in every run
        if tick > now:
            wire.wait(wire("step", ticks=tick - now))
        return wire("status")["state_hash"]

    def test_a_saved_state_goes_on_to_the_same_bits_in_another_process(self):
        # A command at a tick at which a state is saved would be in the state in one run and after it in the other.
        ticks = random.Random(5).sample([t for t in range(1, LENGTH - GO_ON) if t not in SCRIPT], SAVES)
        wanted = sorted(set(ticks) | {t + GO_ON for t in ticks})
        hashes = {}
        wire = Caller(self.socket)
        for tick in wanted:
            hashes[tick] = self.step_to(wire, tick)
            if tick in set(ticks):
                wire("checkpoint.save", name=f"t{tick}")
        wire.close()
        self.expect(0, "down")
        self.start_daemon()  # the same directory, another process
        wire = Caller(self.socket)
        times = []
        for n, tick in enumerate(sorted(ticks)):
            began = time.monotonic()
            answer = wire("checkpoint.restore", name=f"t{tick}")
            self.assertEqual((answer["from"], wire.wait(answer)["state"]), ("state", "done"))
            times.append(time.monotonic() - began)
            self.assertEqual(wire("status")["state_hash"], hashes[tick], tick)
            self.assertEqual(self.step_to(wire, tick + GO_ON), hashes[tick + GO_ON], tick)
            if n % 10 == 0:
                again = wire("checkpoint.restore", name=f"t{tick}", reexecute=True)
                self.assertEqual((again["from"], wire.wait(again)["state"]), ("commands", "done"))
                self.assertEqual(wire("status")["state_hash"], hashes[tick], tick)
        times.sort()
        print(f"{len(ticks)} states; restored, seen from the client: median {1e3 * times[len(times) // 2]:.1f} ms, "
              f"largest {1e3 * times[-1]:.1f} ms")
        wire.close()


if __name__ == "__main__":
    unittest.main()
