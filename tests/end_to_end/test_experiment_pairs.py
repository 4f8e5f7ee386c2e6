"""`regrasp experiment`: the same seeds under several settings, each as if it were alone."""

import json
import shlex
import unittest

from experiment_case import ExperimentCase
from harness import SOURCE


class Pairs(ExperimentCase):
    """The same seeds under several settings."""

    ONE = ["exploration", "--finger", "ring", "--seed", "5", "--rays", "0", "--workers", "1", "--models-dir", SOURCE / "models"]

    def test_an_experiment_grows(self):
        both = ["--estimator", "least_squares,secant"]
        self.run_experiment(*self.ONE, *both, "-n", "3", "-o", self.dir / "at once")
        self.run_experiment(*self.ONE, *both, "-n", "2", "-o", self.dir / "grown")
        kept = (self.dir / "grown" / "trials.jsonl").read_bytes()
        self.assertIn("2 of 3 are there already", self.run_experiment(*self.ONE, *both, "-n", "3", "-o", self.dir / "grown").stderr)
        self.assertTrue((self.dir / "grown" / "trials.jsonl").read_bytes().startswith(kept))
        self.assert_same_results("at once", "grown")
        self.assertIn("seeds was 3, is 2", self.refused_experiment(5, *self.ONE, *both, "-n", "2", "-o", self.dir / "grown"))

        # The differences are those of the rows, paired by seed.
        (comparison,) = self.summary("grown")["comparisons"]
        self.assertEqual((comparison["what"], comparison["base"], comparison["other"], comparison["pairs"]), ("estimator", "least_squares", "secant", 3))
        final = {(row["estimator"], row["seed"]): float(row["phi_true_final"]) for row in self.rows("grown")}
        differences = [final["secant", seed] - final["least_squares", seed] for seed in ("5", "6", "7")]
        measure = comparison["measures"]["phi_true_final"]
        self.assertAlmostEqual(measure["difference"], sum(differences) / 3, delta=1e-12)
        self.assertEqual((measure["low"], measure["high"]), (None, None))  # three pairs have no interval
        # Of three signs alike one in four says as much; otherwise p is larger.
        self.assertGreaterEqual(measure["p"], 0.25)
        # Tables as a paper takes them, of a finished directory.
        latex = self.run_experiment(*self.ONE, *both, "-n", "3", "--format", "latex", "-o", self.dir / "grown").stdout
        self.assertEqual(latex.count("\\begin{tabular}"), latex.count("\\bottomrule"))
        self.assertIn("least\\_squares", latex)
        self.assertRegex(latex, r"[ (]\$-\$\d")  # a minus, where a hyphen would be printed
        self.assertNotRegex(latex, r"[ (]-\d")
        comparison_table = latex[latex.index("difference (95"):]
        self.assertIn("$\\varphi$ rose", comparison_table)
        self.assertNotIn(" to ", comparison_table)
        advice = self.run_experiment(*self.ONE, *both, "-n", "3", "--format", "markdown", "--precision", "0.05", "-o", self.dir / "grown").stdout
        self.assertIn("| secant | least_squares |", advice)
        self.assertIn("n for ±0.05", advice)
        self.assertNotRegex(advice, r"secant against least_squares \| 3 \| 2 \|")
        # All pairs agree that phi rose: as many as Wilson's interval of none that differs asks, 3.84 / 0.05 - 3.84.
        self.assertEqual(comparison["measures"]["rose"]["sd"], 0)
        self.assertIn("φ rose %: secant against least_squares | 3 | 73 |", advice)

    def test_a_sweep_makes_a_case_of_each_value(self):
        self.run_experiment(*self.ONE, "-n", "1", "--set", "object.friction=0.7,0.8", "--set", "gravity=0,0,-9.81", "-o", self.dir / "sweep")
        self.assertEqual([row["case"] for row in self.rows("sweep")], ["object.friction=0.7", "object.friction=0.8"])
        (comparison,) = self.summary("sweep")["comparisons"]
        self.assertEqual((comparison["base"], comparison["other"]), ("object.friction=0.7", "object.friction=0.8"))
        plan = json.loads((self.dir / "sweep" / "experiment.json").read_text())
        self.assertEqual(plan["parameters"]["object.friction=0.7"]["object.friction"], 0.7)
        words = shlex.split(self.rows("sweep")[0]["command"])
        words[words.index("-o") + 1] = self.dir / "single"
        self.run_experiment(*words[2:])
        self.assertEqual(self.rows("single"), self.rows("sweep")[:1])
        self.refused_experiment(2, *self.ONE, "--set", "object.friction=0.7,0.7", "-o", self.dir / "none")

    def test_phi_of_two_criteria_is_not_compared(self):
        words = [*self.ONE, "-n", "1", "--case", "phi:", "--case", "stability: criterion=stability", "--case", "again: object.friction=0.7", "-o", self.dir / "criteria"]
        text = self.run_experiment(*words).stdout
        self.assertIn("φ is not compared between cases of different criteria", text)
        stability, again = self.summary("criteria")["comparisons"]
        self.assertEqual((stability["other"], stability["left_out"]), ("stability", ["phi_true_final", "phi_true_gain"]))
        self.assertEqual(sorted(stability["measures"]), ["cycles", "rose"])
        self.assertEqual(sorted(again["measures"]), ["cycles", "phi_true_final", "phi_true_gain", "rose"])
        self.assertNotIn("left_out", again)
        self.assertIn("\n% $\\varphi$ is not compared", self.run_experiment(*words, "--format", "latex").stdout)

    def test_a_zoo_pairs_gaits_on_every_object(self):
        words = ["zoo", "--objects", "egg,sphere", "-n", "1", "--turns", "0.05", "--models-dir", SOURCE / "models"]
        self.run_experiment(*words, "-o", self.dir / "zoo")
        self.assertEqual([row["case"] for row in self.rows("zoo")], ["egg, planned", "egg, returning", "sphere, planned", "sphere, returning"])
        comparisons = self.summary("zoo")["comparisons"]
        self.assertEqual([(c.get("case"), c["base"], c["other"], c["pairs"]) for c in comparisons],
                         [(None, "egg, planned", "egg, returning", 1), (None, "sphere, planned", "sphere, returning", 1), ("all", "planned", "returning", 2)])
        self.assertIn("'unicorn' is none of", self.refused_experiment(2, "zoo", "--objects", "unicorn", "-o", self.dir / "none"))

    def test_a_prediction_looks_at_gaits_in_danger(self):
        words = ["prediction", "--objects", "sphere", "--noise", "coarse", "-n", "1", "--turns", "0.1", "--models-dir", SOURCE / "models"]
        self.run_experiment(*words, "-o", self.dir / "foretold")
        self.assertEqual([row["case"] for row in self.rows("foretold")], ["sphere, as it is", "sphere, pushed", "sphere, slippery"])
        self.assertNotIn("comparisons", self.summary("foretold"))
        prediction = self.summary("foretold")["prediction"]
        self.assertEqual(prediction["runs"], 3)
        self.assertGreater(prediction["looks"], 30)
        self.assertGreater(prediction["windows_holding"], 0)
        for predictor in prediction["predictors"]:
            self.assertEqual((predictor["low"], predictor["behind_high"]), (None, None))  # of three runs
        # What the run gave does not depend on being looked at.
        words = shlex.split(self.rows("foretold")[0]["command"])
        words[words.index("-o") + 1] = self.dir / "single"
        self.run_experiment(*words[2:])
        for column in ("outcome", "end_tick", "angle_rad", "max_tilt_rad", "slips"):
            self.assertEqual(self.rows("single")[0][column], self.rows("foretold")[0][column])


