"""The Python module: its methods are those of the daemon, the same lines give the same figures, run files are read."""

import json
import os
import subprocess
import sys
import unittest

from harness import BIN, HANG_S, SOURCE, Case, DaemonCase, environment

os.environ["REGRASP_BIN_DIR"] = str(BIN)
sys.path.insert(0, str(SOURCE / "cli" / "python"))
import regrasp  # noqa: E402  (found through the line above)
from regrasp import runs  # noqa: E402


class Methods(DaemonCase):
    def test_methods_are_made_from_the_table(self):
        described = self.expect(0, "--json", "call", "describe").stdout
        made = subprocess.run([sys.executable, SOURCE / "cli/python/make_methods.py"], input=described, capture_output=True, text=True, check=True)
        self.assertEqual((SOURCE / "cli/python/regrasp/methods.py").read_text(), made.stdout,
                         "run: regrasp --json call describe | python3 cli/python/make_methods.py > cli/python/regrasp/methods.py")

    def test_every_method_is_there(self):
        names = {m["name"] for m in self.json("call", "describe")["methods"]} - {"hello", "subscribe", "unsubscribe"}
        for name in names:
            self.assertTrue(callable(getattr(regrasp.Hand, name.replace(".", "_"), None)), name)

    def test_a_refusal_tells_cause_and_hint(self):
        with regrasp.connect(self.socket) as hand:
            with self.assertRaises(regrasp.Error) as caught:
                hand.explore("ring")
        self.assertEqual(caught.exception.code, -32002)
        self.assertIn("grasp", caught.exception.hint)

    def test_streams_are_iterators(self):
        with regrasp.connect(self.socket) as hand:
            samples = list(hand.watch("quality", rate_hz=50, count=3))
        self.assertEqual([s["seq"] for s in samples], sorted(s["seq"] for s in samples))
        self.assertIn("fingers", samples[0])


class Private(Case):
    def figures(self):
        with regrasp.start(seed=1) as hand:
            hand.grasp().done()
            job = hand.explore("ring", max_cycles=1500).wait()
            return job["cycles"], job["phi_initial"], job["phi_final"], hand.status()["state_hash"]

    def test_the_same_lines_give_the_same_figures(self):
        first = self.figures()
        self.assertEqual(first, self.figures())
        self.assertGreaterEqual(first[0], 1500)

    def test_a_wrong_option_is_told_in_the_daemons_words(self):
        with self.assertRaisesRegex(RuntimeError, "no_such_object"):
            regrasp.start(object="no_such_object")

    def test_a_refused_setting_leaves_nothing_open(self):
        before = os.listdir("/proc/self/fd")
        with self.assertRaisesRegex(regrasp.Error, "walk"):
            regrasp.start(gait__mode="walk")
        self.assertEqual(os.listdir("/proc/self/fd"), before)

    def test_settings_hold_beside_a_preset(self):
        with regrasp.start(gait__preset="paper", gait__margin_min=0.05) as hand:
            changed = hand.status()["changed_parameters"]
        self.assertEqual((changed["gait.margin_min"], changed["gait.mode"]), (0.05, "exploring"))

    def test_study(self):
        env = environment(PYTHONPATH=str(SOURCE / "cli" / "python"), REGRASP_BIN_DIR=str(BIN))
        ran = subprocess.run([sys.executable, SOURCE / "examples/study.py", "1"], env=env, capture_output=True, text=True, timeout=HANG_S, check=False)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        self.assertRegex(ran.stdout, r"median difference [+-]\d+\.\d\d percentage points, n = 1")

    def test_notebook_runs(self):
        book = json.loads((SOURCE / "examples/study.ipynb").read_text())
        source = "\n".join("".join(cell["source"]) for cell in book["cells"] if cell["cell_type"] == "code")
        env = environment(PYTHONPATH=str(SOURCE / "cli" / "python"), REGRASP_BIN_DIR=str(BIN))
        ran = subprocess.run([sys.executable, "-c", source], cwd=self.dir, env=env, capture_output=True, text=True, timeout=HANG_S, check=False)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        self.assertIn("phi", ran.stdout)


class RunFiles(Case):
    def setUp(self):
        super().setUp()
        with regrasp.start(seed=1, output_dir=self.dir / "out") as hand:
            hand.record_start(file="run.mcap")
            hand.grasp().done()
            self.truth = hand.truth()
            hand.record_stop()
        self.file = self.dir / "out" / "run.mcap"

    def test_load_agrees_with_export(self):
        run = runs.load(self.file)
        exported = subprocess.run([BIN / "regrasp", "--json", "export", str(self.file), "--format", "csv", "-o", str(self.dir / "csv")],
                                  env=environment(), capture_output=True, text=True, timeout=HANG_S, check=False)
        self.assertEqual(exported.returncode, 0, exported.stderr)
        rows = (self.dir / "csv" / "state.csv").read_text().splitlines()
        self.assertEqual(len(run["state"]), len(rows) - 1)
        self.assertGreater(len(run["joints"]), 20)

    def test_a_damaged_chunk_is_named(self):
        data = bytearray(self.file.read_bytes())
        data[len(data) // 2] ^= 1
        broken = self.dir / "broken.mcap"
        broken.write_bytes(data)
        with self.assertRaisesRegex(runs.RunFileError, "offset"):
            runs.load(broken)

    def test_what_is_no_run_file_is_refused(self):
        for content in (b"", b"hello", b"\x89MCAP0\r\n" + b"\x06" + b"\xff" * 8):
            path = self.dir / "bad.mcap"
            path.write_bytes(content)
            with self.assertRaises(runs.RunFileError):
                runs.load(path)


if __name__ == "__main__":
    unittest.main()
