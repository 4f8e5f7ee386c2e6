"""`regrasp` against a scripted daemon: sockets, errors, waiting, streams, interrupts."""

import json
import os
import pwd
import shutil
import socket
import subprocess
import unittest

from harness import Case, FakeDaemon, HANG_S, REGRASP, Refusal, Terminal, environment

STATUS = {"version": "9.9.9", "state": "holding", "paused": False, "tick": 1500, "time_s": 1.5, "state_hash": "00ff", "real_time_factor": 1.0,
          "seed": 1, "hand": "shadow", "object": "sphere", "job": None, "noise": {"preset": "paper"}, "clients": 1}
EXPLORED = {"id": 7, "method": "explore", "state": "done", "error": None, "progress": 1.0, "start_tick": 10, "end_tick": 90, "finger": "ring",
            "criterion": "manipulability", "converged": True, "reason": "gradient", "cycles": 80, "phi_initial": 1.0, "phi_final": 1.1,
            "phi_true_initial": 1.01, "phi_true_final": 1.12, "path_length_m": 0.004, "seed": 3}


def running(_):
    raise Refusal(-32004, "job 7 has not ended", "job.wait again")


class Sockets(Case):
    def test_absent(self):
        cause, hint = self.refused(3, "status")
        self.assertIn(str(self.socket), cause)
        self.assertIn("regrasp up", hint)

    def test_stale(self):
        self.socket.parent.mkdir()
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind(str(self.socket))
        cause, _ = self.refused(3, "status")
        self.assertIn("stale", cause)

    def test_not_a_socket_is_left_alone(self):
        self.socket.parent.mkdir()
        self.socket.write_text("precious")
        cause, _ = self.refused(3, "status")
        self.assertIn("not a socket", cause)
        self.assertEqual(self.socket.read_text(), "precious")

    def test_another_protocol(self):
        def refuse(params):
            self.assertEqual(params, {"protocol": [1, 1]})
            raise Refusal(-32012, "this daemon speaks protocol 2, the client 1 to 1", "use programs of one version")
        fake = FakeDaemon(self.socket, {"hello": refuse, "status": lambda _: STATUS, "shutdown": lambda _: b""})
        self.addCleanup(fake.close)
        cause, hint = self.refused(8, "status")
        self.assertIn(f"{self.socket}: this daemon speaks protocol 2, the client 1 to 1", cause)
        self.assertIn("regrasp down, then regrasp up", hint)
        self.assertEqual(fake.requests, [])

    def as_nobody(self, *words, env):
        """Runs `regrasp` as a user without rights (the tests may run as root, for whom nothing is forbidden)."""
        user = 65534 if os.geteuid() == 0 else None
        program = self.dir / "regrasp"  # the build may be where others cannot look
        shutil.copy(REGRASP, program)
        return subprocess.run([str(program), *words], env=env, capture_output=True, text=True, timeout=HANG_S, check=False, user=user)

    def test_no_right_to_connect(self):
        fake = FakeDaemon(self.socket, {"status": lambda _: STATUS})
        self.addCleanup(fake.close)
        self.socket.chmod(0)
        self.socket.parent.chmod(0o755)
        self.dir.chmod(0o755)
        done = self.as_nobody("-s", str(self.socket), "status", env=environment())
        self.assertEqual((done.returncode, done.stdout), (77, ""), done.stderr)
        owner = pwd.getpwuid(os.geteuid()).pw_name
        self.assertIn(f"not allowed to open {self.socket}: it belongs to {owner}", done.stderr)
        self.assertIn(f"try: regrasp -s PATH up    (a daemon of your own; or run as {owner})", done.stderr)
        # Where the directory is closed too, nobody can tell whose it is.
        self.socket.parent.chmod(0)
        done = self.as_nobody("-s", str(self.socket), "status", env=environment())
        self.assertEqual((done.returncode, done.stdout), (77, ""), done.stderr)
        self.assertIn("run as the user who started this one", done.stderr)
        self.socket.parent.chmod(0o755)

    def test_a_directory_of_another_user_is_not_trusted(self):
        if os.geteuid() != 0:
            self.skipTest("only root can give a directory away")
        place = self.dir / "regrasp"
        fake = FakeDaemon(place / "regrasp.sock", {"status": lambda _: STATUS})
        self.addCleanup(fake.close)
        os.chown(place, 12345, 12345)
        done = subprocess.run([str(REGRASP), "status"], env=environment(XDG_RUNTIME_DIR=str(self.dir)), capture_output=True, text=True, timeout=HANG_S,
                              check=False)
        self.assertEqual((done.returncode, done.stdout), (77, ""), done.stderr)
        self.assertIn(f"{place} belongs to user 12345", done.stderr)
        self.assertIn("regrasp -s PATH", done.stderr)
        self.assertEqual(fake.requests, [])

    def test_every_trouble_with_the_socket_has_its_own_next_step(self):
        self.socket.parent.mkdir()
        said = {tuple(self.refused(3, "status"))}
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind(str(self.socket))
        said.add(tuple(self.refused(3, "status")))
        self.socket.unlink()
        self.socket.write_text("precious")
        said.add(tuple(self.refused(3, "status")))
        self.assertEqual(len({cause for cause, _ in said}), 3)
        self.assertEqual(len({hint for _, hint in said}), 3)

    def test_too_long_a_path(self):
        self.socket = self.dir / ("x" * 200)
        self.refused(2, "status")

    def test_flag_beats_environment(self):
        fake = FakeDaemon(self.socket, {"status": lambda _: STATUS})
        self.addCleanup(fake.close)
        env = environment(REGRASP_SOCKET=str(self.dir / "other.sock"))
        self.assertIn("holding", self.expect(0, "status", env=env).stdout)
        done = subprocess.run([str(REGRASP), "status"], env=env, capture_output=True, text=True, timeout=HANG_S, check=False)
        self.assertEqual(done.returncode, 3)
        self.assertIn("other.sock", done.stderr)


