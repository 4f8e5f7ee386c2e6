"""What programs make of where they are started: configuration, directories, terminals, standard output."""

import fcntl
import os
import pathlib
import pty
import select
import signal
import subprocess
import time
import unittest

from harness import Case, DaemonCase, FakeDaemon, HANG_S, REGRASP, REGRASPD, Refusal, SOURCE, Terminal, children, environment


class Configuration(Case):
    def write(self, text):
        file = self.dir / "c.toml"
        file.write_text(text)
        return environment(REGRASP_CONFIG=str(file), HOME=str(self.dir))

    def run_without_socket(self, *words, env):
        return subprocess.run([REGRASP, *words], env=env, capture_output=True, text=True, timeout=HANG_S, check=False)

    def test_a_tilde_is_the_home(self):
        env = self.write('output_dir = "~/o"\nsocket = "~/s/r.sock"\n')
        self.assertIn(f'output_dir = "{self.dir}/o"', self.run_without_socket("config", "show", env=env).stdout)
        self.assertIn(f"no daemon: {self.dir}/s/r.sock", self.run_without_socket("status", env=env).stderr)

    def test_a_relative_path_is_refused(self):
        for text in ('output_dir = "o"\n', 'socket = "r.sock"\n', 'models_dir = "models"\n'):
            with self.subTest(text):
                done = self.run_without_socket("config", "check", env=self.write(text))
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(f"c.toml:1: {text.split(' ')[0]} = ", done.stderr)
                self.assertIn("absolute path", done.stderr)

    def test_clients_refuse_what_no_daemon_would_take(self):
        for text, wanted in (('socket = "r.sock"\n', "absolute path"), ("socket = 5\n", "absolute path"),
                             ('sokcet = "/tmp/x"\n', "did you mean 'socket'?"), ("socket = \n", "c.toml:1")):
            with self.subTest(text):
                done = self.run_without_socket("status", env=self.write(text))
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(wanted, done.stderr)

    def test_relative_directories_of_the_environment_are_ignored(self):
        env = environment(HOME=str(self.dir), XDG_RUNTIME_DIR="r", XDG_CONFIG_HOME="c", XDG_STATE_HOME="s")
        for folder in ("r/regrasp", "c/regrasp"):
            (self.dir / folder).mkdir(parents=True)
        (self.dir / "c/regrasp/regraspd.toml").write_text("no TOML")
        done = subprocess.run([REGRASP, "status"], env=env, cwd=self.dir, capture_output=True, text=True, timeout=HANG_S, check=False)
        self.assertNotIn(" r/regrasp", done.stderr)
        self.assertNotIn("regraspd.toml", done.stderr)

    def test_a_models_directory_names_its_variable(self):
        done = subprocess.run([REGRASPD, "--check-config"], env=environment(REGRASP_MODELS_DIR="/nonexist"), capture_output=True,
                              text=True, timeout=HANG_S, check=False)
        self.assertEqual(done.returncode, 6)
        self.assertIn("$REGRASP_MODELS_DIR: /nonexist", done.stderr)


