"""The lockstep clock: what comes out depends on what was asked, not on when; and a simulation that stands still says so."""

import json
import math
import os
import pathlib
import re
import subprocess
import sys
import unittest

from harness import BIN, DaemonCase, SOURCE

os.environ["REGRASP_BIN_DIR"] = str(BIN)
sys.path.insert(0, str(SOURCE / "cli" / "python"))
import regrasp  # pylint: disable=wrong-import-position

LINES = ["reset --seed 1", "grasp --wait", "explore ring --wait", "rotate --angle 90 --wait"]


class Lockstep(DaemonCase):
    """`regrasp up --speed max` is in lockstep by itself."""

    def typed(self):
        """Everything that the lines of README print, and the state they lead to. Jobs are numbered on."""
        printed = [re.sub(r"job \d+", "job", self.regrasp(*line.split()).stdout) for line in LINES]
        status = self.json("status")
        return printed, status["tick"], status["state_hash"]

    def test_the_same_lines_give_the_same_figures(self):
        self.assertEqual(self.json("status")["clock"], "lockstep")
        first = self.typed()
        self.assertIn("noise-free", first[0][2])
        self.assertRegex(first[0][3], r"angle +[\d.]+° \(0\.2")
        self.json("truth"), self.json("quality"), self.json("events")  # looking takes no time
        self.assertEqual(self.typed(), first)
        busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2)]  # pylint: disable=consider-using-with
        try:
            self.assertEqual(self.typed(), first)
        finally:
            for process in busy:
                process.kill()
                process.wait()
        self.expect(0, "down")
        self.expect(0, "up", "--speed", "max", "--seed", "1", "--models-dir", SOURCE / "models", "--output-dir", self.dir / "out")
        self.assertEqual(self.typed(), first)

    def test_the_same_lines_give_the_same_pictures(self):
        """Byte by byte, from another daemon too."""
        def drawn():
            for words in (LINES[0], LINES[1], LINES[3]):
                self.expect(0, *words.split())
            files = [self.dir / f"gait{suffix}" for suffix in (".png", ".pdf", ".svg")]
            for file in files:
                self.expect(0, "plot", "gait", "-o", file)
            return [file.read_bytes() for file in files]

        first = drawn()
        self.expect(0, "down")
        self.start_daemon()
        for i, (picture, before) in enumerate(zip(drawn(), first)):
            self.assertTrue(picture == before, f"picture {i}")
        for seed in range(6):  # the mark of a reset was there by chance
            self.expect(0, "reset", "--seed", seed)
            self.expect(0, "step", "20", "--wait")
            self.expect(0, "plot", "quality", "-o", self.dir / "reset.svg")
            self.assertIn(">reset or restored<", (self.dir / "reset.svg").read_text(), seed)

    def test_evaluate_takes_contacts_with_the_friction_that_was_felt(self):
        self.expect(0, "grasp", "--wait")
        self.expect(0, "explore", "ring", "--wait")
        contacts = self.json("contacts")
        self.assertGreater(contacts["friction"], 0.6)  # control.friction_estimate is 0.5
        (self.dir / "contacts.json").write_text(json.dumps(contacts))
        margin, sensed = (self.json(*words)["load_margin_n"] for words in (["evaluate", self.dir / "contacts.json"], ["quality"]))
        self.assertAlmostEqual(margin / sensed, 1, delta=0.05)  # `quality` has it low-passed

    def test_readme_prints_these_figures(self):
        """Elsewhere the same words with other figures: a compiler or a mathematical library may round otherwise."""
        page = (SOURCE / "README.md").read_text()
        lines = re.search(r"^\$ regrasp up .*?(?=^```)", page, re.M | re.S)[0].splitlines()
        self.assertEqual([line[len("$ regrasp "):] for line in lines if line.startswith("$")][1:], LINES)
        printed = [line for line in lines if not line.startswith("$")]
        here = [line for words in LINES for line in self.regrasp(*words.split()).stdout.splitlines()]
        shape = lambda line: re.sub(r"-?\d+(\.\d+)?", "0", line)  # pylint: disable=unnecessary-lambda-assignment
        compare = str if self.rounds_as_the_machine_of_readme() else shape
        rest = iter(compare(line) for line in here)  # README leaves lines out
        for line in printed:
            self.assertTrue(compare(line) in rest, "README.md prints\n  {}\nbut its lines give\n{}\nIf the change is meant, put this there.".format(
                line, "\n".join(here)))
        self.assertGreater(len(printed), 6)

    def walk(self, page, inexact=()):
        """Types the lines of the page's walkthroughs that print something, and those before, and compares what is printed. `inexact`: lines
        that tell how many frames a daemon at full speed has published, or how long something took."""
        text = (SOURCE / "docs" / page).read_text()
        exact = self.rounds_as_the_machine_of_readme()
        self.expect(0, "down")
        figures = lambda line: re.sub(r"-?\d+(\.\d+)?", "0", line)  # pylint: disable=unnecessary-lambda-assignment
        compared = 0
        for block in re.findall(r"^```\n(\$ regrasp .*?)^```", text, re.M | re.S):
            for part in re.split(r"^\$ regrasp ", block, flags=re.M)[1:]:
                words, *printed = part.splitlines()
                if words.startswith("up "):
                    self.regrasp("down")
                    words += f" --models-dir {SOURCE / 'models'} --output-dir {self.dir / 'walked'}"
                done = self.regrasp(*words.split(), cwd=self.dir)
                self.assertLessEqual(done.returncode, 1, done.stderr)  # 2000 cycles are few
                if not printed:
                    continue  # left out there
                here = done.stdout.replace(str(self.dir / "walked"), "/home/me/.local/state/regrasp")
                here = here.replace(f"regrasp -s {self.socket} ", "regrasp ").splitlines()
                shape = figures if not exact or any(word in words for word in inexact) else str
                self.assertEqual([re.sub(r" +", " ", shape(line)) for line in here], [re.sub(r" +", " ", shape(line)) for line in printed],
                                 f"docs/{page}: regrasp {words}\n{done.stdout}{done.stderr}")
                compared += 1
        return compared

    def test_the_walkthrough_of_runs_prints_these_figures(self):
        self.assertGreater(self.walk("runs.md", ("record", "replay", "export", "video")), 9)
        # What a frame more or less does not change: the end of the run.
        told = re.search(r"s \((\d+) ticks\)", (SOURCE / "docs" / "runs.md").read_text())[1]
        if self.rounds_as_the_machine_of_readme():
            self.assertEqual(str(self.json("replay", self.dir / "walked" / "turn.mcap")["ticks"]), told)

    def test_the_walkthrough_of_incidents_drops_the_object(self):
        self.assertEqual(self.walk("incidents.md"), 2)

    def rounds_as_the_machine_of_readme(self):
        """GCC 12, and glibc's functions for processors with fused multiply-add."""
        with open(self.json("checkpoint", "save", "here")["path"], encoding="utf-8") as file:
            build = json.loads(file.readline())["build"]
        return " gcc-12." in build and "fma" in pathlib.Path("/proc/cpuinfo").read_text().split()

    def test_the_python_module_gives_the_same_figures(self):
        for line in LINES[:1]:
            self.expect(0, *line.split())
        typed = [self.json(*line.split()) for line in LINES[1:]]
        with regrasp.start(seed=1) as hand:
            called = [hand.grasp().wait(), hand.explore("ring").wait(), hand.rotate(angle_rad=math.radians(90)).wait()]
            for record in [*typed, *called]:
                del record["id"]
            self.assertEqual(called, typed)
            self.assertEqual(hand.status()["state_hash"], self.json("status")["state_hash"])

    def test_time_stands_still_between_jobs(self):
        self.expect(0, "grasp", "--wait")
        end = self.json("status")["tick"]
        self.expect(0, "param", "set", "control.grip_force", "1.5")
        self.expect(0, "push", "--force", "0,0.2,0")
        status = self.json("status")
        self.assertEqual((status["tick"], status["advancing"], status["state"]), (end, False, "holding"))
        self.assertEqual(status["real_time_factor"], 0)
        self.assertIn("lockstep: waits for a job", self.expect(0, "status").stdout)
        self.assertEqual(self.json("explore", "ring", "--max-cycles", "50", "--wait", code=1)["start_tick"], end)  # 50 cycles are few
        tick = self.json("status")["tick"]
        step = self.json("step", "25", "--wait")
        self.assertEqual((step["state"], step["end_tick"]), ("done", tick + 25))
        self.assertEqual(self.json("status")["tick"], tick + 25)
        self.assertIn("no job is running", self.refused(5, "step", "--until-job-ends")[0])
        # Streams go on, so that what waits for samples does not hang.
        lines = [json.loads(line) for line in self.expect(0, "--json", "watch", "status", "--rate", "50", "--count", "4").stdout.splitlines()]
        self.assertEqual({line["tick"] for line in lines}, {tick + 25})

    def test_an_idle_daemon_works_for_nobody(self):
        self.expect(0, "grasp", "--wait")
        tasks = pathlib.Path(f"/proc/{self.pid()}/task")

        def worked():
            """Clock ticks of CPU that each thread has had."""
            return {task.name: sum(map(int, (task / "stat").read_text().rpartition(")")[2].split()[11:13])) for task in tasks.iterdir()}

        before = worked()
        control = max(before.keys() - {self.pid()}, key=before.get)  # it has simulated the grasp; the first thread talks to clients
        while (tasks / control / "stat").read_text().rpartition(")")[2].split()[0] != "S":
            pass  # it publishes the last tick, then sleeps; the test's time limit ends this
        before = worked()
        for _ in range(20):
            self.json("status")
        self.assertEqual(worked()[control], before[control])
        self.assertEqual((tasks / control / "stat").read_text().rpartition(")")[2].split()[0], "S")

    def pid(self):
        (found,) = [path.parent.name for path in pathlib.Path("/proc").glob("[0-9]*/cmdline") if str(self.socket).encode() in path.read_bytes().split(b"\0")
                    and b"regraspd" in path.read_bytes().split(b"\0")[0]]
        return found


