"""Sizes that keep a reader's way short: no file of core or daemon over 350 lines without a reason in
its first comment ("over 350 lines: ..."), no function over 60 in the folders of the paper's logic."""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FILE_LINES = 350
FUNCTION_LINES = 60
SHORT = ("core/session", "core/gait", "core/exploration")
NO_FUNCTION = re.compile(r"\b(namespace|class|struct|enum|union)\b")


def sources(*folders):
    for folder in folders:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in (".cc", ".h"):
                yield path


def first_comment(text):
    """The comment that a file begins with, after `#pragma once`."""
    lines = []
    for line in text.splitlines():
        if line.startswith("//"):
            lines.append(line)
        elif lines or (line.strip() and line.strip() != "#pragma once"):
            break
    return "\n".join(lines)


def functions(text):
    """(lines, first line, head) of every block in braces with a parameter list before it."""
    found, open_blocks, head = [], [], []
    for number, line in enumerate(text.splitlines(), 1):
        code = re.sub(r'"(\\.|[^"\\])*"', '""', line)
        code = re.sub(r"'(\\.|[^'\\])'", "", code).split("//")[0]
        for i, c in enumerate(code):
            if c == "{":
                open_blocks.append((number, " ".join(" ".join([*head, code[:i]]).split())))
            elif c == "}" and open_blocks:
                begin, what = open_blocks.pop()
                table = what.endswith(("(", "="))
                if "(" in what and not table and not NO_FUNCTION.search(what):
                    found.append((number - begin + 1, begin, what))
        ends = not code.strip() or code.rstrip()[-1] in ";{}"
        head = [] if ends else [*head, code.strip()]
    return found


class Sizes(unittest.TestCase):
    def test_the_counter_counts(self):
        text = ("namespace a {\nvoid Long(int x,\n          int y) {\n"
                '  if (x) {\n    Say("{");\n  }\n' + "  Do();\n" * 70 + "}\n"
                "class B {\n" + "  int c;\n" * 70 + "};\n}\n")
        long = [what for size, _, what in functions(text) if size > FUNCTION_LINES]
        self.assertEqual(long, ["void Long(int x, int y)"])
        self.assertEqual(first_comment("#pragma once\n\n/// One.\n/// Two.\n\nint x;  // no\n"),
                         "/// One.\n/// Two.")

    def test_no_file_is_longer_than_a_reader_wants(self):
        for path in sources("core", "daemon"):
            text = path.read_text()
            if text.count("\n") > FILE_LINES:
                with self.subTest(path.relative_to(ROOT)):
                    self.assertIn(f"over {FILE_LINES} lines:", first_comment(text))

    def test_functions_fit_on_a_page(self):
        seen = 0
        for path in sources(*SHORT):
            for size, line, what in functions(path.read_text()):
                seen += 1
                self.assertLessEqual(size, FUNCTION_LINES, f"{path.relative_to(ROOT)}:{line} {what}")
        self.assertGreater(seen, 500)


if __name__ == "__main__":
    unittest.main()
