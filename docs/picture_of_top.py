"""Writes docs/top.svg: what `regrasp top` shows while the hand turns the object.

    python3 docs/picture_of_top.py [BIN]      BIN: folder of the programs, build/release/bin by default

Needs python3-pexpect and python3-pyte (packages.txt).
"""

import html
import os
import pathlib
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
BIN = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "build/release/bin").resolve()
os.environ.setdefault("REGRASP_BIN_DIR", str(BIN))
os.environ.setdefault("REGRASP_SOURCE_DIR", str(ROOT))
sys.path.insert(0, str(ROOT / "tests/end_to_end"))

from harness import REGRASP, DaemonCase  # noqa: E402
from screen import Session  # noqa: E402

ROWS, COLUMNS, SECONDS = 34, 110, 12
WIDE, HIGH = 8.4, 18
NAMED = {"default": "#d8d8d8", "black": "#202020", "red": "#e06c60", "green": "#7fbf6a", "brown": "#d6b656", "blue": "#6aa5e0", "magenta": "#c08ad0",
         "cyan": "#5fbfc0", "white": "#f0f0f0"}


def colour(name, otherwise):
    if name == "default":
        return otherwise
    return NAMED.get(name.removeprefix("bright"), f"#{name}")


class Run(DaemonCase):
    ARGUMENTS = ["--speed", "1", "--seed", "1"]

    def runTest(self):
        self.expect(0, "grasp", "--wait")
        self.expect(0, "rotate", "--continuous")
        session = Session([REGRASP, "-s", self.socket, "top"], ROWS, COLUMNS, COLORTERM="truecolor")
        self.addCleanup(session.child.close)
        end = time.monotonic() + SECONDS
        while time.monotonic() < end:
            session.read()
        (ROOT / "docs/top.svg").write_text(svg(session.screen))


def svg(screen):
    width, height = COLUMNS * WIDE + 16, ROWS * HIGH + 16
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" font-family="DejaVu Sans Mono, monospace" font-size="14">',
             f'<rect width="{width:.0f}" height="{height:.0f}" rx="6" fill="#16181c"/>']
    for row in range(ROWS):
        column = 0
        while column < COLUMNS:
            cell = screen.buffer[row][column]
            look, text, first = cell._replace(data=""), "", column
            while column < COLUMNS and screen.buffer[row][column]._replace(data="") == look:
                text += screen.buffer[row][column].data
                column += 1
            ink, paper = colour(look.fg, NAMED["default"]), colour(look.bg, "#16181c")
            if look.reverse:
                ink, paper = paper, ink
            x, y = 8 + first * WIDE, 8 + row * HIGH
            if paper != "#16181c":
                parts.append(f'<rect x="{x:.1f}" y="{y:.1f}" width="{len(text) * WIDE:.1f}" height="{HIGH}" fill="{paper}"/>')
            if text.strip():
                weight = ' font-weight="bold"' if look.bold else ""
                parts.append(f'<text x="{x:.1f}" y="{y + 13.5:.1f}" textLength="{len(text) * WIDE:.1f}" xml:space="preserve" fill="{ink}"{weight}>'
                             f"{html.escape(text)}</text>")
    return "\n".join([*parts, "</svg>", ""])


if __name__ == "__main__":
    case = Run()
    case.setUp()
    try:
        case.runTest()
    finally:
        case.doCleanups()