class Paused(DaemonCase):
    ARGUMENTS = ["--speed", "max", "--seed", "1", "--paused"]

    def test_waiting_for_a_paused_simulation_is_refused_at_once(self):
        cause, hint = self.refused(5, "grasp", "--wait")
        self.assertIn("the simulation is paused: job 1 waits", cause)
        self.assertIn("regrasp resume", hint)
        self.assertEqual(self.json("job", "show", "1")["state"], "queued")
        self.expect(0, "step", "--until-job-ends", "--wait")
        self.assertEqual(self.json("job", "show", "1")["state"], "done")

    def test_what_has_not_begun_never_begins(self):
        job = self.json("grasp")["job"]
        self.assertEqual(self.expect(0, "stop").stdout, f"job {job} cancelled before it began\n")
        self.expect(0, "step", "3", "--wait")
        record = self.json("job", "show", job)
        self.assertEqual((record["state"], record["start_tick"]), ("cancelled", None))
        self.assertEqual(self.json("status")["state"], "idle")

    def test_resuming_does_not_claim_that_time_runs(self):
        self.assertEqual(self.expect(0, "resume").stdout, "no longer paused at tick 0; in lockstep time goes on while a job runs\n")

    def test_step_until_the_job_ends(self):
        job = self.json("grasp")["job"]
        step = self.json("step", "--until-job-ends", "--wait")
        grasp = self.json("job", "show", job)
        self.assertEqual((step["state"], grasp["state"]), ("done", "done"))
        self.assertEqual(step["end_tick"], self.json("status")["tick"])
        self.assertLessEqual(abs(step["end_tick"] - grasp["end_tick"]), 1)
        self.assertTrue(self.json("status")["paused"])