class ReadOnly(DaemonCase):
    """A directory in which nothing can be made."""

    def refuse(self, *words):
        done = subprocess.run([REGRASP, "-s", self.socket, *words], cwd=self.place, env=environment(), capture_output=True, text=True,
                              timeout=HANG_S, check=False, **self.nobody)
        self.assertEqual(done.returncode, 74, done.stderr)
        self.assertNotIn(".draft", done.stderr)
        cause, hint = done.stderr.splitlines()[-2:]
        return cause, hint

    def setUp(self):
        super().setUp()
        self.nobody = {"user": 65534, "group": 65534, "extra_groups": []} if os.geteuid() == 0 else {}
        self.place = self.dir / "read-only"
        self.place.mkdir()
        self.dir.chmod(0o755)
        self.place.chmod(0o555)

    def test_it_is_told_before_the_work_and_by_name(self):
        self.expect(0, "record", "start", "x.mcap")
        self.expect(0, "grasp", "--wait")
        self.expect(0, "record", "stop")
        run = self.dir / "x.mcap"
        run.write_bytes((self.dir / "out" / "x.mcap").read_bytes())
        run.chmod(0o644)
        for words, file in ((["export", run, "--format", "npz", "-o", "a.npz"], "a.npz"), (["export", run, "--format", "csv", "-o", "a"], "a"),
                            (["export", run, "--format", "mcap", "-o", "a.mcap"], "a.mcap"), (["video", run, "-o", "a.mp4"], "a.mp4"),
                            (["video", run, "-o", "a.gif"], "a.gif"), (["plot", "contacts", run, "-o", "a.png"], "a.png")):
            with self.subTest(words):
                cause, hint = self.refuse(*words)
                self.assertEqual(cause, f"regrasp: cannot write {file}: {self.place}: Permission denied")
                self.assertTrue(hint.endswith("-o OTHER_FILE"), hint)
        begin = time.monotonic()
        cause, _ = self.refuse("hand", "new", SOURCE / "models/hands/leap.urdf", "-o", "n.toml")
        self.assertIn("cannot write n.toml", cause)
        self.assertLess(time.monotonic() - begin, 5)

    def test_what_is_no_file_to_make(self):
        run = self.dir / "yy.mcap"
        self.expect(0, "record", "start", "x.mcap")
        self.expect(0, "grasp", "--wait")
        self.expect(0, "record", "stop")
        run.write_bytes((self.dir / "out" / "x.mcap").read_bytes())
        self.assertIn("OTHER_FILE", self.refused(74, "export", run, "--format", "npz", "-o", "/dev/stdout")[1])
        self.assertIn("standard output", self.refused(2, "export", run, "--format", "npz", "-o", "-")[0])
        self.assertIn("standard output", self.refused(2, "video", run, "-o", "-")[0])
        self.assertIn("needs a name", self.refused(2, "plot", "scene", "-o", "")[0])
        done = subprocess.run([REGRASP, "-s", self.socket, "replay", "yy"], cwd=self.dir, env=environment(), capture_output=True, text=True,
                              timeout=HANG_S, check=False)
        self.assertIn("yy.mcap: identical", done.stdout, done.stderr)


class NoOutput(Case):
    def test_nothing_begins_whose_answer_nobody_gets(self):
        words = f'"{REGRASP}" -s "{self.socket}" up >&-'
        done = subprocess.run(["sh", "-c", words], env=environment(), capture_output=True, text=True, timeout=HANG_S, check=False)
        self.assertEqual(done.returncode, 74)
        self.assertIn("Bad file descriptor", done.stderr)
        self.assertNotIn("df", done.stderr)
        self.assertFalse(self.socket.exists())

    def test_only_a_full_disk_is_told_as_one(self):
        for output, disk in (("&-", False), ("/dev/full", True)):
            for program in (f'"{REGRASP}" version', f'"{REGRASPD}" --print-default-config'):
                with self.subTest(program=program, output=output):
                    done = subprocess.run(["sh", "-c", f"{program} >{output}"], env=environment(), capture_output=True, text=True,
                                          timeout=HANG_S, check=False)
                    self.assertEqual(done.returncode, 74)
                    self.assertEqual("df -h" in done.stderr, disk, done.stderr)


class NoDirectory(Case):
    def test_the_current_directory_has_gone(self):
        gone = self.dir / "gone"
        for words in ("demo", "up --output-dir o", "export x.mcap --format csv", "experiment exploration -o d"):
            with self.subTest(words):
                gone.mkdir()
                done = subprocess.run(["sh", "-c", f'rmdir "{gone}"; exec "{REGRASP}" -s "{self.socket}" {words}'], cwd=gone,
                                      env=environment(), capture_output=True, text=True, timeout=HANG_S, check=False)
                self.assertNotEqual(done.returncode, 0)
                if not words.startswith("export"):  # it has no run file, either
                    self.assertIn("the current directory has gone", done.stderr)
                self.assertNotIn("unexpected answer", done.stderr)


class Top(DaemonCase):
    def test_top_needs_a_terminal_that_places_the_cursor(self):
        master, slave = pty.openpty()
        self.addCleanup(os.close, master)
        done = subprocess.run([REGRASP, "-s", self.socket, "top"], stdin=slave, stdout=slave, stderr=subprocess.PIPE, text=True,
                              env=environment(TERM="dumb"), timeout=HANG_S, check=False)
        os.close(slave)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("cannot place the cursor", done.stderr)
        self.assertFalse(select.select([master], [], [], 0)[0] and b"\x1b" in os.read(master, 65536))


