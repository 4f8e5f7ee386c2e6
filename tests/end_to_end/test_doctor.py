"""`regrasp doctor`: what it says of faults, and how it ends."""

import json
import os
import signal
import subprocess
import unittest

from harness import SOURCE, Case, FakeDaemon, HANG_S, REGRASP, environment, wait_until_it_minds


class Doctor(Case):
    def check(self, name, **env):
        """What it finds of one thing."""
        done = self.regrasp("--json", "--timeout", "1", "doctor", env=environment(**env))
        self.assertEqual(done.stderr, "")
        return next(check for check in json.loads(done.stdout)["checks"] if check["name"] == name)

    def test_a_signal_ends_it(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGQUIT):
            with self.subTest(number):
                process = subprocess.Popen([REGRASP, "-s", self.socket, "doctor"], env=environment(), stdout=subprocess.PIPE,
                                           stderr=subprocess.PIPE, text=True)
                wait_until_it_minds(process, number)
                process.send_signal(number)
                out, err = process.communicate(timeout=HANG_S)
                self.assertEqual((process.returncode, out, err), (130, "", "regrasp: interrupted\n"))

    def test_a_hand_that_is_not_there_is_told_in_words(self):
        (self.dir / "bad.toml").write_text('hand = "nosuch"\n')
        finding = self.check("stepper", REGRASP_CONFIG=str(self.dir / "bad.toml"))["finding"]
        self.assertTrue(finding.startswith('there is no model "nosuch"'), finding)

    def test_it_does_not_recommend_itself(self):
        for reply in (None, b"220 hello\n"):
            with self.subTest(reply):
                daemon = FakeDaemon(self.socket, {"hello": lambda _, reply=reply: reply})
                check = self.check("daemon")
                daemon.close()
                os.unlink(self.socket)
                self.assertFalse(check["ok"])
                self.assertNotEqual(check["next"], "")
                self.assertNotIn("doctor", check["next"])

    def test_the_output_directory_is_named_and_tried(self):
        self.assertEqual(self.check("output", HOME=str(self.dir))["finding"], f"{self.dir}/.local/state/regrasp")
        (self.dir / "file").write_text("")
        check = self.check("output", XDG_STATE_HOME=f"{self.dir}/file/state")
        self.assertFalse(check["ok"])
        self.assertIn(f"{self.dir}/file/state/regrasp", check["finding"])
        self.assertEqual(check["next"], "regrasp up --output-dir DIR")
        for directory in ("/proc/xx", self.dir / "file"):
            cause, _ = self.refused(74, "up", "--output-dir", directory)
            self.assertIn(f"output_dir {directory}: ", cause)
        # Where nobody has named one, the hand moves, and status warns.
        self.addCleanup(self.regrasp, "down")
        up = self.expect(0, "up", "--speed", "max", "--models-dir", SOURCE / "models", env=environment(XDG_STATE_HOME=f"{self.dir}/file/state"))
        self.assertIn(f"warning: output_dir {self.dir}/file/state/regrasp: {self.dir}/file is not a directory", up.stdout)
        self.assertEqual(len(self.json("status")["warnings"]), 1)
        # It is the daemon's directory that counts, whatever this one's would be.
        self.assertIn(f"{self.dir}/file/state", self.check("output", HOME=str(self.dir))["finding"])


if __name__ == "__main__":
    unittest.main()