class EndedSteps:
    """While a step of an hour runs."""

    def long_step(self):
        step = self.json("step", "3600000")["job"]
        while self.json("status")["tick"] == 0:
            pass
        return step

    def assert_stands(self, step, error):
        record = self.json("job", "show", step)
        self.assertEqual((record["state"], record["error"] or ""), ("cancelled", error))
        self.assertEqual(self.json("status")["tick"], record["end_tick"])

    def test_pause_ends_it(self):
        step = self.long_step()
        said = self.json("pause")
        self.assert_stands(step, "paused")
        self.assertEqual(said["tick"], self.json("status")["tick"])

    def test_stop_ends_it(self):
        step = self.long_step()
        self.assertEqual(self.expect(0, "stop").stdout, f"job {step} stopped: step\n")
        self.assert_stands(step, "")
        self.assertEqual(self.expect(0, "stop").stdout, "nothing to stop\n")


class EndedStepsPaused(EndedSteps, DaemonCase):
    ARGUMENTS = ["--speed", "max", "--seed", "1", "--paused", "--clock", "continuous"]

    def test_stop_ends_the_job_that_it_moves_too(self):
        self.expect(0, "grasp")
        self.expect(0, "step", "--until-job-ends", "--wait")
        job = self.json("rotate", "--continuous")["job"]
        step = self.json("step", "3600000")["job"]
        while self.json("job", "show", job)["state"] == "queued":
            pass
        self.assertEqual(self.json("stop"), {"job": job, "step": step, "begun": True})
        self.assert_stands(step, "")


