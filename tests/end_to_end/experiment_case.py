"""What tests of `regrasp experiment` share."""

import csv
import json

from harness import SOURCE, Case

# Two fingers and two seeds, no map: four trials of about half a second.
SMALL = ["--finger", "first,ring", "-n", "2", "--seed", "7", "--rays", "0", "--models-dir", SOURCE / "models"]
FILES = ["trials.csv", "summary.json"]


class ExperimentCase(Case):
    def run_experiment(self, *words, code=0):
        done = self.regrasp("experiment", *words)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def explore(self, name, *words, code=0):
        return self.run_experiment("exploration", *SMALL, *words, "-o", self.dir / name, code=code)

    def rows(self, name):
        with open(self.dir / name / "trials.csv", newline="") as file:
            return list(csv.DictReader(file))

    def summary(self, name):
        return json.loads((self.dir / name / "summary.json").read_text())

    def assert_same_results(self, one, other):
        for file in FILES:
            self.assertEqual((self.dir / one / file).read_bytes(), (self.dir / other / file).read_bytes(), file)

    def refused_experiment(self, code, *words):
        done = self.run_experiment(*words, code=code)
        self.assertEqual(done.stdout, "")
        lines = done.stderr.splitlines()
        self.assertTrue(lines[-2].startswith("regrasp: "), done.stderr)
        self.assertTrue(lines[-1].startswith("  try: "), done.stderr)
        return lines[-2]
