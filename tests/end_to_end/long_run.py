"""The long proof of exact replay, not part of ./check (a few minutes):

    REGRASP_BIN_DIR=build/release/bin REGRASP_SOURCE_DIR=. python3 tests/end_to_end/long_run.py

Five minutes of simulated time with explorations, rotations, pushes and live changes of noise, recorded while it
runs freely; replayed by another process, at another speed. Then 100 branches of one checkpoint with one seed,
and 100 with others."""

import json
import unittest

from harness import DaemonCase, Wire

FINGERS = ["first", "middle", "ring", "little", "thumb"]
PRESETS = ["paper", "fine", "off", "paper"]


class Caller(Wire):
    """Answers in order."""

    def ask(self, method, **params):
        self.write(self.request(method, params))
        answer = json.loads(self.lines.readline())
        return answer.get("result"), answer.get("error")

    def __call__(self, method, **params):
        result, error = self.ask(method, **params)
        assert error is None, (method, params, error)
        return result

    def wait(self, result):
        return self("job.wait", id=result["job"])



class LongRun(DaemonCase):
    def setUp(self):
        super().setUp()
        self.wire = Caller(self.socket)
        self.addCleanup(self.wire.close)

    def test_five_minutes_replay_to_the_bit(self):
        wire = self.wire
        path = wire("record.start", file="long.mcap")["path"]
        jobs = {}
        turn = 0
        while wire("status")["time_s"] < 300:
            status = wire("status")
            if status["state"] in ("dropped", "faulted"):
                wire("reset", seed=turn + 2)
            elif status["state"] == "idle":
                wire.wait(wire("grasp"))
            else:
                wire("noise.set", preset=PRESETS[turn % len(PRESETS)])
                if turn % 2:
                    started, _ = wire.ask("rotate", angle_rad=0.5 if turn % 4 == 1 else -0.5, axis=[0, 0, 1])
                else:
                    started, _ = wire.ask("explore", finger=FINGERS[turn // 2 % 5], seed=turn, max_cycles=4000)
                wire.ask("push", force_n=[0.1, 0, 0.1], duration_s=0.05)
                wire.ask("noise.set", position_m=0.0007)
                if started:
                    record = wire.wait(started)
                    jobs[record["method"]] = jobs.get(record["method"], 0) + 1
            turn += 1
        stopped = wire("record.stop")
        print(f"\nrecorded {stopped['bytes'] / 1e6:.1f} MB, jobs {jobs}, dropped samples {stopped['dropped']}")
        self.assertGreater(jobs["explore"], 5)
        self.assertGreater(jobs["rotate"], 5)
        for speed in ("max", "40"):
            replay = self.json("replay", path, "--speed", speed)
            print(f"replay --speed {speed}: {replay['commands']} commands, {replay['time_s']:.1f} s, "
                  f"{replay['states_compared']} states, identical: {replay['identical']}")
            self.assertTrue(replay["identical"])

    def test_a_hundred_branches(self):
        wire = self.wire
        wire.wait(wire("grasp"))
        wire("pause")
        wire("checkpoint.save", name="start")

        def branch(**seed):
            self.assertEqual(wire.wait(wire("checkpoint.restore", name="start", **seed))["state"], "done")
            wire.wait(wire("step", ticks=300))
            return wire("status")["state_hash"]

        identical = {branch() for _ in range(100)}
        same = {branch(seed=7) for _ in range(100)}
        other = {branch(seed=seed) for seed in range(100, 200)}
        print(f"\n100 branches without a seed: {len(identical)} hash; with seed 7: {len(same)}; with 100 seeds: {len(other)}")
        self.assertEqual((len(identical), len(same), len(other)), (1, 1, 100))
        self.assertEqual(len(identical | same | other), 102)


if __name__ == "__main__":
    unittest.main()