class FakeCase(Case):
    def fake(self, **answers):
        daemon = FakeDaemon(self.socket, {name.replace("__", "."): answer for name, answer in answers.items()})
        self.addCleanup(daemon.close)
        return daemon

    def forget_socket(self):
        """Makes room for another daemon on the same path."""
        self.socket.unlink(missing_ok=True)


class Answers(FakeCase):
    def test_error_codes_become_exit_codes(self):
        for rpc, code in [(-32001, 5), (-32002, 5), (-32003, 6), (-32004, 4), (-32005, 77), (-32006, 7), (-32007, 74), (-32010, 5), (-32011, 8),
                          (-32012, 8), (-32602, 2), (-32601, 8), (-32700, 8), (-1, 8)]:
            with self.subTest(rpc):
                self.forget_socket()

                def refuse(_, number=rpc):
                    raise Refusal(number, "the cause", "regrasp next")
                self.fake(grasp=refuse)
                self.assertEqual(self.refused(code, "grasp"), ["regrasp: the cause", "  try: regrasp next"])
                error = json.loads(self.expect(code, "--json", "grasp").stderr)["error"]
                self.assertEqual((error["code"], error["exit_code"], error["hint"]), (rpc, code, "regrasp next"))

    def test_everyday_units_become_si(self):
        noise = {"preset": "custom", "position_m": 0.001}
        fake = self.fake(noise__set=lambda _: noise, push=lambda p: {**p, "duration_s": 0.1}, param__set=lambda p: {**p, "unit": "", "min": 0, "max": 1},
                         explore=lambda _: {"job": 7}, plot=lambda p: {"file": "quality.png", "path": "/x/quality.png"},
                         param__get=lambda p: {**p, "value": 1, "unit": "N", "min": 0, "max": 5})
        self.expect(0, "noise", "set", "--position", "2", "--normal", "90", "--pose", "1,90")
        method, params = fake.requests.pop()
        self.assertEqual(method, "noise.set")
        for name, value in {"position_m": 0.002, "normal_rad": 1.57079633, "object_position_m": 0.001, "object_rotation_rad": 1.57079633}.items():
            self.assertAlmostEqual(params.pop(name), value, delta=1e-8)
        self.assertEqual(params, {})
        self.expect(0, "push", "--force", "-1,0.5,-.25", "--duration", "0.2")
        self.assertEqual(fake.requests.pop(), ("push", {"force_n": [-1, 0.5, -0.25], "duration_s": 0.2}))
        self.expect(0, "param", "set", "gravity", "0,0,-9.81")
        self.assertEqual(fake.requests.pop(), ("param.set", {"name": "gravity", "value": [0, 0, -9.81]}))
        self.expect(0, "explore", "ring", "--criterion", "switched", "--seed", "9007199254740992", "--max-cycles", "12")
        self.assertEqual(fake.requests.pop(), ("explore", {"finger": "ring", "criterion": "switched", "seed": 9007199254740992, "max_cycles": 12}))
        self.assertEqual(self.expect(0, "plot", "quality", "--last", "3").stdout, "/x/quality.png\n")
        self.assertEqual(fake.requests.pop(), ("plot", {"name": "quality", "last_s": 3}))
        # Units, also mixed; the other side gets SI.
        self.expect(0, "push", "--force", "500mN,0.25N,-1", "--duration", "50ms")
        self.assertEqual(fake.requests.pop(), ("push", {"force_n": [0.5, 0.25, -1], "duration_s": 0.05}))
        self.expect(0, "noise", "set", "--position", "0.05cm", "--normal", "0.1rad", "--pose", "1000um,0.1rad")
        method, params = fake.requests.pop()
        self.assertEqual(method, "noise.set")
        for name, value in {"position_m": 5e-4, "normal_rad": 0.1, "object_position_m": 1e-3, "object_rotation_rad": 0.1}.items():
            self.assertAlmostEqual(params[name], value, 12)
        self.expect(0, "param", "set", "control.grip_force", "1500mN")
        self.assertEqual(fake.requests[-2:], [("param.get", {"name": "control.grip_force"}), ("param.set", {"name": "control.grip_force", "value": 1.5})])
        self.assertIn("'1.5deg' has the unit 'deg'; allowed are N, mN (without one it is N)", self.refused(2, "param", "set", "control.grip_force", "1.5deg")[0])
        self.assertIn("allowed are mm, cm, m, um (without one it is mm)", self.refused(2, "noise", "set", "--position", "1deg")[0])

    def test_status_for_people_json_and_csv(self):
        self.fake(status=lambda _: STATUS)
        text = self.expect(0, "status").stdout
        for part in ("holding", "1.500 s", "tick 1500", "shadow", "sphere", "paper"):
            self.assertIn(part, text)
        self.assertEqual(self.json("status"), STATUS)
        header, row = self.expect(0, "--csv", "status").stdout.splitlines()
        self.assertEqual(dict(zip(header.split(","), row.split(",")))["noise.preset"], "paper")
        self.assertEqual(self.expect(0, "-q", "status").stdout, "")

    def test_nonsense_is_a_protocol_error(self):
        for answer in (b"HTTP/1.1 400 Bad Request\n", b"[1]\n", b'{"jsonrpc":"2.0","id":2}\n', b'{"jsonrpc":"2.0","id":2,"error":{"code":"x"}}\n'):
            with self.subTest(answer):
                self.forget_socket()
                self.fake(status=lambda _, text=answer: text)
                self.refused(8, "status")

    def test_a_daemon_that_goes_away(self):
        self.fake(status=lambda _: b'{"jsonrpc"')
        self.refused(3, "status")

    def test_silence_is_a_timeout(self):
        self.fake(status=lambda _: None)
        self.refused(4, "--timeout", "0.2", "status")