class Screen(Case):
    def wait_for_a_job(self, columns, **env):
        """What appears while a job runs, on a terminal so wide."""
        left = [3]

        def wait(_):
            left[0] -= 1
            if left[0] > 0:
                time.sleep(0.05)
                raise Refusal(-32004, "not yet")
            return {"id": 7, "method": "grasp", "state": "done", "error": None, "progress": 1.0}

        daemon = FakeDaemon(self.socket, {"job.wait": wait, "status": lambda _: {"paused": False},
                                          "job.get": lambda _: {"id": 7, "method": "grasp", "state": "running", "progress": 0.45}})
        self.addCleanup(daemon.close)
        terminal = Terminal(["sh", "-c", f'stty cols {columns} <&1; exec "{REGRASP}" -s "{self.socket}" job wait 7'], environment(**env))
        text = terminal.read_until(None)
        os.close(terminal.master)
        self.assertEqual(terminal.process.wait(HANG_S), 0, text)
        return text

    def test_a_progress_line_fits_the_terminal(self):
        text = self.wait_for_a_job(20, TERM="xterm")
        self.assertIn("\x1b[K", text)
        for shown in text.split("\x1b[K")[1:-1]:
            self.assertLess(len(shown.strip("\r")), 20, text)

    def test_a_terminal_that_cannot_erase_gets_none(self):
        text = self.wait_for_a_job(80, TERM="dumb")
        self.assertNotIn("\x1b[K", text)
        self.assertNotIn("45 %", text)


class Killed(Case):
    """What a program leaves behind that nothing could end in order."""

    def start_demo(self):
        """It, and the directory of its private daemon, which has begun."""
        known = set(self.dir.glob("regrasp-private-*"))
        process = subprocess.Popen([REGRASP, "demo", "-o", self.dir / "demo", "--models-dir", SOURCE / "models"],
                                   env=environment(TMPDIR=str(self.dir)), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        deadline = time.monotonic() + HANG_S
        while not (found := [s.parent for s in self.dir.glob("regrasp-private-*/regrasp.sock") if s.parent not in known]):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.05)
        return process, found[0]

    def test_the_next_private_daemon_sweeps(self):
        first, left = self.start_demo()
        first.kill()
        first.wait()
        lock = os.open(left / "regrasp.sock.lock", os.O_RDONLY)
        fcntl.flock(lock, fcntl.LOCK_EX)  # until its daemon has gone, too
        os.close(lock)
        self.assertTrue(left.exists())
        second, used = self.start_demo()
        self.assertFalse(left.exists())
        third, _ = self.start_demo()
        self.assertTrue(used.exists())
        for process in (second, third):
            process.terminate()
            self.assertEqual(process.wait(HANG_S), 130)
        self.assertEqual(list(self.dir.glob("regrasp-private-*")), [])

    def test_a_long_directory_is_not_used(self):
        base = self.dir / ("x" * 100)
        base.mkdir()
        done = subprocess.run([REGRASP, "doctor"], env=environment(TMPDIR=str(base), HOME=str(self.dir)), capture_output=True, text=True,
                              timeout=HANG_S, check=False)
        self.assertIn("ok   physics", done.stdout)


class HelpersEnd(DaemonCase):
    def test_a_film_ends_with_the_command(self):
        for words in (["record", "start", "x.mcap"], ["grasp", "--wait"], ["rotate", "--angle", "90", "--wait"], ["record", "stop"]):
            self.expect(0, *words)
        command = subprocess.Popen([REGRASP, "video", self.dir / "out" / "x.mcap", "-o", self.dir / "x.mp4"], env=environment(),
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        deadline = time.monotonic() + HANG_S
        while not (helpers := children(command.pid)):
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.01)
        time.sleep(0.5)
        command.send_signal(signal.SIGKILL)
        command.wait()
        deadline = time.monotonic() + HANG_S
        while pathlib.Path(f"/proc/{helpers[0]}/exe").exists():
            self.assertLess(time.monotonic(), deadline)
            time.sleep(0.05)
        self.assertFalse((self.dir / "x.mp4").exists())  # it would be, had it gone on


if __name__ == "__main__":
    unittest.main()
