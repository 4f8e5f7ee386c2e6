"""The Python module: its methods are those of the daemon, the same lines give the same figures, run files are read."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
import unittest

from experiment_case import ExperimentCase
from harness import BIN, HANG_S, SOURCE, Case, DaemonCase, FakeDaemon, environment

os.environ["REGRASP_BIN_DIR"] = str(BIN)
sys.path.insert(0, str(SOURCE / "cli" / "python"))
import regrasp  # noqa: E402  (found through the line above)
from regrasp import runs  # noqa: E402


def run_python(source, **env):
    env = environment(PYTHONPATH=str(SOURCE / "cli" / "python"), REGRASP_BIN_DIR=str(BIN), **env)
    return subprocess.run([sys.executable, "-c", source], env=env, capture_output=True, text=True, timeout=HANG_S, check=False)


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

    def test_an_argument_may_be_called_method(self):
        with regrasp.connect(self.socket) as hand:
            self.assertEqual([m["name"] for m in hand.describe(method="status")["methods"]], ["status"])
            self.assertEqual(hand.call("describe", method="status"), hand.describe("status"))

    def test_the_configuration_file_names_the_socket(self):
        file = self.dir / "config" / "regrasp" / "regraspd.toml"
        file.parent.mkdir(parents=True)
        file.write_text(f'socket = "{self.socket}"\n')
        ask = "import regrasp; print(regrasp.connect().path)"
        for env in ({"XDG_CONFIG_HOME": str(self.dir / "config")}, {"REGRASP_CONFIG": str(file)}):
            with self.subTest(*env):
                self.assertEqual(run_python(ask, **env).stdout.strip(), str(self.socket))
        flagged = run_python(ask, REGRASP_CONFIG=str(file), REGRASP_SOCKET="/nowhere/regrasp.sock")
        self.assertIn("FileNotFoundError", flagged.stderr)
        file.write_text("socket = \n")
        self.assertIn(f"ValueError: {file}: ", run_python(ask, REGRASP_CONFIG=str(file)).stderr)

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


class Interrupted(Case):
    def test_later_answers_are_of_later_calls(self):
        answering = threading.Event()
        daemon = FakeDaemon(self.socket, {"job.wait": lambda _: answering.wait(HANG_S) and {"state": "done"},
                                          "status": lambda _: {"state": "idle"}, "wrong": lambda _: b"no answer\n"})
        self.addCleanup(daemon.close)
        with regrasp.connect(self.socket) as hand:
            signal.signal(signal.SIGALRM, lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
            signal.setitimer(signal.ITIMER_REAL, 0.1)
            with self.assertRaises(KeyboardInterrupt):
                regrasp.Job(hand, 1).wait()
            answering.set()
            self.assertEqual(hand.status(), {"state": "idle"})
            with self.assertRaises(ValueError):
                hand.call("wrong")

    def test_an_interrupt_at_the_terminal_does_not_reach_a_private_daemon(self):
        with regrasp.start(seed=1) as hand:
            self.assertNotEqual(os.getsid(hand._daemon._process.pid), os.getsid(0))


class Threads(Case):
    def test_each_gets_its_own_answers(self):
        daemon = FakeDaemon(self.socket, {"describe": lambda asked: asked})
        self.addCleanup(daemon.close)
        wrong = []

        def ask(hand, number):
            for turn in range(300):
                try:
                    if (answer := hand.call("describe", asks=[number, turn])) != {"asks": [number, turn]}:
                        wrong.append(answer)
                except Exception as error:  # pylint: disable=broad-exception-caught
                    wrong.append(error)
        with regrasp.connect(self.socket) as hand:
            threads = [threading.Thread(target=ask, args=(hand, number), daemon=True) for number in range(4)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join(HANG_S)
                self.assertFalse(thread.is_alive())
        self.assertEqual(wrong, [])

    def test_streams_go_on_meanwhile(self):
        with regrasp.start(seed=1, clock="continuous") as hand:
            waits = threading.Thread(target=lambda: hand.grasp().done())
            waits.start()
            self.assertEqual(len(list(hand.watch("status", count=3))), 3)
            waits.join(HANG_S)
            self.assertEqual(hand.status()["state"], "holding")

    def test_a_handler_that_calls_while_its_thread_waits_is_refused(self):
        daemon = FakeDaemon(self.socket, {"job.wait": lambda _: None, "status": lambda _: {}})
        self.addCleanup(daemon.close)
        with regrasp.connect(self.socket) as hand:
            signal.signal(signal.SIGALRM, lambda *_: hand.status())
            signal.setitimer(signal.ITIMER_REAL, 0.1)
            with self.assertRaisesRegex(RuntimeError, "poll"):
                regrasp.Job(hand, 1).wait()


class LeftOpen(Case):
    """A hand that nobody closes: its daemon ends with the interpreter, however that ends."""

    START = "import os, signal, regrasp; hand = regrasp.start(seed=1); print(hand._daemon._process.pid, hand.path, flush=True); "

    def daemon_of(self, more):
        number, path = run_python(self.START + more).stdout.split()
        return number, path

    def assert_ends(self, number):
        # Killed interpreters do not wait for it.
        deadline = time.monotonic() + HANG_S
        while time.monotonic() < deadline:
            try:
                with open(f"/proc/{number}/stat", encoding="utf-8") as stat:
                    if stat.read().rsplit(")", 1)[1].split()[0] == "Z":
                        return
            except OSError:
                return
            time.sleep(0.01)
        self.fail(f"regraspd {number} is still there")

    def test_at_the_end_of_the_script(self):
        for more in ("pass", "raise RuntimeError", "os.fork() or os._exit(0); hand.status()"):
            with self.subTest(more):
                number, path = self.daemon_of(more)
                self.assert_ends(number)
                self.assertFalse(os.path.exists(os.path.dirname(path)))

    def test_where_it_is_killed(self):
        for more in ("os.kill(os.getpid(), signal.SIGKILL)", "os.kill(os.getpid(), signal.SIGTERM)"):
            with self.subTest(more):
                self.assert_ends(self.daemon_of(more)[0])

    def test_a_fork_that_ends_leaves_it(self):
        number, _ = self.daemon_of("child = os.fork(); child or exit(); os.waitpid(child, 0); print(hand.status()['state'][:0], end='')")
        self.assert_ends(number)

    def test_where_nobody_has_it_any_more(self):
        hand = regrasp.start(seed=1)
        process = hand._daemon._process
        with self.assertWarns(ResourceWarning):  # of its socket
            del hand
        self.assertIsNotNone(process.returncode)


class Experiments(ExperimentCase):
    def test_text_stays_text_however_it_looks(self):
        (self.dir / "trials.csv").write_text(
            "case,object,seed,error,converged,phi_final,angle_rad,state_hash,command\n"
            "0.80,1e3,7,,true,0.25,,15815048586e0745,5\n"
            "nan,inf,8,12,false,1e-07,,1234567890123456,6\n")
        self.assertEqual(runs.trials(self.dir), [
            {"case": "0.80", "object": "1e3", "seed": 7.0, "error": None, "converged": "true", "phi_final": 0.25, "angle_rad": None,
             "state_hash": "15815048586e0745", "command": "5"},
            {"case": "nan", "object": "inf", "seed": 8.0, "error": "12", "converged": "false", "phi_final": 1e-07, "angle_rad": None,
             "state_hash": "1234567890123456", "command": "6"}])

    def test_columns_are_what_the_experiments_wrote(self):
        for name, words in (("exploration", ["--finger", "ring", "--rays", "0", "--set", "gait.margin_min=0.3,0.80"]), ("rotation", ["--turns", "0.05"])):
            self.run_experiment(name, *words, "-n", "1", "--models-dir", SOURCE / "models", "-o", self.dir / name)
        for name in ("exploration", "rotation"):
            units = [json.loads(line) for line in (self.dir / name / "trials.jsonl").read_text().splitlines()]  # as they ended
            written = [row for unit in sorted(units, key=lambda unit: unit["unit"]) for row in unit["rows"]]
            for read, row in zip(runs.trials(self.dir / name), written, strict=True):
                for column, value in row.items():
                    text = value or None if isinstance(value, str) else str(value).lower() if isinstance(value, bool) else value
                    self.assertEqual(read[column], text, column)
                    if isinstance(value, str):  # none is text by chance
                        self.assertIn(column, runs._TEXT)


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
