"""`regrasp plot ... --show`: the picture in the terminal, as the terminal says it can."""

import base64
import re
import struct
import unittest
import zlib

from harness import Case, FakeDaemon, HANG_S, REGRASP, environment
from screen import Session

WIDTH, HEIGHT = 160, 80


def png():
    """The left half red, the right half white."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    row = b"\0" + b"\xff\0\0" * (WIDTH // 2) + b"\xff\xff\xff" * (WIDTH // 2)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 2, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(row * HEIGHT)) + chunk(b"IEND", b""))


class Pictures(Case):
    def setUp(self):
        super().setUp()
        self.picture = self.dir / "quality.png"
        self.picture.write_bytes(png())
        daemon = FakeDaemon(self.socket, {"hello": lambda _: {"protocol": 1, "version": "9.9.9", "server": "regraspd"},
                                          "plot": lambda _: {"file": "quality.png", "path": str(self.picture)}})
        self.addCleanup(daemon.close)

    def show(self, answer, *options, **env):
        """Plots on a terminal that answers the questions with `answer`; returns all that was written after them."""
        session = Session([REGRASP, "-s", self.socket, "--timeout", HANG_S, *options, "plot", "quality", "--show"], rows=30, columns=80, **env)
        self.addCleanup(session.child.close)
        if answer is not None:
            while b"\x1b[c" not in session.raw:
                self.assertTrue(session.read(), session.raw)
            session.press(answer)
        self.assertEqual(session.finish(), 0, session.text())
        self.assertEqual(session.modes_after, session.modes)
        return session

    def test_kitty_gets_the_file(self):
        raw = self.show("\x1b_Gi=31;OK\x1b\\\x1b[6;20;10t\x1b[?62;4c").raw
        self.assertEqual(base64.b64decode(b"".join(re.findall(rb"\x1b_G[^;]*m=[01];([^\x1b]*)\x1b\\", raw))), png())
        self.assertNotIn(b"\x1bP", raw)

    def test_sixel_where_the_attributes_say_so(self):
        raw = self.show("\x1b[6;20;10t\x1b[?62;4;22c").raw
        self.assertIn(b'"1;1;160;80', raw)
        self.assertRegex(raw, rb"#\d;2;100;0;0")
        self.assertRegex(raw, rb"#\d;2;100;100;100")
        small = self.show("\x1b[6;2;1t\x1b[?62;4c").raw  # cells of 1 x 2 pixels: the picture shrinks to 80 columns
        self.assertTrue(b'"1;1;80;40' in small)

    def test_blocks_elsewhere_in_the_colours_of_the_picture(self):
        session = self.show("\x1b[?1;2c", COLORTERM="truecolor")
        row = [line for line, text in enumerate(session.screen.display) if "▀" * 80 in text][5]
        self.assertEqual((session.screen.buffer[row][3].fg, session.screen.buffer[row][3].bg), ("ff0000", "ff0000"))
        self.assertEqual((session.screen.buffer[row][76].fg, session.screen.buffer[row][76].bg), ("ffffff", "ffffff"))
        session = self.show("\x1b[?1;2c")
        self.assertIn(b"\x1b[38;5;196;48;5;196m", session.raw)

    def test_dots_where_colour_is_not_wanted(self):
        for session in (self.show("\x1b[?1;2c", NO_COLOR="1"), self.show("\x1b[?1;2c", "--color", "never")):
            self.assertNotRegex(session.raw, rb"\x1b\[[\d;]*m")
            self.assertRegex(session.text(), "[\u2801-\u28ff]{10}")

    def test_a_terminal_that_would_print_the_question_is_not_asked(self):
        self.assertNotIn(b"\x1b[c", self.show(None, TERM="linux").raw)

    def test_a_pipe_gets_dots_and_no_escapes(self):
        out = self.expect(0, "plot", "quality", "--show").stdout
        self.assertEqual(out.splitlines()[0], str(self.picture))
        self.assertRegex(out, "[\u2801-\u28ff]{10}")
        self.assertNotIn("\x1b", out)

    def test_the_user_may_choose(self):
        for wish, mark in [("kitty", "\x1b_Ga=T"), ("sixel", "\x1bP0;1q"), ("blocks", "▀"), ("dots", "⣿")]:
            self.assertIn(mark, self.expect(0, "plot", "quality", "--show", env=environment(REGRASP_GRAPHICS=wish)).stdout)
        cause, _ = self.refused(2, "plot", "quality", "--show", env=environment(REGRASP_GRAPHICS="crayons"))
        self.assertIn("crayons", cause)

    def test_what_cannot_be_shown_is_an_error(self):
        self.assertIn("--show", self.expect(2, "--json", "plot", "quality", "--show").stderr)
        self.picture.write_bytes(png()[:100])
        done = self.expect(74, "plot", "quality", "--show")
        self.assertIn("quality.png", done.stderr)


if __name__ == "__main__":
    unittest.main()
