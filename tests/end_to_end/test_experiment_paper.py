"""`regrasp experiment paper`: all of it by one command."""

import contextlib
import pathlib
import re
import signal
import subprocess
import time
import unittest

from experiment_case import ExperimentCase
from harness import HANG_S, REGRASP, SOURCE, environment


class Paper(ExperimentCase):
    SMALL_PAPER = ["paper", "-n", "1", "--repeats", "1", "--turns", "0.1", "--rays", "2", "--finger", "ring", "--models-dir", SOURCE / "models"]

    def test_every_part_is_accepted_before_the_first_runs(self):
        words = [REGRASP, "experiment", *self.SMALL_PAPER, "-o", self.dir / "cut"]
        with subprocess.Popen(list(map(str, words)), env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            first = process.stderr.readline()
            self.assertEqual(first, "exploration (1 of 13)\n")
            process.send_signal(signal.SIGINT)
            _, stderr = process.communicate(timeout=HANG_S)
        self.assertEqual(process.returncode, 130, stderr)

    def test_interrupted_while_daemons_start_it_leaves_none(self):
        (self.dir / "models").symlink_to(SOURCE / "models")  # by which its daemons are known
        words = [REGRASP, "experiment", *self.SMALL_PAPER[:-1], self.dir / "models", "-o", self.dir / "cut"]
        for wait_s in (0, 0.002, 0.01, 0.05):
            with subprocess.Popen(list(map(str, words)), env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
                process.stderr.readline()
                time.sleep(wait_s)
                process.send_signal(signal.SIGINT)
                process.communicate(timeout=HANG_S)
            self.assertEqual(process.returncode, 130)
            self.assertEqual(self.daemons(), [], wait_s)

    def daemons(self):
        found = []
        for command in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
            with contextlib.suppress(OSError):
                if str(self.dir).encode() in command.read_bytes():
                    found.append(command.read_text().split("\0"))
        return found

    def test_one_command_writes_the_page(self):
        self.run_experiment(*self.SMALL_PAPER, "--only-paper", "-o", self.dir)
        page = (self.dir / "reproduction.md").read_text()
        for picture in re.findall(r"\]\((reproduction/[^)]*\.png)\)", page):
            self.assertTrue((self.dir / picture).read_bytes().startswith(b"\x89PNG"), picture)
        for figure in ("figure1.png", "figure2.png", "figure3a.png", "figure3b.png", "sweep/summary.png"):
            self.assertIn(f"(reproduction/{figure})", page)
        for link in re.findall(r"\]\(([^)]*)\)", page):
            self.assertTrue((self.dir / link).exists(), link)
        self.assertIn("(docs/paper_map.md of the source)", page)
        self.assertEqual(list(self.dir.rglob("*.checkpoint")), [], "what its trials began from is of no use to anybody")
        claims = [line.split(" | ") for line in page.splitlines() if line.startswith("| ") and line.endswith((" yes |", " partly |", " no |"))]
        self.assertGreaterEqual(len(claims), 12)
        # The page's own numbers are those of its summaries.
        group = next(g for g in self.summary("reproduction/exploration")["groups"] if g["estimator"] == "least_squares")
        rose = group["counts"]["rose"]["k"]
        self.assertIn(f"{rose}/1", next(c for c in claims if "Alg. 1" in c[0])[1])


if __name__ == "__main__":
    unittest.main()