class EndedStepsLockstep(EndedSteps, DaemonCase):
    ARGUMENTS = ["--speed", "max", "--seed", "1"]


class Released(DaemonCase):
    def test_what_needs_the_object_is_refused_at_once(self):
        self.expect(0, "grasp", "--wait")
        self.expect(0, "release", "--wait")
        jobs = self.json("job", "list")["jobs"]
        for words in (["grasp"], ["explore", "ring"], ["push", "--force", "0,0,1"]):
            with self.subTest(words):
                self.assertEqual(self.refused(5, *words)[1], "  try: regrasp reset")
        self.assertEqual(self.json("job", "list")["jobs"], jobs)
        self.expect(0, "reset")
        self.expect(0, "grasp", "--wait")

    def test_a_push_on_a_dropped_object_hints_at_reset(self):
        self.expect(0, "grasp", "--wait")
        self.expect(0, "param", "set", "object.friction", "0.05")
        self.regrasp("rotate", "--angle", "30", "--wait")
        self.assertEqual(self.json("status")["state"], "dropped")
        for words in (["push", "--force", "0,0,1"], ["explore", "ring"], ["grasp"]):
            self.assertEqual(self.refused(5, *words)[1], "  try: regrasp reset")


class Continuous(DaemonCase):
    ARGUMENTS = ["--speed", "max", "--seed", "1", "--clock", "continuous"]

    def test_time_goes_on_by_itself(self):
        self.assertEqual(self.json("status")["clock"], "continuous")
        before = self.json("status")["tick"]
        while self.json("status")["tick"] == before:
            pass
        self.refused(5, "step", "10")


class AnotherDaemon(DaemonCase):
    def test_options_of_a_second_up_are_compared(self):
        self.assertIn("already running", self.expect(0, "up").stdout)
        self.expect(0, "up", "--seed", "1", "--speed", "max")
        cause, hint = self.refused(5, "up", "--seed", "4", "--object", "egg")
        self.assertIn("seed is 1, not 4; object is sphere, not egg", cause)
        self.assertIn("regrasp down", hint)
        self.assertIn("papr", self.refused(2, "up", "--noise", "papr")[0])

    def test_down_and_up_follow_each_other(self):
        for _ in range(3):
            self.expect(0, "grasp", "--wait")
            self.expect(0, "param", "set", "object.friction", "0.05")
            self.regrasp("explore", "ring", "--wait")  # a drop leaves pictures to draw
            self.expect(0, "down")
            self.expect(0, "up", "--speed", "max", "--models-dir", SOURCE / "models", "--output-dir", self.dir / "out")


if __name__ == "__main__":
    unittest.main()
