"""`regrasp experiment`: results that do not depend on who computes them, in which order, or in how many goes."""

import contextlib
import csv
import json
import math
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import time
import unittest

from harness import HANG_S, REGRASP, SOURCE, Case, Terminal, environment

# Two fingers and two seeds, no map: four trials of about half a second.
SMALL = ["--finger", "first,ring", "-n", "2", "--seed", "7", "--rays", "0", "--models-dir", SOURCE / "models"]
FILES = ["trials.csv", "summary.json"]


# A `regraspd` that hands everything to the real one, but says that the run of seed 6 has faulted once it explores.
FAULTY = r"""#!/usr/bin/python3
import json, os, socket, subprocess, sys, time
path = sys.argv[sys.argv.index("--socket") + 1]
arguments = [path + ".real" if word == path else word for word in sys.argv[1:]]
daemon = subprocess.Popen(["REAL", *arguments])
listener = socket.socket(socket.AF_UNIX)
while not os.path.exists(path + ".real") and daemon.poll() is None:
    time.sleep(0.01)
listener.bind(path)
listener.listen()
seed, faulted = None, False
while daemon.poll() is None:
    client, _ = listener.accept()
    real = socket.socket(socket.AF_UNIX)
    real.connect(path + ".real")
    answers = real.makefile()
    for line in client.makefile():
        request = json.loads(line)
        method = request["method"]
        if method == "reset":
            seed, faulted = request.get("params", {}).get("seed"), False
        if method == "explore" and seed == 6:
            faulted = True
        if faulted and method not in ("status", "events", "truth", "pause", "param.get", "noise.get"):
            answer = {"jsonrpc": "2.0", "id": request["id"], "error": {"code": -32006, "message": "the simulation has stopped on a fault"}}
        else:
            real.sendall(line.encode())
            answer = json.loads(answers.readline())
            if faulted and method == "status":
                answer["result"]["state"] = "faulted"
        client.sendall((json.dumps(answer) + "\n").encode())
        if method == "shutdown":
            client.close()
            os.unlink(path)
            daemon.wait()
            sys.exit()
    real.close()
"""


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


class Independence(ExperimentCase):
    def test_workers_interruption_shards_and_single_trials_give_the_same_bytes(self):
        self.explore("one", "--workers", "1")
        self.explore("two", "--workers", "2")
        self.assert_same_results("one", "two")

        # Interrupted once a trial is there; what was kept is used, not made again.
        words = [REGRASP, "experiment", "exploration", *SMALL, "--workers", "1", "-o", self.dir / "cut"]
        with subprocess.Popen(list(map(str, words)), env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            first = process.stderr.readline()
            self.assertTrue(first.startswith("1/4 "), first)
            process.send_signal(signal.SIGINT)
            _, stderr = process.communicate(timeout=HANG_S)
        self.assertEqual(process.returncode, 130, stderr)
        kept = (self.dir / "cut" / "trials.jsonl").read_bytes()
        count = kept.count(b"\n")
        self.assertIn(f"{count} of 4 finished", stderr)
        self.assertFalse((self.dir / "cut" / "summary.json").exists())
        # A crash may cut a line off.
        with open(self.dir / "cut" / "trials.jsonl", "ab") as file:
            file.write(b'{"unit":3,"rows":[{"fing')
        again = self.explore("cut", "--workers", "2")
        self.assertIn(f"{count} of 4 are there already", again.stderr)
        self.assertTrue((self.dir / "cut" / "trials.jsonl").read_bytes().startswith(kept))
        self.assert_same_results("one", "cut")

        # Nothing is left to do: the same results, no trial run.
        self.assertNotIn("seed", self.explore("cut").stderr)
        self.assert_same_results("one", "cut")

        # The example for a cluster, by hand.
        env = environment(PATH=f"{REGRASP.parent}:/usr/bin:/bin", SLURM_ARRAY_TASK_MAX="2", REGRASP_RESULTS=str(self.dir))
        for shard in (1, 2):
            words = [SOURCE / "examples" / "experiment_array.sh", "exploration", *SMALL]
            subprocess.run(list(map(str, words)), env={**env, "SLURM_ARRAY_TASK_ID": str(shard)}, check=True, capture_output=True, timeout=HANG_S)
            self.assertEqual(len(self.rows(f"shard-{shard}")), 2)
        missing = self.refused_experiment(5, "merge", self.dir / "shard-1", "-o", self.dir / "merged")
        self.assertIn("2 of 4 trials are missing", missing)
        self.assertFalse((self.dir / "merged").exists())
        self.run_experiment("merge", self.dir / "shard-2", self.dir / "shard-1", "-o", self.dir / "merged")
        self.assert_same_results("one", "merged")

        # A row names the command that makes it again.
        row = self.rows("one")[2]
        words = shlex.split(row["command"])
        self.assertEqual(words[0], "regrasp")
        words[words.index("-o") + 1] = self.dir / "single"
        self.expect_quiet(*words[1:], "--models-dir", SOURCE / "models")
        self.assertEqual(self.rows("single"), [row])

        # Seeds matter, and noise-free truth is told.
        self.assertEqual(len({row["state_hash"] for row in self.rows("one")}), 4)
        summary = self.summary("one")
        self.assertNotIn("workers", json.dumps(summary))
        self.assertEqual([group["finger"] for group in summary["groups"]], ["first", "ring", "all"])
        everything = summary["groups"][-1]
        rose = sum(row["rose"] == "true" for row in self.rows("one"))
        self.assertEqual((everything["n"], everything["counts"]["rose"]["k"]), (4, rose))
        self.assertLessEqual(everything["counts"]["rose"]["low"], rose / 4)
        self.assertTrue((self.dir / "one" / "summary.png").read_bytes().startswith(b"\x89PNG"))

    def expect_quiet(self, *words):
        done = self.regrasp("-q", *words)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))