class Waiting(FakeCase):
    def test_wait_prints_the_record_and_judges_it(self):
        for change, code, word in [({}, 0, "converged (gradient)"), ({"converged": False, "reason": "max_cycles"}, 1, "not converged (max_cycles)"),
                                   ({"state": "failed", "error": "object dropped"}, 1, "object dropped"), ({"state": "cancelled"}, 1, "cancelled")]:
            with self.subTest(word):
                self.forget_socket()
                record = {**EXPLORED, **change}
                self.fake(explore=lambda _: {"job": 7}, job__wait=lambda _, r=record: r)
                done = self.expect(code, "explore", "ring", "--wait")
                self.assertIn(word, done.stdout)
                self.assertEqual(done.stderr, "")
                self.assertEqual(json.loads(self.expect(code, "--json", "explore", "ring", "--wait").stdout), record)
                self.expect(code, "job", "wait", "7")

    def test_timeout_says_that_the_job_goes_on(self):
        self.fake(explore=lambda _: {"job": 7}, job__wait=running)
        cause, hint = self.refused(4, "--timeout", "0.1", "explore", "ring", "--wait")
        self.assertIn("goes on", cause)
        self.assertIn("regrasp job wait 7", hint)

    def test_interrupt_says_how_to_wait(self):
        fake = self.fake(explore=lambda _: {"job": 7}, job__wait=lambda _: None)
        process = subprocess.Popen([str(REGRASP), "-s", str(self.socket), "explore", "ring", "--wait"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True, env=environment())
        while not any(method == "job.wait" for method, _ in fake.requests):
            self.assertIsNone(process.poll())
        process.send_signal(2)
        out, err = process.communicate(timeout=HANG_S)
        self.assertEqual((process.returncode, out), (130, ""))
        self.assertIn("job 7 goes on", err)
        self.assertIn(f"regrasp -s {self.socket} job wait 7", err)
        self.assertNotIn("job.cancel", [method for method, _ in fake.requests])

    def test_progress_is_for_terminals(self):
        polls = []

        def wait(params):
            polls.append(params)
            if len(polls) < 4:
                running(params)
            return EXPLORED
        self.fake(explore=lambda _: {"job": 7}, job__wait=wait, job__get=lambda _: {**EXPLORED, "state": "running", "progress": 0.45},
                  quality=lambda _: {"fingers": {"ring": {"manipulability": 1.234}}})
        terminal = Terminal([REGRASP, "-s", self.socket, "explore", "ring", "--wait"], environment(TERM="xterm"))
        self.assertEqual(terminal.finish(), 0)
        self.assertIn("45 %", terminal.text)
        self.assertIn("φ 1.234", terminal.text)
        self.assertIn("█", terminal.text)
        last = terminal.text.split("\r\x1b[K")[-1]
        self.assertIn("converged", last)  # the progress line is gone when the answer comes

    def test_the_letters_follow_the_locale(self):
        self.fake(quality=lambda _: {"criterion": "manipulability", "stability": 0.6, "threshold": 0.5, "load_margin_n": 0.2,
                                     "fingers": {"ring": {"manipulability": 1.2, "load_margin_without_n": 0.1, "joint_limit_margin_rad": 0.2}}})
        self.assertIn("φ", self.expect(0, "quality").stdout)
        self.assertTrue(self.expect(0, "quality", env=environment(LC_ALL="C")).stdout.isascii())


class Streams(FakeCase):
    def test_watch_counts_and_writes_lines(self):
        fake = self.fake(subscribe=lambda _: {"sub": 1})
        process = subprocess.Popen([str(REGRASP), "-s", str(self.socket), "--json", "watch", "truth", "--rate", "5", "--count", "3"],
                                   stdout=subprocess.PIPE, text=True, env=environment())
        while not fake.requests:
            self.assertIsNone(process.poll())
        self.assertEqual(fake.requests[0], ("subscribe", {"topic": "truth", "rate_hz": 5}))
        for seq in range(3):
            fake.notify(sub=1, seq=seq, dropped=0, t_s=seq * 0.2)
        lines = [json.loads(line) for line in process.communicate(timeout=HANG_S)[0].splitlines()]
        self.assertEqual([line["seq"] for line in lines], [0, 1, 2])
        self.assertEqual(process.returncode, 0)

    def test_follow_ends_with_130_on_interrupt(self):
        fake = self.fake(subscribe=lambda _: {"sub": 1})
        process = subprocess.Popen([str(REGRASP), "-s", str(self.socket), "events", "-f"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env=environment())
        while not fake.requests:
            self.assertIsNone(process.poll())
        fake.notify(sub=1, seq=0, dropped=0, t_s=1.25, kind="contact_lost", finger="ring", text="ring lost contact")
        self.assertIn("ring lost contact", process.stdout.readline())
        process.send_signal(2)
        out, err = process.communicate(timeout=HANG_S)
        self.assertEqual((process.returncode, out, err), (130, "", ""))


if __name__ == "__main__":
    unittest.main()
