"""What the end-to-end tests share: running `regrasp`, a private daemon, a scripted daemon, a terminal."""

import atexit
import json
import os
import pathlib
import pty
import re
import select
import shutil
import signal
import socket
import subprocess
import tempfile
import threading
import unittest

BIN = pathlib.Path(os.environ["REGRASP_BIN_DIR"])
SOURCE = pathlib.Path(os.environ["REGRASP_SOURCE_DIR"])
REGRASP = BIN / "regrasp"
REGRASPD = BIN / "regraspd"
# Far above anything a loaded machine needs: reached only by a hang.
HANG_S = 120
# A command in a hint that could ask a daemon, but does not say which.
NO_SOCKET = r"(?<!\S)regrasp (?!-s |help|hand |object )\w"
# A home of their own for the programs under test: what they write there (history, output) goes with it.
HOME = tempfile.mkdtemp(prefix="regrasp-home-")
atexit.register(shutil.rmtree, HOME, ignore_errors=True)


def environment(**changes):
    """A bare environment: nothing of the caller's decides what a test sees."""
    env = {"PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8", "HOME": HOME}
    env.update(changes)
    return env


def wait_until_it_minds(process, number):
    """Until a program of ours has taken signal `number` over; before that the signal would just kill it."""
    while True:
        with open(f"/proc/{process.pid}/status", encoding="utf-8") as status:
            caught = next(line for line in status if line.startswith("SigCgt:"))
        if int(caught.split()[1], 16) >> (number - 1) & 1:
            return
        if process.poll() is not None:
            raise AssertionError(f"ended with {process.returncode} before it could be interrupted")


def children(pid):
    """The processes whose parent is `pid`."""
    found = []
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            parent = stat.read_text(errors="replace").rsplit(")", 1)[1].split()[1]
        except OSError:
            continue  # it has just ended
        if int(parent) == pid:
            found.append(int(stat.parent.name))
    return found


class Case(unittest.TestCase):
    """A test with a directory of its own (`self.dir`) and a socket path in it (`self.socket`)."""

    def setUp(self):
        self.dir = pathlib.Path(tempfile.mkdtemp(prefix="regrasp-test-"))
        self.addCleanup(shutil.rmtree, self.dir, ignore_errors=True)
        self.socket = self.dir / "r" / "regrasp.sock"

    def regrasp(self, *words, env=None, stdin="", binary=REGRASP, cwd=None):
        """Every hint names the socket, as every line here does, and is given to the tests without it."""
        done = subprocess.run([str(binary), "-s", str(self.socket), *map(str, words)], input=stdin, env=env or environment(),
                              capture_output=True, text=True, timeout=HANG_S, check=False, cwd=cwd)
        if binary == REGRASP:
            for hint in re.findall(r"^  try: (.*)", done.stderr, re.MULTILINE):
                self.assertIsNone(re.search(NO_SOCKET, hint), f"no socket in: {hint}")
        done.stderr = done.stderr.replace(f"regrasp -s {self.socket} ", "regrasp ")
        return done

    def expect(self, code, *words, **options):
        """Runs `regrasp`, checks its exit code, and that success is silent on stderr and failure on stdout."""
        done = self.regrasp(*words, **options)
        self.assertEqual(done.returncode, code, f"regrasp {' '.join(map(str, words))}\n{done.stdout}{done.stderr}")
        if code == 0:
            self.assertEqual(done.stderr, "")
        return done

    def refused(self, code, *words, **options):
        """An error: nothing on stdout, two lines on stderr; returns the two lines."""
        done = self.expect(code, *words, **options)
        self.assertEqual(done.stdout, "")
        lines = done.stderr.splitlines()
        self.assertEqual(len(lines), 2, done.stderr)
        self.assertTrue(lines[0].startswith("regrasp: "), done.stderr)
        self.assertTrue(lines[1].startswith("  try: "), done.stderr)
        return lines

    def refused_list(self, code, *words, **options):
        """An error of many: nothing on stdout, on stderr their number, one a line, the next command; returns the many."""
        done = self.expect(code, *words, **options)
        self.assertEqual(done.stdout, "")
        first, *errors, last = done.stderr.splitlines()
        told = len(errors) - (re.fullmatch(r"  and \d+ more", errors[-1]) is not None)
        self.assertRegex(first, f"^regrasp: .*\\b{told} errors:$")
        self.assertTrue(last.startswith("  try: "), done.stderr)
        self.assertEqual([line for line in errors if not line.startswith("  ")], [], done.stderr)
        return [line[2:] for line in errors]

    def json(self, *words, code=0):
        """Runs with --json and returns the one object."""
        done = self.regrasp("--json", *words)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertEqual(done.stdout.count("\n"), 1, done.stdout)
        return json.loads(done.stdout)


