"""`regrasp top` on a terminal: what it shows at which size, its keys, and the terminal it leaves behind."""

import re
import signal
import socket
import unittest

from harness import Case, DaemonCase, FakeDaemon, REGRASP, environment
from screen import Session

FINGERS = ["F first", "M middle", "R ring", "L little", "T thumb"]
LEAVE_ALTERNATE_SCREEN, SHOW_CURSOR = b"\x1b[?1049l", b"\x1b[34h\x1b[?25h"


class Top(DaemonCase):
    def top(self, rows=24, columns=80, *options, **env):
        session = Session([REGRASP, "-s", self.socket, *options, "top"], rows, columns, **env)
        self.addCleanup(session.child.close)
        session.wait("q quit")
        return session

    def check_restored(self, session):
        self.assertEqual(session.modes_after, session.modes)
        self.assertIn(LEAVE_ALTERNATE_SCREEN, session.raw)
        self.assertIn(SHOW_CURSOR, session.raw[session.raw.rindex(b"\x1b[?25l"):])


class Sizes(Top):
    def check(self, session, rows, columns, wanted, unwanted=()):
        text = session.wait(lambda text: all(re.search(w, text) for w in wanted))
        lines = text.split("\n")
        self.assertEqual(len(lines), rows)
        for name in FINGERS:
            self.assertIn(name, text)
        for word in unwanted:
            self.assertNotIn(word, text)
        self.assertTrue(lines[-1].startswith(" q quit"), text)

    def test_everything_at_80x24(self):
        self.expect(0, "grasp", "--wait")
        session = self.top(24, 80)
        self.check(session, 24, 80, ["HOLDING", r"t [\d.]+ s", "waits for a job", r"tick p99 \d+ µs", "regrasp 0", "noise paper", "seed 1", "rec off", "1 client",
                                     "object", "explore", "ROLE", "CONTACT", "FORCE", "LIMIT", "MANIP", "Manipulability φ.*, 30 s", "Stability .*, 30 s", r"\[active\]",
                                     "Events", "s  holding"])

    def test_what_was_explored_before_is_known(self):
        self.expect(0, "grasp", "--wait")
        self.expect(1, "explore", "ring", "--max-cycles", "50", "--wait")
        self.expect(0, "rotate", "--angle", "5", "--wait")
        session = self.top(24, 80)
        session.wait("last: ring")

    def test_panels_go_in_order_at_60x15(self):
        self.check(self.top(15, 60), 15, 60, ["noise paper", "object", "explore", "LIMIT", "Manipulability", "Stability"], ["Events"])

    def test_a_small_terminal_still_shows_fingers(self):
        session = self.top(8, 40)
        self.check(session, 8, 40, ["FORCE"], ["Manipulability", "Events"])
        self.assertNotIn("small", session.text())

    def test_more_at_200x60(self):
        session = self.top(60, 200)
        self.check(session, 60, 200, ["sphere in shadow", "x reset", "Events"])
        self.assertGreater(sum("│" in line for line in session.text().split("\n")), 15)

    def test_a_storm_of_sizes(self):
        session = self.top()
        for turn in range(40):
            session.resize(1 + turn * 7 % 61, 1 + turn * 37 % 211)
        session.resize(24, 80)
        session.press("+")  # an answer to a key shows that it still listens
        session.wait("noise custom: contact position 1.25 mm")
        session.wait(r"(?s)IDLE.*tick p99.*T thumb.*Manipulability.*Stability.*Events")
        session.press("q")
        self.assertEqual(session.finish(), 0)
        self.check_restored(session)


