"""`regraspd` as a service: configuration, reload, service manager, units."""

import ctypes
import json
import os
import re
import select
import socket
import shutil
import signal
import subprocess
import sys
import unittest

from harness import Case, HANG_S, REGRASP, REGRASPD, SOURCE, children, environment

MODELS = ["--models-dir", str(SOURCE / "models")]


class UntilEof(Case):
    def test_it_ends_with_its_input(self):
        words = [REGRASPD, "--socket", self.socket, "--output-dir", self.dir / "out", "--until-eof", *MODELS]
        self.socket.parent.mkdir(mode=0o700)
        with subprocess.Popen(words, env=environment(), stdin=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as daemon:
            while "listens on" not in (line := daemon.stderr.readline()):
                self.assertNotEqual(line, "")
            daemon.stdin.write("what is written there is passed over\n")
            daemon.stdin.flush()
            self.expect(0, "status")
            daemon.stdin.close()
            self.assertEqual(daemon.wait(HANG_S), 0)
            self.assertIn("standard input has ended", daemon.stderr.read())

    def test_a_daemon_of_the_command_line_ends_where_that_is_killed(self):
        words = [REGRASP, "experiment", "rotation", "-n", "9", "-o", self.dir / "out"]
        with subprocess.Popen(words, env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as program:
            while not (daemons := children(program.pid)):
                self.assertIsNone(program.poll())
            watched = os.pidfd_open(daemons[0])
            program.kill()
        self.addCleanup(os.close, watched)
        self.assertEqual(select.select([watched], [], [], HANG_S)[0], [watched])


class Config(Case):
    def show(self, *words, **env):
        done = self.regrasp("--json", "config", "show", *words, env=environment(**env))
        self.assertEqual(done.returncode, 0, done.stderr)
        answer = json.loads(done.stdout)
        entries = {entry["name"]: (entry["value"], entry["origin"]) for entry in answer["keys"] + answer["parameters"]}
        return answer, entries

    def write(self, text, name="c.toml"):
        file = self.dir / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        return file

    def test_the_later_wins_and_every_value_says_where_it_comes_from(self):
        file = self.write('seed = 3\nspeed = 2\nnoise = "fine"\n[parameters]\nobject.friction = 0.6\n')
        answer, entries = self.show(REGRASP_CONFIG=str(file), REGRASP_SPEED="max", REGRASP_PAUSED="true")
        self.assertEqual(answer["file"], str(file))
        self.assertEqual(entries["seed"], (3, f"{file}:1"))
        self.assertEqual(entries["speed"], ("max", "$REGRASP_SPEED"))
        self.assertEqual(entries["noise"], ("fine", f"{file}:3"))
        self.assertEqual(entries["paused"], (True, "$REGRASP_PAUSED"))
        self.assertEqual(entries["object.friction"], (0.6, f"{file}:5"))
        self.assertEqual(entries["max_clients"], (64, "built in"))
        self.assertEqual(entries["object.mass_kg"], (None, "model"))
        # Flags are regraspd's own.
        done = subprocess.run([REGRASPD, "--config", file, "--speed", "3", "--print-config"], env=environment(REGRASP_SPEED="max"), capture_output=True,
                              text=True, check=True)
        flags = {entry["name"]: (entry["value"], entry["origin"]) for entry in json.loads(done.stdout)["keys"]}
        self.assertEqual(flags["speed"], (3, "--speed"))
        self.assertEqual(flags["seed"], (3, f"{file}:1"))

    def test_the_file_of_the_user_is_found(self):
        self.write("seed = 8\n", "home/.config/regrasp/regraspd.toml")
        self.write("seed = 9\n", "xdg/regrasp/regraspd.toml")
        self.assertEqual(self.show(HOME=str(self.dir / "home"))[1]["seed"][0], 8)
        self.assertEqual(self.show(HOME=str(self.dir / "home"), XDG_CONFIG_HOME=str(self.dir / "xdg"))[1]["seed"][0], 9)
        self.assertEqual(self.show()[0]["file"], None)

    def test_what_is_shown_is_a_configuration_file(self):
        text = self.expect(0, "config", "show", "--origin", "-v").stdout
        self.assertIn('noise = "paper"', text)
        self.assertIn("# built in", text)
        again = self.write(text)
        self.assertEqual(self.show("--config", again)[1]["noise"], ("paper", f"{again}:{text.splitlines().index(next(l for l in text.splitlines() if l.startswith('noise'))) + 1}"))
        self.assertIn("fine", self.expect(0, "config", "check", again).stdout)

    def test_the_socket_of_the_file_is_the_clients_too(self):
        file = self.write(f'socket = "{self.dir}/elsewhere.sock"\n')
        done = subprocess.run([REGRASP, "status"], env=environment(REGRASP_CONFIG=str(file)), capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 3)
        self.assertIn(f"{self.dir}/elsewhere.sock", done.stderr)

    def test_errors_name_file_line_and_nearest_name(self):
        for text, parts in [("seed = 1\nspede = 2\n", [":2:", "'speed'"]), ("noise = \"papr\"\n", [":1:", "'paper'"]), ("seed = \n", [":1:"]),
                            ("max_clients = 5000\n", ["1 ... 1000"]), ("seed = 'one'\n", [":1:", "seed = 'one': expected an integer"]),
                            ("[parameters]\nobject.friction = 99\n", [":2:", "object.friction = 99 is out of range; allowed: 0.001 ... 1"]),
                            ("[parameters]\ngravity = [0, 0]\n", [":2:", "gravity is 3 numbers, not [0, 0]; allowed: 3 numbers, each -50 ... 50 m/s2"])]:
            file = self.write(text)
            cause, hint = self.refused(2, "config", "check", file)
            self.assertTrue(cause.startswith(f"regrasp: {file}:"), cause)
            for part in parts:
                self.assertIn(part, cause)
            self.assertIn("--print-default-config", hint)
        file = self.write("noise = 'papr'\nspede = 2\n[parameters]\nobject.friction = 99\ngait.mod = 1\ngravity = [0, 0]\n")
        places = [":1: noise = ", ":2: unknown key 'spede'", ":4: object.friction = 99 is out of range", ":5: unknown parameter 'gait.mod'", ":6: gravity is"]
        for words in (["config", "check", file], ["up", "--config", file]):
            errors = self.refused_list(2, *words)
            self.assertEqual(len(errors), len(places))
            for error, place in zip(errors, places):
                self.assertTrue(error.startswith(f"{file}{place}"), errors)
        file.write_text("\n".join(f"key{i} = 1" for i in range(60)))
        self.assertEqual(self.refused_list(2, "config", "check", file)[-1], "and 10 more")
        self.refused(6, "config", "check", self.dir / "absent.toml")
        cause, _ = self.refused(6, "config", "check", self.write('object = "unicorn"\n'))
        self.assertIn("unicorn", cause)
        done = subprocess.run([REGRASPD, "--print-config"], env=environment(REGRASP_SEED="-1"), capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("$REGRASP_SEED", done.stderr)

    def test_what_a_daemon_says_as_it_breaks_is_no_list_of_errors(self):
        regrasp = shutil.copy(REGRASP, self.dir / "regrasp")
        broken = self.dir / "regraspd"
        broken.write_text(f'#!/bin/sh\ncase "$*" in *--print-config*|*--check-config*) exec {REGRASPD} "$@" ;; esac\n'
                          "printf 'regraspd: first\\n  second\\n  try: third\\nfourth\\n' >&2\nexit 9\n")
        broken.chmod(0o755)
        cause, _ = self.refused(1, "up", binary=regrasp)
        self.assertEqual(cause, "regrasp:   second |   try: third | fourth")


class Printing(Case):
    def test_a_full_disk_is_74(self):
        for flag in ("--help", "--version", "--print-default-config", "--print-config", "--print-protocol", "--print-manual", "--print-protocol-manual",
                     "--check-config"):
            with self.subTest(flag), open("/dev/full", "w", encoding="utf-8") as full:
                done = subprocess.run([REGRASPD, flag, *MODELS], stdout=full, stderr=subprocess.PIPE, text=True, env=environment(), check=False)
                self.assertEqual(done.returncode, 74, done.stderr)
                self.assertIn("cannot write to standard output: No space left on device", done.stderr)

    def test_a_mistyped_flag_is_named(self):
        done = subprocess.run([REGRASPD, "--sped", "max"], capture_output=True, text=True, env=environment(), check=False)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertEqual(done.stderr, "regraspd: unknown argument --sped; did you mean '--speed'?\ntry: regraspd --help\n")


class Manager:
    """What systemd does: a datagram socket for notifications."""

    def __init__(self, directory):
        self.path = str(directory / "notify")
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(self.path)
        self.socket.settimeout(HANG_S)

    def next(self):
        """The next message, as a dictionary."""
        text = self.socket.recv(4096).decode()
        return dict(line.split("=", 1) for line in text.splitlines())

    def until(self, accept):
        """Messages up to and including the first that `accept` likes."""
        messages = [self.next()]
        while not accept(messages[-1]):
            messages.append(self.next())
        return messages


class ServiceCase(Case):
    def start(self, *words, listening=None, **env):
        """regraspd under a manager of ours, ready."""
        self.manager = Manager(self.dir)
        self.addCleanup(self.manager.socket.close)
        env = environment(NOTIFY_SOCKET=self.manager.path, **env)
        command = [str(REGRASPD), *map(str, words), "--output-dir", str(self.dir / "out"), *MODELS]
        self.log = open(self.dir / "log", "w+", encoding="utf-8")
        self.addCleanup(self.log.close)
        if listening is None:
            command += ["--socket", str(self.socket)]
            process = subprocess.Popen(command, env=env, stderr=self.log)
        else:
            # As systemd does: descriptor 3, and the number of the process that may take it.
            script = "import os, sys; os.dup2(int(sys.argv[1]), 3); os.environ.update(LISTEN_FDS='1', LISTEN_PID=str(os.getpid())); os.execv(sys.argv[2], sys.argv[2:])"
            process = subprocess.Popen([sys.executable, "-c", script, str(listening.fileno()), *command], env=env, stderr=self.log,
                                       pass_fds=[3, listening.fileno()] if listening.fileno() != 3 else [3])
        self.process = process
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.manager.until(lambda message: message.get("READY") == "1")

    def log_text(self):
        self.log.seek(0)
        return self.log.read()


class Notify(ServiceCase):
    def test_ready_reload_stop(self):
        file = self.dir / "c.toml"
        file.write_text('noise = "paper"\nseed = 1\n')
        self.start("--config", file, "--speed", "max")
        self.assertEqual(self.json("status")["noise"]["preset"], "paper")
        before = self.json("param", "get", "object.mass_kg")["value"]
        file.write_text('noise = "coarse"\nseed = 2\nmax_clients = 3\nlog_level = "debug"\n[parameters]\nobject.friction = 0.5\n')
        self.process.send_signal(signal.SIGHUP)
        self.manager.until(lambda message: "RELOADING" in message)
        self.manager.until(lambda message: message.get("READY") == "1")
        self.assertEqual(self.json("status")["noise"]["preset"], "coarse")
        self.assertEqual(self.json("param", "get", "object.friction")["value"], 0.5)
        self.assertEqual(self.json("param", "get", "object.mass_kg")["value"], before)
        self.assertEqual(self.json("status")["seed"], 1)
        log = self.log_text()
        self.assertIn("noise = coarse", log)
        self.assertIn("max_clients = 3", log)
        self.assertRegex(log, r"seed = 2 \(.*c\.toml:2\) needs a restart")
        file.write_text('noise = "coarse"\nseed = 2\n')
        self.process.send_signal(signal.SIGHUP)
        self.manager.until(lambda message: message.get("READY") == "1")
        self.assertIn("object.friction is no longer set and keeps its value; its default needs a restart", self.log_text())
        # An error changes nothing.
        file.write_text('noise = "off"\nsede = 2\n')
        self.process.send_signal(signal.SIGHUP)
        self.manager.until(lambda message: message.get("READY") == "1")
        self.assertEqual(self.json("status")["noise"]["preset"], "coarse")
        self.assertIn("unknown key 'sede'; did you mean 'seed'?; nothing has changed", self.log_text())
        self.process.terminate()
        self.manager.until(lambda message: message.get("STOPPING") == "1")
        self.assertEqual(self.process.wait(HANG_S), 0)

    def test_the_watchdog_is_fed_by_ticks(self):
        self.start("--speed", "max", WATCHDOG_USEC="200000")
        for _ in range(3):
            message = self.manager.until(lambda message: "WATCHDOG" in message)[-1]
            self.assertIn("idle", message["STATUS"])

    def test_a_pause_feeds_it_too(self):
        self.start("--paused", WATCHDOG_USEC="200000")
        for _ in range(3):
            message = self.manager.until(lambda message: "WATCHDOG" in message)[-1]
            self.assertIn("paused, tick 0", message["STATUS"])

    def test_a_loop_that_does_not_tick_does_not(self):
        # One tick a second is a loop that stands still, as the watchdog sees it every 50 ms: of 20 looks at most
        # a few can be fed, where a daemon that advances, or is paused, is fed at every look.
        self.start("--speed", "0.001", WATCHDOG_USEC="200000")
        looks = [message for message in (self.manager.next() for _ in range(40)) if "STATUS" in message]
        fed = [message for message in looks if "WATCHDOG" in message]
        self.assertLess(len(fed), len(looks) / 2)
        self.assertIn("does not advance", next(message for message in looks if "WATCHDOG" not in message)["STATUS"])
        self.expect(0, "pause")
        self.manager.until(lambda message: "paused" in message["STATUS"] and "WATCHDOG" in message)

    def test_a_loop_that_is_stuck_is_not_fed(self):
        attach, detach, all_threads = 16, 17, 0x40000000  # PTRACE_ATTACH, PTRACE_DETACH, __WALL
        self.start("--speed", "max", WATCHDOG_USEC="200000")
        for _ in range(3):
            self.manager.until(lambda message: "WATCHDOG" in message)
        # The control loop is, at full speed, the thread that has worked most besides the main one.
        tasks = f"/proc/{self.process.pid}/task"

        def worked(task):
            with open(f"{tasks}/{task}/stat", encoding="utf-8") as stat:
                return int(stat.read().rsplit(")", 1)[1].split()[11])
        loop = int(max((task for task in os.listdir(tasks) if int(task) != self.process.pid), key=worked))
        libc = ctypes.CDLL(None, use_errno=True)
        if libc.ptrace(attach, loop, 0, 0) != 0:
            self.skipTest(f"one thread cannot be stopped here: ptrace: {os.strerror(ctypes.get_errno())}")
        os.waitpid(loop, all_threads)
        self.manager.until(lambda message: "WATCHDOG" not in message)
        for _ in range(5):
            self.assertIn("does not advance", self.manager.next()["STATUS"])
        self.assertEqual(self.json("status")["state"], "idle")  # the other threads live: only the watchdog can tell
        libc.ptrace(detach, loop, 0, 0)
        self.manager.until(lambda message: "WATCHDOG" in message)

    def test_another_process_s_watchdog_is_not_ours(self):
        self.start("--speed", "max", WATCHDOG_USEC="200000", WATCHDOG_PID="1")
        self.process.send_signal(signal.SIGHUP)
        messages = self.manager.until(lambda message: message.get("READY") == "1")
        self.assertFalse(any("WATCHDOG" in message for message in messages))


class Activation(ServiceCase):
    def listen(self):
        self.socket.parent.mkdir(mode=0o700)
        listening = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        listening.bind(str(self.socket))
        listening.listen()
        self.addCleanup(listening.close)
        return listening

    def test_serves_the_socket_it_was_given_and_leaves_it(self):
        self.start("--speed", "max", listening=self.listen())
        self.assertEqual(self.json("status")["state"], "idle")
        self.assertFalse(self.socket.with_name("regrasp.sock.lock").exists())
        self.assertIn("systemctl stop", self.expect(0, "down").stdout)
        self.assertEqual(self.process.wait(HANG_S), 0)
        self.assertTrue(self.socket.exists())

    def test_refuses_what_is_no_listening_socket(self):
        left, right = socket.socketpair()
        self.addCleanup(left.close)
        self.addCleanup(right.close)
        script = "import os, sys; os.dup2(int(sys.argv[1]), 3); os.environ.update(LISTEN_FDS='1', LISTEN_PID=str(os.getpid())); os.execv(sys.argv[2], sys.argv[2:])"
        done = subprocess.run([sys.executable, "-c", script, str(left.fileno()), str(REGRASPD), *MODELS], env=environment(), pass_fds=[left.fileno()],
                              capture_output=True, text=True, timeout=HANG_S, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("no listening Unix stream socket", done.stderr)


class Units(Case):
    def unit(self):
        text = (SOURCE / "daemon/package/regraspd.service.in").read_text().replace("@REGRASPD@", str(REGRASPD))
        (self.dir / "regraspd.service").write_text(text)
        (self.dir / "regraspd.socket").write_text((SOURCE / "daemon/package/regraspd.socket").read_text())
        return self.dir / "regraspd.service"

    def test_exposure_is_at_most_one(self):
        done = subprocess.run(["systemd-analyze", "security", "--offline=true", "--no-pager", self.unit()], capture_output=True, text=True, check=True)
        exposure = float(re.search(r"Overall exposure level for regraspd.service: ([0-9.]+)", done.stdout)[1])
        self.assertLessEqual(exposure, 1.0)

    def test_the_units_are_understood(self):
        unit = self.unit()
        done = subprocess.run(["systemd-analyze", "verify", "--man=no", "--recursive-errors=no", unit], capture_output=True, text=True, check=False)
        complaints = [line for line in done.stderr.splitlines() if "regraspd." in line]
        self.assertEqual(complaints, [])


if __name__ == "__main__":
    unittest.main()
