"""`regrasp shell`: typed at a terminal, read from a file or a pipe."""

import json
import pathlib
import re
import signal
import stat
import subprocess
import threading
import time
import unittest

from harness import Case, DaemonCase, FakeDaemon, HANG_S, REGRASP, environment
from screen import Session


def children(parent):
    """The numbers of the processes that `parent` has started and not yet taken leave of."""
    found = []
    for stat_file in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat_file.read_text().rpartition(")")[2].split()
        except OSError:
            continue  # it has ended meanwhile
        if int(fields[1]) == parent:
            found.append(int(stat_file.parent.name))
    return found


class Script(Case):
    def script(self, text):
        file = self.dir / "script"
        file.write_text(text)
        return file

    def test_reads_a_file_and_a_pipe_by_the_same_rules(self):
        text = "# a comment\n\n  version # another\nregrasp version\n'version'\r\nexit\nversion\n"
        for done in (self.expect(0, "shell", self.script(text)), self.expect(0, "shell", stdin=text), self.expect(0, "shell", "-", stdin=text)):
            self.assertEqual(len(re.findall(r"(?m)^regrasp \d+\.\d+\.\d+$", done.stdout)), 3, done.stdout)

    def test_stops_at_the_first_failure_with_its_exit_code_and_place(self):
        file = self.script("version\nstatus\nversion\n")
        done = self.expect(3, "shell", file)
        self.assertEqual(done.stdout.count("\n"), 1)
        self.assertIn(f"{file}:2: no daemon", done.stderr)
        self.assertIn(f"{file}:2: stopped: 'status' ended with exit code 3", done.stderr)
        done = self.expect(2, "shell", stdin="version\nstatu\n")
        self.assertIn("standard input:2: unknown command 'statu'", done.stderr)
        self.assertIn("try: regrasp status", done.stderr)

    def test_keep_going_runs_the_rest_and_remembers_the_first_failure(self):
        done = self.expect(3, "shell", "--keep-going", stdin="status\nversion\nstatu\nversion\n")
        self.assertEqual(done.stdout.count("\n"), 2)
        self.assertIn("input:1: no daemon", done.stderr)
        self.assertIn("input:3: unknown command", done.stderr)

    def test_quotes_hold_blanks(self):
        done = self.expect(6, "shell", stdin="evaluate 'no such \"file'\n")
        self.assertIn("no file no such \"file", done.stderr)
        done = self.expect(6, "shell", stdin='evaluate "a \\"b\\" # c"\n')
        self.assertIn('no file a "b" # c', done.stderr)
        self.assertIn("has no end", self.expect(2, "shell", stdin="evaluate 'x\n").stderr)

    def test_global_options_hold_for_every_line(self):
        done = self.expect(0, "--json", "shell", stdin="version\nversion\n")
        for line in done.stdout.splitlines():
            self.assertIn("version", json.loads(line))
        done = self.expect(3, "--json", "shell", stdin="status\n")
        self.assertEqual(json.loads(done.stderr)["error"]["exit_code"], 3)
        self.assertEqual(self.expect(0, "-q", "shell", stdin="version\n").stdout, "")

    def test_a_shell_in_a_shell_is_refused(self):
        self.assertIn("this is the shell already", self.expect(2, "shell", stdin="shell\n").stderr)

    def test_a_full_disk_stops_a_script(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run([str(REGRASP), "shell"], input="version\nversion\n", stdout=full, stderr=subprocess.PIPE, text=True, env=environment(),
                                  timeout=HANG_S, check=False)
        self.assertEqual(done.returncode, 74)
        self.assertIn("standard input:1: cannot write to standard output", done.stderr)

    def test_files_that_cannot_be_read(self):
        self.refused(6, "shell", self.dir / "absent")
        self.refused(74, "shell", self.dir)


class Typed(DaemonCase):
    def shell(self, *words, rows=30, columns=100):
        # With the usual patience, a loaded machine may let Tab and the prompt do without the daemon.
        session = Session([REGRASP, "-s", self.socket, "--timeout", HANG_S, *words], rows, columns, HOME=str(self.dir), XDG_STATE_HOME="")
        self.addCleanup(session.child.close)
        session.wait(r"Tab completes")
        session.wait(r"regrasp \w+>$")
        return session

    def answer(self, session, keys, wanted):
        session.press(keys)
        return session.wait(wanted)

    def test_regrasp_alone_on_a_terminal_is_the_shell(self):
        session = self.shell()
        self.answer(session, "status\r", r"state +idle")
        self.answer(session, "\x04", lambda text: True)
        self.assertEqual(session.finish(), 0)
        self.assertEqual(session.modes_after, session.modes)

    def test_completes_commands_parameters_and_values(self):
        session = self.shell("shell")
        (self.dir / "folder").mkdir()
        for typed, completed in [("expl\t", "explore ?$"), ("ri\t", "explore ring ?$"), ("--cri\t", "explore ring --criterion ?$"),
                                 ("sw\t", "explore ring --criterion switched ?$"), ("\x15noise pr\t", "> noise preset ?$"), ("tax\t", "noise preset taxel ?$"),
                                 ("\x15reset --object sp\t", "reset --object sphere"), ("\x15param set object.fr\t", r"param set object.friction ?$"),
                                 ("\x15watch qu\t", "watch quality ?$"), ("\x15help expe\t", "help experiment ?$"),
                                 ("\x15status --js\t", "status --json ?$"), (f"\x15evaluate {self.dir}/fol\t", "/folder/$")]:
            self.answer(session, typed, completed)
        self.answer(session, "\x15noise \t\t", r"(?s)show +set +preset +off")

    def test_history_outlives_the_shell(self):
        first = self.shell("shell")
        self.answer(first, "noise show\r", "noise preset")
        self.answer(first, "exit\r", lambda text: True)
        self.assertEqual(first.finish(), 0)
        file = self.dir / ".local" / "state" / "regrasp" / "history"
        self.assertIn("noise", file.read_text())
        self.assertEqual(stat.S_IMODE(file.stat().st_mode), 0o600)
        second = self.shell("shell")
        self.answer(second, "\x1b[A\x1b[A", r"> noise show")
        self.answer(second, "\r", "noise preset")

    def test_an_error_is_shown_and_the_shell_goes_on(self):
        session = self.shell("shell")
        self.answer(session, "statu\r", r"(?s)unknown command 'statu'.*try: regrasp -s \S+ status.*idle>$")
        self.answer(session, "regrasp version\r", r"regrasp \d+\.\d+\.\d+\n")

    def test_control_c_drops_the_line_and_the_prompt_follows_the_state(self):
        session = self.shell("shell")
        self.answer(session, "rotate --turns 5\x03", r"\^C\n+regrasp idle>$")
        self.answer(session, "grasp --wait\r", r"(?s)grasp done.*regrasp holding>$")
        self.answer(session, "down\r", r"\(no daemon\)>$")

    def test_control_c_during_a_wait_leaves_the_job_running(self):
        session = self.shell("shell")
        self.answer(session, "grasp --wait\r", "holding>$")
        self.answer(session, "rotate --continuous\r", "job 2: rotate started")
        self.answer(session, "job wait 2\r", "%")  # the progress line: it waits
        self.answer(session, "\x03", r"(?s)interrupted; job 2 goes on.*try: regrasp -s \S+ job wait 2.*rotating>$")
        self.assertEqual(self.json("job", "show", "2")["state"], "running")
        self.answer(session, "stop\r", "job 2 stopped")

    def test_control_c_ends_other_programs_and_not_the_shell(self):
        session = self.shell("shell")
        session.press("bench --seconds 1000\r")
        deadline = time.monotonic() + HANG_S
        while not children(session.child.pid):  # the measurement runs in a program of its own
            self.assertLess(time.monotonic(), deadline)
        self.answer(session, "\x03", r"(?s)regrasp: interrupted.*idle>$")
        self.assertEqual(children(session.child.pid), [])
        self.answer(session, "version\r", r"regrasp \d+\.\d+\.\d+\n")

    def test_a_signal_gives_the_terminal_back(self):
        session = self.shell("shell")
        session.kill(signal.SIGTERM)
        self.assertEqual(session.finish(), -signal.SIGTERM)
        self.assertEqual(session.modes_after, session.modes)


class Unanswered(Case):
    def test_control_c_ends_the_wait_and_not_the_shell(self):
        silent = threading.Event()
        fake = FakeDaemon(self.socket, {"status": lambda _: None if silent.is_set() else {"state": "holding"}})
        self.addCleanup(fake.close)
        session = Session([REGRASP, "-s", self.socket, "--timeout", HANG_S, "shell"], HOME=str(self.dir), XDG_STATE_HOME="")
        self.addCleanup(session.child.close)
        session.wait("holding>$")
        silent.set()
        session.press("status\r")
        deadline = time.monotonic() + HANG_S
        for asked in (2, 3):  # by the command, then by the prompt after it
            while len(fake.requests) < asked:
                self.assertLess(time.monotonic(), deadline)
            session.press("\x03")
        session.wait(r"(?s)regrasp: interrupted.*regrasp \(no answer\)>$")
        silent.clear()
        session.press("version\r")
        session.wait(r"(?s)regrasp \d+\.\d+\.\d+\n.*holding>$")
        silent.set()
        session.press("status\r")
        while len(fake.requests) < 5:
            self.assertLess(time.monotonic(), deadline)
        session.kill(signal.SIGTERM)  # this is meant for the shell
        self.assertEqual(session.finish(), 130)
        self.assertEqual(session.modes_after, session.modes)


class Waiting(DaemonCase):
    ARGUMENTS = ["--speed", "1", "--seed", "1"]

    def test_control_c_at_a_terminal(self):
        self.regrasp("grasp", "--wait")
        session = Session([REGRASP, "-s", self.socket, "explore", "ring", "--wait"])
        session.wait("explore ring .*%")
        session.press("\x03")
        self.assertEqual(session.finish(), 130)
        self.assertIn("job 2 goes on", session.text())
        self.assertIn(f"try: regrasp -s {self.socket} job wait 2", session.text())
        self.assertEqual(self.json("job", "show", "2")["state"], "running")
        self.assertEqual(self.json("job", "cancel", "2")["id"], 2)


if __name__ == "__main__":
    unittest.main()