class Results(ExperimentCase):
    def test_the_map_bounds_what_an_exploration_reaches(self):
        words = ["--finger", "ring", "-n", "1", "--noise", "off", "--estimator", "least_squares,secant", "--models-dir", SOURCE / "models"]
        self.run_experiment("exploration", *words, "--rays", "8", "-o", self.dir / "map")
        rows = self.rows("map")
        self.assertEqual([row["estimator"] for row in rows], ["least_squares", "secant"])
        self.assertEqual(rows[0]["phi_best"], rows[1]["phi_best"])  # one map for both
        for row in rows:
            self.assertEqual(row["outcome"], "done")
            self.assertGreater(float(row["phi_best"]), float(row["phi_true_initial"]))
            # Explorations may overrun the bound of 8 mm a little: docs/experiments.md tells by how much.
            self.assertLess(float(row["phi_true_final"]), 1.05 * float(row["phi_best"]))
            self.assertEqual(row["near_best"] == "true", float(row["phi_true_final"]) >= 0.95 * float(row["phi_best"]))
            self.assertLess(float(row["phi_best_distance_m"]), 0.0095)
        with open(self.dir / "map" / "maps.csv", newline="") as file:
            samples = list(csv.DictReader(file))
        self.assertEqual({sample["ray"] for sample in samples}, set(map(str, range(8))))
        self.assertEqual(max(float(sample["phi"]) for sample in samples), float(rows[0]["phi_best"]))

    def test_rotation(self):
        self.run_experiment("rotation", "--angle", "20", "--axis=0,0,-1", "-n", "1", "--models-dir", SOURCE / "models", "-o", self.dir / "turn")
        (row,) = self.rows("turn")
        self.assertEqual(row["outcome"], "done")
        # It stops at the first step at or beyond 20 degrees; a step has 15.
        self.assertGreater(float(row["angle_rad"]), 0.30)
        self.assertLess(float(row["angle_rad"]), 0.65)
        self.assertIn("--axis=0,0,-1", row["command"])
        self.assertEqual(self.summary("turn")["groups"][0]["counts"]["completed"]["k"], 1)

    @unittest.skipUnless((REGRASP.parent / "zoo").exists(), "built without bench/")
    def test_a_turn_on_a_daemon_is_the_turn_on_the_session_alone(self):
        zoo = subprocess.run([REGRASP.parent / "zoo", "--objects", "sphere", "--first", "21", "--seeds", "1", "--turns", "0.1", "--push", "0.5", "--rows"],
                             capture_output=True, text=True, env=environment(REGRASP_MODELS_DIR=str(SOURCE / "models")), timeout=HANG_S, check=True).stdout
        alone = re.search(r"seed 21 done +(?P<deg>\S+) deg +(?P<s>\S+) s offset +(?P<mm>\S+) mm tilt +(?P<tilt>\S+) deg regrasps (?P<regrasps>\d+)", zoo)
        self.assertIsNotNone(alone, zoo)
        self.run_experiment("rotation", "--turns", "0.1", "--push", "0.5", "--seed", "21", "-n", "1", "--models-dir", SOURCE / "models", "-o", self.dir / "turn")
        (row,) = self.rows("turn")
        self.assertGreater(float(row["sim_time_s"]), 1, "no push was given")
        for part, column, digits, scale in [("deg", "angle_rad", 1, 180 / math.pi), ("s", "sim_time_s", 1, 1), ("mm", "max_position_error_m", 2, 1e3),
                                            ("tilt", "max_tilt_rad", 1, 180 / math.pi), ("regrasps", "regrasps", 0, 1)]:
            self.assertEqual(alone[part], f"{scale * float(row[column]):.{digits}f}", column)

    def test_noise_sweep_sets_both_estimators_side_by_side(self):
        self.run_experiment("noise-sweep", "--finger", "middle", "--noise", "off,paper", "-n", "1", "--rays", "0", "--models-dir", SOURCE / "models",
                            "-o", self.dir / "sweep")
        self.assertEqual([(row["noise"], row["estimator"]) for row in self.rows("sweep")],
                         [("off", "least_squares"), ("off", "secant"), ("paper", "least_squares"), ("paper", "secant")])


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
        self.assertGreaterEqual(measure["low"], min(differences) - 1e-12)
        self.assertLessEqual(measure["high"], max(differences) + 1e-12)
        # Of three signs alike one in four says as much; otherwise p is larger.
        self.assertGreaterEqual(measure["p"], 0.25)
        # Tables as a paper takes them, of a finished directory.
        latex = self.run_experiment(*self.ONE, *both, "-n", "3", "--format", "latex", "-o", self.dir / "grown").stdout
        self.assertEqual(latex.count("\\begin{tabular}"), latex.count("\\bottomrule"))
        self.assertIn("least\\_squares", latex)
        self.assertRegex(latex, r"[ (]\$-\$\d")  # a minus, where a hyphen would be printed
        self.assertNotRegex(latex, r"[ (]-\d")
        advice = self.run_experiment(*self.ONE, *both, "-n", "3", "--format", "markdown", "--precision", "0.05", "-o", self.dir / "grown").stdout
        self.assertIn("| secant | least_squares |", advice)
        self.assertIn("n for ±0.05", advice)

    def test_a_sweep_makes_a_case_of_each_value(self):
        self.run_experiment(*self.ONE, "-n", "1", "--set", "object.friction=0.7,0.8", "--set", "gravity=0,0,-9.81", "-o", self.dir / "sweep")
        self.assertEqual([row["case"] for row in self.rows("sweep")], ["object.friction=0.7", "object.friction=0.8"])
        (comparison,) = self.summary("sweep")["comparisons"]
        self.assertEqual((comparison["base"], comparison["other"]), ("object.friction=0.7", "object.friction=0.8"))
        plan = json.loads((self.dir / "sweep" / "experiment.json").read_text())
        self.assertEqual(plan["parameters"]["object.friction=0.7"]["object.friction"], 0.7)
        words = shlex.split(self.rows("sweep")[0]["command"])
        words[words.index("-o") + 1] = self.dir / "single"
        self.run_experiment(*words[2:], "--models-dir", SOURCE / "models")
        self.assertEqual(self.rows("single"), self.rows("sweep")[:1])
        self.refused_experiment(2, *self.ONE, "--set", "object.friction=0.7,0.7", "-o", self.dir / "none")

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
            self.assertLessEqual(0, predictor["low"])
            self.assertLessEqual(predictor["low"], predictor["high"])
        # What the run gave does not depend on being looked at.
        words = shlex.split(self.rows("foretold")[0]["command"])
        words[words.index("-o") + 1] = self.dir / "single"
        self.run_experiment(*words[2:], "--models-dir", SOURCE / "models")
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
        self.run_experiment(*words[2:], "--models-dir", SOURCE / "models")
        self.assertEqual(self.rows("single"), [rows[1]])

    def test_bad_cases_make_no_directory(self):
        out = ["--models-dir", SOURCE / "models", "-o", self.dir / "none"]
        for words, part in [(["rotation", "--case", "a: tilt"], "'tilt' is not NAME=VALUE"), (["rotation", "--case", ": tilt=3"], "no name"),
                            (["rotation", "--case", "a:", "--case", "a: tilt=3"], "two cases have the name 'a'"),
                            (["exploration", "--case", "a: push=1"], "push and turns are for rotations"), (["rotation", "--push", "-1"], "--push")]:
            with self.subTest(words):
                self.assertIn(part, self.refused_experiment(2, *words, *out))
        self.assertIn("gait.mod", self.refused_experiment(6, "rotation", "--case", "a:", "--case", "b: gait.mod=3", *out))
        self.assertFalse((self.dir / "none").exists())


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
        claims = [line.split(" | ") for line in page.splitlines() if line.startswith("| ") and line.endswith((" yes |", " partly |", " no |"))]
        self.assertGreaterEqual(len(claims), 12)
        # The page's own numbers are those of its summaries.
        group = next(g for g in self.summary("reproduction/exploration")["groups"] if g["estimator"] == "least_squares")
        rose = group["counts"]["rose"]["k"]
        self.assertIn(f"{rose}/1", next(c for c in claims if "Alg. 1" in c[0])[1])


