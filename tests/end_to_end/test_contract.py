"""What holds for every command: JSON with units, exit codes, nothing but the answer on stdout, a full disk, colour."""

import json
import re
import shlex
import subprocess
import unittest

from harness import DaemonCase, HANG_S, REGRASP, SOURCE, Terminal, environment

# No answer of their own to look at, or a length that other tests pay for.
ELSEWHERE = {
    "completion": "prints a script: test_completion", "demo": "minutes: test_daemon", "down": "ends the daemon: test_daemon",
    "top": "needs a terminal: test_top", "shell": "needs a terminal: test_shell",
    "hand check": "needs no daemon: test_hand", "hand new": "half a minute: test_hand",
    "replay": "needs a run file: test_record", "export": "needs a run file: test_record", "video": "needs a run file: test_record",
    "experiment exploration": "minutes: test_experiment", "experiment rotation": "minutes: test_experiment",
    "experiment zoo": "minutes: test_experiment_pairs", "experiment prediction": "minutes: test_experiment_pairs", "experiment paper": "an hour: test_experiment_paper", "experiment noise-sweep": "minutes: test_experiment", "experiment merge": "needs shards: test_experiment",
}
ENDLESS = {"events -f"}
# The exit codes an example may have besides 0: the operation was carried out and did not succeed.
MAY_FAIL = {"explore": {1}, "rotate": {1}, "move": {1}}
UNITS = ("_m", "_rad", "_n", "_s", "_nm", "_hz", "_kg", "_mm", "_deg", "_bytes", "_m_s", "_rad_s", "_m_s2", "_m3", "_kg_m3", "_kg_m2", "_n_s", "_1_m", "_fraction", "_wxyz", "_W", "_id", "_j")
# Numbers without a unit, and why: counts, numbers of things, ratios, measures without dimension.
PLAIN = re.compile(
    r"(tick|ticks|seq|dropped|id|job|sub|seed|clients|backlog|protocol|pid|cycles?|turns|steps?|count|bytes|code|max_cycles|exit_code|frames?|number|runs?|commands|messages|segments|continues|"
    r"progress|real_time_factor|speed|friction|mu|phi\w*|manipulability|stability|threshold|epsilon|volume|isotropy|sqrt_det|min_singular_value|"
    r"value|before|changed_parameters|kept|min|max|default|normal\w*|\w+_tick|frames_dropped|\w+_cycles|regrasps|ticks_per_s|reload|rows?|columns?|\d+|force_closure|axis|principal_axes|pieces|collisions|triangles|gradient_norm\w*|size|\w+_frames|\w*cells|reference_resets)$")


def numbers(value, path=()):
    """Every number in an answer, with the names on the way to it."""
    if isinstance(value, bool):
        return
    if isinstance(value, (int, float)):
        yield path, value
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from numbers(item, (*path, key))
    elif isinstance(value, list):
        for item in value:
            yield from numbers(item, path)


