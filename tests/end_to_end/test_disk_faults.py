"""A scripted life of the daemon in which the N-th open, write, fsync or rename in the output directory fails: each
request is answered, the daemon lives, and what has its name is whole.

    REGRASP_FAULTS=40 REGRASP_BIN_DIR=build/release/bin REGRASP_SOURCE_DIR=. python3 tests/end_to_end/test_disk_faults.py
tries every N up to 40; the suite a few.
"""

import json
import os
import shutil
import subprocess
import unittest

from harness import BIN, HANG_S, REGRASPD, SOURCE, Case, environment

FAIL_AT = BIN.parent / "tests" / "fail_at.so"
MOST = int(os.environ.get("REGRASP_FAULTS", "0"))


class DiskFaults(Case):
    def life(self, call, number):
        out = self.dir / f"{call}-{number}"
        env = environment(LD_PRELOAD=str(FAIL_AT), FAIL_UNDER=str(out), FAIL_CALL=call, FAIL_AT=str(number))
        daemon = subprocess.Popen([str(REGRASPD), "--socket", str(self.socket), "--output-dir", str(out), "--models-dir", str(SOURCE / "models"),
                                   "--speed", "max", "--paused", "--max-checkpoints", "3"], env=env, stderr=subprocess.DEVNULL)
        self.addCleanup(daemon.kill)
        failures = []

        def ask(*words):
            done = self.regrasp("--timeout", HANG_S, "--json", *words)
            self.assertIn(done.returncode, (0, 5, 6, 74), f"{call} {number}: {words}: {done.stdout}{done.stderr}")
            if done.returncode:
                failures.append(words)
            return json.loads(done.stdout) if done.returncode == 0 else None

        while self.regrasp("status").returncode == 3:
            self.assertIsNone(daemon.poll())
        ask("record", "start", "r.mcap")
        ask("grasp")
        ask("step", "20", "--wait")
        ask("checkpoint", "save", "c")
        ask("plot", "scene")
        ask("step", "20", "--wait")
        ask("record", "stop")
        ask("record", "list")
        listed = ask("checkpoint", "list")
        self.assertIsNotNone(self.json("status"))
        self.assertIsNone(daemon.poll(), f"{call} {number}")
        daemon.terminate()
        self.assertEqual(daemon.wait(HANG_S), 0, f"{call} {number}")
        self.whole(out, listed)
        shutil.rmtree(out, ignore_errors=True)
        return failures

    def whole(self, out, listed):
        files = sorted(os.listdir(out)) if out.exists() else []
        self.assertEqual([f for f in files if f.startswith(".draft")], [])
        if "c.checkpoint" in files:
            lines = (out / "c.checkpoint").read_text(encoding="utf-8")
            self.assertTrue(lines.endswith("\n"))
            for line in lines.splitlines():
                json.loads(line)
            if listed:
                self.assertEqual([c["name"] for c in listed["checkpoints"]], ["c"])
        for file in files:
            if file.endswith(".png"):
                data = (out / file).read_bytes()
                self.assertEqual((data[:4], data[-8:-4]), (b"\x89PNG", b"IEND"))

    def test_the_call_that_fails_is_answered_and_nothing_is_torn(self):
        self.assertTrue(FAIL_AT.exists())
        tried = range(1, MOST + 1) if MOST else (1, 2, 4)
        failed = 0
        for call in ("open", "write", "fsync", "rename"):
            for number in tried:
                failed += bool(self.life(call, number))
        self.assertGreater(failed, 0)  # the faults did arrive


if __name__ == "__main__":
    unittest.main()
