"""A terminal with a user at it: a program under pexpect, its screen kept by pyte."""

import ast
import mmap
import re
import signal
import termios
import time

import pexpect
import pyte

from harness import HANG_S, environment


class Screen(pyte.Screen):
    """With the two scrolling sequences that pyte leaves out."""

    def scroll_up(self, count=1):
        self._scroll(count, self.margins.bottom if self.margins else self.lines - 1, self.index)

    def scroll_down(self, count=1):
        self._scroll(count, self.margins.top if self.margins else 0, self.reverse_index)

    def _scroll(self, count, row, step):
        keep, self.cursor.y = self.cursor.y, row
        for _ in range(count):
            step()
        self.cursor.y = keep


class Stream(pyte.ByteStream):
    csi = {**pyte.ByteStream.csi, "S": "scroll_up", "T": "scroll_down"}
    events = pyte.ByteStream.events | {"scroll_up", "scroll_down"}


class Session:
    """A program on a terminal of `rows` x `columns`; `raw` keeps every byte it wrote."""

    def __init__(self, words, rows=24, columns=80, **env):
        self.screen = Screen(columns, rows)
        self.stream = Stream(self.screen)
        self.raw = b""
        words = [str(w) for w in words]
        # The terminal's modes before the program can have changed them: its process looks before it becomes the program.
        shared = mmap.mmap(-1, 4096)
        # A terminal type with an alternate screen and without "repeat", which pyte does not know.
        self.child = pexpect.spawn(words[0], words[1:], dimensions=(rows, columns), timeout=HANG_S,
                                   env=environment(**{"TERM": "screen-256color", **env}), echo=True,
                                   preexec_fn=lambda: shared.write(repr(termios.tcgetattr(0)).encode()))
        self.modes = ast.literal_eval(shared[:].rstrip(b"\0").decode())

    def read(self):
        """Takes in what the program writes next; False at its end."""
        try:
            chunk = self.child.read_nonblocking(65536, timeout=HANG_S)
        except pexpect.EOF:
            return False
        self.raw += chunk
        self.stream.feed(chunk)
        return True

    def text(self):
        return "\n".join(line.rstrip() for line in self.screen.display)

    def wait(self, wanted):
        """Reads until `wanted` (a regular expression, or a predicate on the text) is on the screen;
        blanks and empty lines at the end do not count."""
        found = wanted if callable(wanted) else lambda text: re.search(wanted, text)
        deadline = time.monotonic() + HANG_S
        while not found(self.text().rstrip()):
            try:
                going = self.read()
            except pexpect.TIMEOUT:
                going = False
            if not going or time.monotonic() > deadline:
                raise AssertionError(f"{wanted!r} did not appear on:\n{self.text()}")
        return self.text()

    def press(self, keys):
        self.child.send(keys)

    def resize(self, rows, columns):
        self.child.setwinsize(rows, columns)
        self.screen.resize(rows, columns)

    def kill(self, number=signal.SIGTERM):
        self.child.kill(number)

    def finish(self):
        """Reads to the end; returns the exit code (minus the number of the signal that killed it)."""
        while self.read():
            pass
        modes = termios.tcgetattr(self.child.child_fd)
        self.child.close()
        self.modes_after = modes
        return -self.child.signalstatus if self.child.signalstatus else self.child.exitstatus