class Hermetic(ExperimentCase):
    """Only the experiment's own options decide; whatever else could is recorded, compared and refused by name."""

    ONE = ["exploration", "--finger", "ring", "-n", "2", "--seed", "5", "--rays", "0", "--workers", "1"]

    def test_nothing_of_the_user_reaches_a_trial(self):
        self.run_experiment(*self.ONE, "-o", self.dir / "plain")
        (self.dir / "regrasp").mkdir()
        (self.dir / "regrasp" / "regraspd.toml").write_text("[parameters]\nobject.friction = 0.3\n")
        file = str(self.dir / "regrasp" / "regraspd.toml")
        for name, env in [("variable", {"REGRASP_CONFIG": file, "REGRASP_STEPPER": "exact", "REGRASP_NOISE": "off"}), ("home", {"XDG_CONFIG_HOME": str(self.dir)})]:
            with self.subTest(name):
                done = self.regrasp("experiment", *self.ONE, "-o", self.dir / name, env=environment(**env))
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assert_same_results("plain", name)
                self.assertEqual((self.dir / name / "experiment.json").read_bytes(), (self.dir / "plain" / "experiment.json").read_bytes())

    def test_what_decides_is_recorded_and_a_difference_refused_by_name(self):
        models = self.dir / "models"
        shutil.copytree(SOURCE / "models", models)
        one = [*self.ONE, "--models-dir", models, "--set", "object.mass_kg=0.09", "-o", self.dir / "one"]
        self.run_experiment(*one, "--shard", "1/2")
        plan = json.loads((self.dir / "one" / "experiment.json").read_text())
        self.assertEqual((plan["stepper"], plan["parameters"]), ("fast", {"object.mass_kg": 0.09}))
        self.assertRegex(plan["models"]["object"], r"^sphere [0-9a-f]{16}$")
        self.assertEqual(sorted(plan["models"]), ["hand", "object", "scenario"])
        self.assertIn('stepper was "fast", is "exact"', self.refused_experiment(5, *one, "--shard", "1/2", "--stepper", "exact"))
        sphere = models / "objects" / "sphere.urdf"
        sphere.write_text(sphere.read_text().replace("<robot", "<!-- the same sphere --><robot", 1))
        self.run_experiment(*one, "--shard", "1/2")
        sphere.write_text(sphere.read_text().replace("0.025", "0.0251"))
        self.assertRegex(self.refused_experiment(5, *one, "--shard", "1/2"), r'models.object was "sphere \w+", is "sphere \w+"')
        # Nor are shards joined that were made with another one.
        self.run_experiment(*one[:-1], self.dir / "two", "--shard", "2/2")
        self.assertIn("models.object was", self.refused_experiment(5, "merge", self.dir / "one", self.dir / "two", "-o", self.dir / "all"))

    def test_a_faulted_trial_is_booked_and_the_others_go_on(self):
        # The real programs, but the simulation of seed 6 faults while it explores.
        programs = self.dir / "bin"
        programs.mkdir()
        shutil.copy(REGRASP, programs)
        (programs / "regrasp-plot-experiment").symlink_to(REGRASP.parent / "regrasp-plot-experiment")
        (programs / "regraspd").write_text(FAULTY.replace("REAL", str(REGRASP.parent / "regraspd")))
        (programs / "regraspd").chmod(0o755)
        words = ["experiment", *self.ONE[:3], "-n", "3", *self.ONE[5:], "--models-dir", SOURCE / "models", "-o", self.dir / "fault"]
        done = self.regrasp(*words, binary=programs / "regrasp")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([(row["seed"], row["outcome"]) for row in self.rows("fault")], [("5", "done"), ("6", "fault"), ("7", "done")])
        self.assertEqual(self.summary("fault")["groups"][0]["counts"]["fault"]["k"], 1)