class DaemonCase(Case):
    """A test with a daemon of its own, at full speed unless `ARGUMENTS` say otherwise."""

    ARGUMENTS = ["--speed", "max", "--seed", "1"]

    def setUp(self):
        super().setUp()
        self.addCleanup(self.regrasp, "down")
        self.start_daemon()

    def start_daemon(self):
        up = self.regrasp("--timeout", HANG_S, "up", *self.ARGUMENTS, "--output-dir", self.dir / "out", "--models-dir", SOURCE / "models")
        log = self.socket.with_suffix(".log")
        self.assertEqual(up.returncode, 0, up.stderr + (log.read_text() if log.exists() else ""))


class Wire:
    """One connection to a daemon: numbered requests go out as lines, `lines` come in."""

    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.settimeout(HANG_S)
        self.socket.connect(str(path))
        self.lines = self.socket.makefile("rb")
        self.last = 0

    def request(self, method, params):
        """The next request, not sent yet."""
        self.last += 1
        return {"jsonrpc": "2.0", "id": self.last, "method": method, "params": params}

    def write(self, *messages):
        self.socket.sendall(b"".join(json.dumps(message).encode() + b"\n" for message in messages))

    def close(self):
        self.lines.close()
        self.socket.close()


class FakeDaemon:
    """Answers from a script: `answers` maps a method to a function(params) that returns a result, raises
    Refusal, or returns None for silence. Keeps the requests."""

    def __init__(self, path, answers):
        path.parent.mkdir(mode=0o700, exist_ok=True)
        self.answers = {"hello": lambda _: {"protocol": 1, "version": "9.9.9", "server": "fake"}, **answers}
        self.requests = []  # without hello, which every command begins with
        self.connections = []
        self.listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.listener.bind(str(path))
        self.listener.listen()
        self.accepting = threading.Thread(target=self._accept, daemon=True)
        self.accepting.start()

    def _accept(self):
        while True:
            try:
                connection, _ = self.listener.accept()
            except OSError:
                return
            self.connections.append(connection)
            threading.Thread(target=self._serve, args=(connection,), daemon=True).start()

    def _serve(self, connection):
        try:
            self._answer(connection)
        except OSError:
            pass  # the client went away

    def _answer(self, connection):
        for line in connection.makefile("rb"):
            request = json.loads(line)
            if request["method"] != "hello":
                self.requests.append((request["method"], request.get("params", {})))
            reply = {"jsonrpc": "2.0", "id": request["id"]}
            try:
                result = self.answers[request["method"]](request.get("params", {}))
                if result is None:
                    continue
                if isinstance(result, bytes):
                    connection.sendall(result)
                    connection.shutdown(socket.SHUT_RDWR)
                    return
                reply["result"] = result
            except Refusal as refusal:
                reply["error"] = refusal.args[0]
            connection.sendall(json.dumps(reply).encode() + b"\n")

    def notify(self, **params):
        line = json.dumps({"jsonrpc": "2.0", "method": "event", "params": params}).encode() + b"\n"
        for connection in self.connections:
            try:
                connection.sendall(line)
            except OSError:
                pass

    def close(self):
        # A thread that is about to accept would take the next listener's connections, which gets the same descriptor.
        self.listener.shutdown(socket.SHUT_RDWR)
        self.accepting.join()
        self.listener.close()
        for connection in self.connections:
            connection.close()


class Refusal(Exception):
    def __init__(self, code, message, hint=""):
        super().__init__({"code": code, "message": message, "data": {"hint": hint}})


class Terminal:
    """A program whose stdout and stderr are a terminal; `text` collects what it writes."""

    def __init__(self, words, env, cwd=None):
        self.master, slave = pty.openpty()
        self.process = subprocess.Popen([str(w) for w in words], stdin=subprocess.DEVNULL, stdout=slave, stderr=slave, env=env,
                                        cwd=cwd)
        os.close(slave)
        self.text = ""

    def read_until(self, wanted):
        """Reads until `wanted` appeared, or to the end for None."""
        while wanted is None or wanted not in self.text:
            if not select.select([self.master], [], [], HANG_S)[0]:
                raise AssertionError(f"'{wanted}' did not appear in: {self.text!r}")
            try:
                chunk = os.read(self.master, 65536)
            except OSError:
                chunk = b""  # the last writer closed the terminal
            if not chunk:
                break
            self.text += chunk.decode()
        return self.text

    def finish(self):
        self.read_until(None)
        os.close(self.master)
        return self.process.wait(HANG_S)

    def interrupt(self):
        self.process.send_signal(signal.SIGINT)