class Control(Top):
    ARGUMENTS = ["--speed", "1", "--seed", "1"]

    def test_keys(self):
        session = self.top(40, 120)
        session.press("g")
        session.wait("job 1 started: grasp")
        session.wait("HOLDING")
        session.wait(r"off by \d\.\d\d mm")
        session.press("e")
        session.wait("explore: .*r ring")
        session.press("r")
        text = session.wait(r"R ring +E explore")
        self.assertIn("EXPLORING", text)
        session.wait(r"explore ring .*cycle \d+ .*gradient [\d.]+ [<>] ε [\d.]+ .*φ [\d.]+ → [\d.]+ [+-][\d.]+ %")
        session.wait("Manipulability φ ring")
        session.press("s")
        session.wait("ended by cancelled")
        session.press("rl")
        session.wait(r"target -?[\d.]+° +reached -?[\d.]+°")
        session.press(" ")
        session.wait("PAUSED")
        session.press(" ")
        session.wait(lambda text: "PAUSED" not in text)
        session.press("s")
        session.wait("HOLDING")
        session.press("lq")
        session.wait("picture: .*quality.png")
        self.assertTrue((self.dir / "out" / "quality.png").exists())
        session.press("?")
        session.wait("to the nearest joint limit")
        session.press("x")  # closes the help, and nothing else
        session.wait(lambda text: "nearest joint limit" not in text)
        session.press("x")
        session.wait("reset to the start")
        session.press("n")
        session.wait(r"(?m)^ q quit")
        session.press("xy")
        session.wait("IDLE")
        session.press("er")  # there is nothing to explore yet: the daemon's refusal is shown
        session.wait("explore: .*try: ")


class Leaving(Top):
    def test_by_key(self):
        session = self.top()
        session.press("q")
        self.assertEqual(session.finish(), 0)
        self.check_restored(session)

    def test_by_signal(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT):
            with self.subTest(number):
                session = self.top()
                session.kill(number)
                self.assertEqual(session.finish(), 130)
                self.check_restored(session)

    def test_by_control_c(self):
        session = self.top()
        session.press("\x03")
        self.assertEqual(session.finish(), 130)
        self.check_restored(session)

    def test_when_the_daemon_goes(self):
        session = self.top()
        self.expect(0, "down")
        self.assertEqual(session.finish(), 3)
        self.check_restored(session)
        after = session.raw[session.raw.rindex(LEAVE_ALTERNATE_SCREEN):].decode()
        self.assertIn("closed the connection", after)
        self.assertIn(f"try: regrasp -s {self.socket} up", after)


class Again(Case):
    def test_a_connection_that_was_closed_is_made_again(self):
        status = {"state": "holding", "version": "9.9.9", "time_s": 1.5, "clients": 1}
        fake = FakeDaemon(self.socket, {"events": lambda _: {"events": [{"kind": "x", "t_s": 1, "text": "once only"}]}, "status": lambda _: status,
                                        "contacts": lambda _: {}, "quality": lambda _: {}, "job.list": lambda _: {"jobs": []}, "subscribe": lambda _: {"sub": 1}})
        self.addCleanup(fake.close)
        session = Session([REGRASP, "-s", self.socket, "top"])
        self.addCleanup(session.child.close)
        session.wait("HOLDING")
        status["state"] = "rotating"
        fake.connections[0].shutdown(socket.SHUT_RDWR)
        session.wait("connected again")
        text = session.wait("ROTATING")
        self.assertEqual(text.count("once only"), 1)
        session.press("q")
        self.assertEqual(session.finish(), 0)


class Looks(Top):
    def test_no_colour_when_it_is_not_wanted(self):
        colour = re.compile(rb"\x1b\[(?:\d+;)*3[1-7]m")
        self.assertRegex(self.top().raw, colour)
        self.assertNotRegex(self.top(NO_COLOR="1").raw, colour)
        self.assertNotRegex(self.top(24, 80, "--color", "never").raw, colour)

    def test_ascii_where_there_is_no_utf8(self):
        session = self.top(LC_ALL="C")
        self.assertTrue(session.raw.isascii())
        session.wait("\\* touch|\\. none")


class WithoutTerminal(Case):
    def test_top_needs_a_terminal_and_a_daemon(self):
        session = Session([REGRASP, "-s", self.socket, "top"])
        self.assertEqual(session.finish(), 3)
        self.assertNotIn(b"\x1b[?1049h", session.raw)


class Piped(DaemonCase):
    def test_top_without_a_terminal_is_a_usage_error(self):
        cause, hint = self.refused(2, "top", env=environment(TERM="xterm"))
        self.assertIn("terminal", cause)
        self.assertIn("regrasp watch status", hint)
        self.assertIn("draws for people", self.expect(2, "--json", "top").stderr)


if __name__ == "__main__":
    unittest.main()
