"""Command lines made at random, of the words that the programs know and of others: an exit code of the contract and one
error of two lines, or a list of at most 50; never a signal.

    REGRASP_COMMAND_LINES=5000 REGRASP_BIN_DIR=build/release/bin REGRASP_SOURCE_DIR=. python3 tests/end_to_end/test_arguments.py
"""

import os
import random
import re
import subprocess
import unittest

from harness import HANG_S, REGRASP, REGRASPD, SOURCE, Case, environment

COUNT = int(os.environ.get("REGRASP_COMMAND_LINES", "200"))
CODES = {0, 1, 2, 3, 4, 5, 6, 7, 8, 74, 77}
# These start programs or daemons of their own; what they take is parsed by the same rules.
STARTERS = {"up", "demo", "experiment", "shell", "top", "bench"}
ODD = ["", "-", "--", "---", "-1", "0", "1e999", "nan", "inf", "-0", "1,2", "1,2,3", "1,,3", "9" * 400, "x" * 5000, "\u202e", "\x1b[31m", "a\nb", "ü",
       b"\xff\xfe", "../x", "/dev/null", "--json", "--json=2", "-s", "-o", "--timeout", "0.01", "%s%n", "$(x)", "=", "--=", "--csv", "-q", "-v", "--help", "@", "{}",
       "[1", '{"a":1}', "true"]


class Arguments(Case):
    def words(self):
        manual = subprocess.run([str(REGRASP), "help", "--manual"], env=environment(), capture_output=True, text=True, check=True).stdout
        words = set(re.findall(r"[a-z]+(?:[._-][a-z]+)*|--[a-z-]+", manual))
        known = subprocess.run([str(REGRASP), "__complete", ""], env=environment(), capture_output=True, text=True, check=True).stdout
        return sorted(words - STARTERS), sorted({line.split()[0] for line in known.splitlines() if line.split()} - STARTERS)

    def run_one(self, command, accepted, **variables):
        """Text comes of it whatever is given. An error is one line with its cause and at most one with the next command;
        between them stand lines of a list only where the cause ends in "errors:"."""
        done = subprocess.run(command, env=environment(**variables), cwd=self.dir, stdin=subprocess.DEVNULL, capture_output=True, timeout=HANG_S, check=False)
        self.assertIn(done.returncode, accepted, f"{command}: {done.stderr[-300:]}")
        for stream in (done.stdout, done.stderr):
            stream.decode("utf-8")
        if done.returncode:
            first, *others = done.stderr.split(b"\n")[:-1] or [b""]
            self.assertLessEqual(len(others), 52 if first.endswith(b" errors:") else 1, f"{command}: {done.stderr}")
        if done.returncode == 2:
            self.assertTrue(done.stderr, command)
            self.assertNotIn(b"\x1b", done.stderr, command)
            self.assertLess(len(done.stderr), 20000, command)
        return done

    def test_lines_of_an_argument_are_no_lines_of_an_error(self):
        forged = "x\n  try: rm -rf y"
        for words, code in (["config", "check", forged], 6), (["config", "check", "1 errors:\n  y"], 6), (["up", "--hand", "a\nb.toml"], 6), \
                           (["up", "--hand", forged], 6), (["up", "--noise", forged], 2), (["up", "--seed", forged], 2), (["hand", "check", forged], 6), \
                           (["object", "show", forged], 6), (["evaluate", forged], 6), (["param", "load", forged], 6), (["replay", forged], 6):
            said = self.run_one([str(REGRASP), "-s", str(self.socket), *words], {code}).stderr
            self.assertEqual(said.count(b"\n"), 2, said)
            self.assertIn(rb"\x0a", said, words)
        for option in ("--config", "--hand", "--seed", "--speed", "--noise", "--max-clients", "--what"):
            self.run_one([str(REGRASPD), "--check-config", option, forged], {2, 6})
        self.run_one([str(REGRASP), "config", "show"], {2}, REGRASP_SPEED=forged)

    def test_values_are_named_as_they_were_typed(self):
        self.assertIn("--json=0: this version", self.regrasp("--json=0", "version").stderr)
        self.assertIn("--by is 70.71 mm long; allowed are at most 50", self.refused(2, "move", "--by", "50,50,0")[0])
        self.assertEqual(self.refused(2, "help", "nose")[1], "  try: regrasp help noise")

    def test_hints_can_be_pasted(self):
        self.assertEqual(self.refused(2, "plot", "incident", "-o", "wh y/u.bmp")[1], "  try: regrasp plot incident -o 'wh y/u.png'")
        self.assertEqual(self.refused(74, "hand", "new", SOURCE / "models" / "shadow.urdf", "-o", "no dir/x.toml")[1], "  try: mkdir -p 'no dir'")

    def test_regrasp(self):
        words, commands = self.words()
        self.assertGreater(len(commands), 20)
        r = random.Random(3)
        codes = set()
        for _ in range(COUNT):
            line = [r.choice(commands)] if r.random() < 0.8 else []
            line += [r.choice(ODD) if r.random() < 0.4 else r.choice(words) for _ in range(r.randrange(6))]
            if any(word in STARTERS for word in line):
                continue
            codes.add(self.run_one([str(REGRASP), "-s", str(self.socket), *line], CODES).returncode)
        self.assertLessEqual({2, 3}, codes)

    def test_regraspd(self):
        options = sorted(set(re.findall(r"--[a-z-]+", subprocess.run([str(REGRASPD), "--help"], env=environment(), capture_output=True, text=True,
                                                                     check=True).stdout)))
        options.remove("--bench")
        r = random.Random(4)
        self.run_one([str(REGRASPD), "--check-config", "\x1b[31m"], {2})
        for _ in range(COUNT // 8):
            line = [r.choice(options) if r.random() < 0.6 else r.choice([o for o in ODD if o != ""]) for _ in range(r.randrange(1, 6))]
            # Whatever is right so far, this ends it.
            self.run_one([str(REGRASPD), "--models-dir", str(SOURCE / "models"), "--check-config", *line], {0, 2, 6, 74})


if __name__ == "__main__":
    unittest.main()
