"""`regrasp experiment`: only its own options decide, and a fault of one trial is no other's."""

import json
import shutil
import unittest

from experiment_case import ExperimentCase
from harness import REGRASP, SOURCE, environment


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


class Hermetic(ExperimentCase):
    """Only the experiment's own options decide; whatever else could is recorded, compared and refused by name."""

    ONE = ["exploration", "--finger", "ring", "-n", "2", "--seed", "5", "--rays", "0", "--workers", "1"]

    def test_a_daemon_that_cannot_start_hints_at_nothing_that_is_gone(self):
        cause, hint = self.refused(6, "experiment", "rotation", "--object", "nope", "-n", "1", "-o", self.dir / "out")
        self.assertIn('there is no model "nope"', cause)
        self.assertNotIn("try:", cause)
        self.assertEqual(hint, "  try: regraspd --help")

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

    def test_what_changes_while_it_runs_is_refused_and_not_booked(self):
        # The real programs, but as the third daemon starts (the worker's for the first case) a model's file changes, as the seventh does `regraspd` itself.
        programs = self.dir / "bin"
        programs.mkdir()
        shutil.copy(REGRASP, programs)
        (programs / "regrasp-plot-experiment").symlink_to(REGRASP.parent / "regrasp-plot-experiment")
        model, starts, daemon = self.dir / "ball.urdf", self.dir / "starts", programs / "regraspd"
        model.write_text((SOURCE / "models" / "objects" / "sphere_45mm.urdf").read_text())
        before = model.read_text()
        daemon.write_text(f'''#!/bin/sh
echo start >> "{starts}"
n=$(wc -l < "{starts}")
[ $n -ne 3 ] || sed -i s/0.0225/0.0215/ "{model}"
[ $n -ne 7 ] || echo "# changed" >> "$0"
exec "{REGRASP.parent}/regraspd" "$@"
''')
        daemon.chmod(0o755)
        program = daemon.read_text()
        words = ["experiment", "rotation", "--angle", "15", "-n", "1", "--case", "one:", "--case", f"two: object={model}", "--workers", "1",
                 "--models-dir", SOURCE / "models", "-o", self.dir / "out"]
        done = self.regrasp(*words, binary=programs / "regrasp")
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertRegex(done.stderr, r'object \S+/ball.urdf changed while the experiment ran: was "\S+ \w+", is "\S+ \w+"; 1 of 2 finished')
        self.assertNotIn("again goes on", done.stderr)
        self.assertEqual((self.dir / "out" / "trials.jsonl").read_text().count("\n"), 1)
        model.write_text(before)
        done = self.regrasp(*words, binary=programs / "regrasp")
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertIn("regraspd changed while the experiment ran", done.stderr)
        self.assertEqual((self.dir / "out" / "trials.jsonl").read_text().count("\n"), 1)
        daemon.write_text(program)
        done = self.regrasp(*words, binary=programs / "regrasp")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([row["case"] for row in self.rows("out")], ["one", "two"])

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


if __name__ == "__main__":
    unittest.main()