class Refusals(ExperimentCase):
    def test_another_configuration_in_the_same_directory_is_refused_by_name(self):
        self.explore("first", "--shard", "1/4")
        before = (self.dir / "first" / "trials.jsonl").read_bytes()
        for words, difference in [(["--noise", "off"], 'noise was ["paper"], is ["off"]'), (["--set", "exploration.epsilon=5"], "set was {}"),
                                  (["--shard", "2/4"], "shard was 1/4, is 2/4"), (["-n", "3"], "seeds was 2, is 3")]:
            words = ["--shard", "1/4", *words] if words[0] != "--shard" else words
            small = SMALL if words[-2] != "-n" else [w for w in SMALL if w not in ("-n", "2")]
            cause = self.refused_experiment(5, "exploration", *small, *words, "-o", self.dir / "first")
            self.assertIn(difference, cause)
        self.assertEqual((self.dir / "first" / "trials.jsonl").read_bytes(), before)

    def test_bad_arguments_make_no_directory(self):
        out = ["--models-dir", SOURCE / "models", "-o", self.dir / "none"]
        for words, part in [(["--finger", "rong"], "'rong' is none of"), (["--shard", "3/2"], "--shard '3/2'"), (["--set", "exploration.epsilon"], "NAME=VALUE"),
                            (["--set", "gait.hop=0", "--set", "gait.hop=1"], "gait.hop is given twice"), (["--case", "a: gait.hop=0 gait.hop=1"], "gait.hop is given twice"),
                            (["--noise", "loud"], "'loud' is none of"), (["--rays", "-1"], "--rays"),
                            (["--estimator", "guess"], "'guess' is none of"), (["-n", "0"], "--seeds")]:
            with self.subTest(words):
                self.assertIn(part, self.refused_experiment(2, "exploration", *words, *out))
        self.assertIn("epsilom", self.refused_experiment(6, "exploration", "--set", "exploration.epsilom=3", *out))
        self.assertFalse((self.dir / "none").exists())
        self.refused_experiment(6, "merge", self.dir / "nowhere", "-o", self.dir / "none")


class OnATerminal(ExperimentCase):
    def test_a_bar_shows_progress(self):
        words = [REGRASP, "experiment", "exploration", *SMALL, "--shard", "1/4", "-o", self.dir / "bar"]
        terminal = Terminal(words, environment(TERM="xterm"))
        self.assertEqual(terminal.finish(), 0, terminal.text)
        self.assertIn("0/1", terminal.text)
        self.assertIn("1/1", terminal.text)
        self.assertIn("█", terminal.text)


if __name__ == "__main__":
    unittest.main()