class EveryCommand(DaemonCase):
    def setUp(self):
        super().setUp()
        self.env = environment(REGRASP_SOCKET=str(self.socket), HOME=str(self.dir), REGRASP_MODELS_DIR=str(SOURCE / "models"))
        (self.dir / "grasp.json").write_text((SOURCE / "examples/grasp.json").read_text())
        (self.dir / "hand.toml").write_text("seed = 3\n")

    def commands(self):
        """Each command and the words of its first example."""
        for command in self.json("help")["commands"]:
            words = command["words"]
            if words in ELSEWHERE:
                continue
            self.assertTrue(command["examples"], f"cli/help/examples.cc has no example of '{words}'")
            example = next(e["line"] for e in command["examples"] if not any(e["line"].endswith(endless) for endless in ENDLESS))
            arguments = shlex.split(example.split(" && ")[-1].split(" > ")[0])
            self.assertEqual(arguments[0], "regrasp")
            yield words, [word for word in arguments[1:] if word not in ("--json", "--csv")]

    def prepare(self, words):
        """The state in which the command is welcome."""
        self.run_words("resume")
        if words in ("grasp", "release", "rotate", "move", "explore", "stop", "push"):
            self.run_words("reset", "--seed", "1")
            if words != "grasp":
                self.run_words("grasp", "--wait")
        if words == "job cancel":
            # The example cancels job 2: a daemon of its own has that number to give.
            self.run_words("rotate", "--continuous")
        if words == "step":
            self.run_words("pause")

    def run_words(self, *words, stdout=subprocess.PIPE):
        return subprocess.run([str(REGRASP), *words], env=self.env, stdout=stdout, stderr=subprocess.PIPE, text=True, timeout=HANG_S, check=False, cwd=self.dir,
                              stdin=subprocess.DEVNULL)

    def number(self, words, arguments):
        """Numbers of jobs and runs that exist here in place of the example's."""
        if words == "job cancel":
            return ["job", "cancel", str(json.loads(self.run_words("--json", "job", "list").stdout)["jobs"][-1]["id"])]
        return arguments

    def test_json_is_valid_with_units_and_alone_on_stdout(self):
        self.run_words("grasp", "--wait")
        for words, arguments in self.commands():
            with self.subTest(words):
                self.prepare(words)
                done = self.run_words("--json", *self.number(words, arguments))
                self.assertIn(done.returncode, {0} | MAY_FAIL.get(words, set()), done.stdout + done.stderr)
                self.assertEqual(done.stderr, "")
                self.assertNotIn("\x1b", done.stdout)
                answers = [json.loads(line) for line in done.stdout.splitlines()]
                self.assertTrue(answers)
                for answer in answers:
                    self.assertIsInstance(answer, dict)
                    for path, _ in numbers(answer):
                        named = any(part.endswith(UNITS) for part in path) or PLAIN.match(path[-1]) or (
                            len(path) > 1 and PLAIN.match(path[-2]) and not path[-2].isdigit()) or "args" in path
                        self.assertTrue(named, f"{'.'.join(path)} has no unit")

    def test_a_full_disk_is_74(self):
        self.run_words("grasp", "--wait")
        for words, arguments in self.commands():
            with self.subTest(words), open("/dev/full", "w", encoding="utf-8") as full:
                self.prepare(words)
                done = self.run_words(*self.number(words, [word for word in arguments if word != "--wait"]), stdout=full)
                self.assertEqual(done.returncode, 74, done.stderr)
                self.assertIn("No space left", done.stderr)

    def test_no_colour_where_it_is_not_wanted(self):
        self.run_words("grasp", "--wait")
        for words, arguments in self.commands():
            if words in ("bench", "doctor", "explore", "rotate", "move", "grasp", "release"):
                continue  # seconds each; the same Output as the others, and in the tests above without colour
            with self.subTest(words):
                self.prepare(words)
                arguments = self.number(words, arguments)
                self.assertNotIn("\x1b", self.run_words(*arguments).stdout)
                self.prepare(words)
                terminal = Terminal([REGRASP, *self.number(words, arguments)], {**self.env, "TERM": "xterm", "NO_COLOR": "1"}, cwd=self.dir)
                terminal.finish()
                self.assertNotRegex(terminal.text, r"\x1b\[[0-9;]*m")


class Errors(DaemonCase):
    def test_errors_leave_stdout_alone(self):
        for code, words in [(2, ["explore", "elbow"]), (5, ["explore", "ring"]), (6, ["job", "show", "99"]), (8, ["call", "nonsense"]),
                            (6, ["evaluate", str(self.dir / "absent.json")]), (2, ["--frobnicate"])]:
            with self.subTest(words):
                self.refused(code, *words)
                done = self.expect(code, "--json", *words)
                self.assertEqual(done.stdout, "")
                error = json.loads(done.stderr)["error"]
                self.assertEqual(error["exit_code"], code)
                self.assertTrue(error["hint"])


if __name__ == "__main__":
    unittest.main()