class Cases(ExperimentCase):
    TURN = ["rotation", "--angle", "15", "-n", "1", "--models-dir", SOURCE / "models"]
    CASES = ["--case", "as it is:", "--case", "egg, pushed: object=egg push=0.5 object.mass_kg=0.05", "--case", "tilt=45"]

    def test_cases_do_not_touch_each_other(self):
        self.run_experiment(*self.TURN, *self.CASES, "--workers", "1", "-o", self.dir / "one")
        self.run_experiment(*self.TURN, *self.CASES, "--workers", "2", "-o", self.dir / "two")
        self.assert_same_results("one", "two")
        rows = self.rows("one")
        self.assertEqual([(row["case"], row["object"]) for row in rows], [("as it is", "sphere"), ("egg, pushed", "egg"), ("tilt=45", "sphere")])
        self.assertEqual(len({row["state_hash"] for row in rows}), 3)
        self.assertEqual([group["case"] for group in self.summary("one")["groups"]], [row["case"] for row in rows])
        # A case that changes nothing is the experiment without cases; --tilt is the case.
        for words, row in [([], rows[0]), (["--tilt", "45"], rows[2])]:
            self.run_experiment(*self.TURN, *words, "-o", self.dir / ("alone" + "".join(words)))
            (alone,) = self.rows("alone" + "".join(words))
            self.assertEqual(alone["state_hash"], row["state_hash"])
        words = shlex.split(rows[1]["command"])
        words[words.index("-o") + 1] = self.dir / "single"
        self.run_experiment(*words[2:])
        self.assertEqual(self.rows("single"), [rows[1]])

    def test_what_a_case_gives_takes_the_place_of_what_holds_for_all(self):
        common = ["--push", "0.5", "--set", "object.friction=0.5", "--set", "gravity=0,0,-9.81"]
        self.run_experiment(*self.TURN, *common, "--case", "own: push=0 object.friction=0.6 tilt=45", "--case", "common:", "-o", self.dir / "both")
        self.run_experiment(*self.TURN, "--set", "object.friction=0.6", "--tilt", "45", "-o", self.dir / "own")
        self.run_experiment(*self.TURN, *common, "-o", self.dir / "common")
        self.assertEqual([row["state_hash"] for row in self.rows("both")], [self.rows(name)[0]["state_hash"] for name in ("own", "common")])

    def test_bad_cases_make_no_directory(self):
        out = ["--models-dir", SOURCE / "models", "-o", self.dir / "none"]
        for words, part in [(["rotation", "--case", "a: tilt"], "'tilt' is not NAME=VALUE"), (["rotation", "--case", ": tilt=3"], "no name"),
                            (["rotation", "--case", "a:", "--case", "a: tilt=3"], "two cases have the name 'a'"),
                            (["exploration", "--case", "a: push=1"], "push and turns are for rotations"), (["rotation", "--push", "-1"], "--push"),
                            (["rotation", "--case", "a: push=-1"], "push -1: allowed are 0 to 100 N"), (["rotation", "--case", "a: push=1000"], "push 1000: allowed are"),
                            (["rotation", "--case", "a: tilt=900"], "tilt 900: allowed are -180 to 180 deg"),
                            (["rotation", "--case", "a:", "--case", "b: turns=5000"], "turns 5000: allowed are -1000 to 1000"),
                            (["rotation", "--case", "a: tilt=1 tilt=2"], "tilt is given twice"), (["rotation", "--case", "a: object="], "object= has no value"),
                            (["exploration", "--case", "a: criterion=manipulability,reserve"], "a case has one criterion")]:
            with self.subTest(words):
                self.assertIn(part, self.refused_experiment(2, *words, *out))
        self.assertIn("gait.mod", self.refused_experiment(6, "rotation", "--case", "a:", "--case", "b: gait.mod=3", *out))
        self.assertFalse((self.dir / "none").exists())


if __name__ == "__main__":
    unittest.main()
