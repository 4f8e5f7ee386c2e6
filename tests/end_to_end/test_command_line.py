"""`regrasp` alone: words, errors, help, completion, evaluate, and what it links."""

import json
import math
import os
import subprocess
import unittest

from harness import Case, FakeDaemon, REGRASP, HANG_S, Terminal, environment

GRASP = {
    "contacts": [{"position_m": [0.025 * math.cos(a), 0.025 * math.sin(a), 0], "normal": [-math.cos(a), -math.sin(a), 0], "mu": 0.8}
                 for a in (0, 2 * math.pi / 3, 4 * math.pi / 3)],
    "torque_scale_m": 0.025, "cone_edges": 8,
}


class Words(Case):
    def test_wrong_words_are_usage_errors_with_the_nearest_name(self):
        for words, wrong, nearest in [
            (["statu"], "statu", "regrasp status"),
            (["noise", "preset", "papr"], "papr", "regrasp noise preset paper"),
            (["noise", "shwo"], "noise shwo", "regrasp noise show"),
            (["explore", "ring", "--critrion", "x"], "--critrion", "--criterion"),
            (["explore", "ring", "--criterion", "switchd"], "switchd", "regrasp explore --criterion switched"),
            (["watch", "qualty"], "qualty", "regrasp watch quality"),
            (["help", "explor"], "explor", "regrasp help explore"),
            (["grasp", "--wiat"], "--wiat", "--wait"),
            (["grasp", "--sockt", "x"], "--sockt", "--socket"),
            (["watch", "status", "--coulor", "never"], "--coulor", "--color"),
            # What the wire calls the parameter.
            (["move", "--offset", "0,0,5mm"], "--offset", "--by"),
            (["move", "--ofset", "0,0,5mm"], "--ofset", "--by"),
            (["move", "--rotation", "0,0,5"], "--rotation", "--turn"),
            (["explore", "ring", "--criterion", "manip"], "manip", "regrasp explore --criterion manipulability"),
            (["plot", "qualty"], "qualty", "regrasp plot quality"),
            (["help", "nose"], "nose", "regrasp help noise"),
        ]:
            with self.subTest(words):
                cause, hint = self.refused(2, *words)
                self.assertIn(f"'{wrong}'", cause)
                self.assertIn(nearest, hint)

    def test_names_that_are_no_words_of_the_grammar_have_a_nearest_too(self):
        out = ["-n", "1", "-o", self.dir / "out"]
        for code, words, near in [
            (6, ["hand", "check", "shdow"], "shadow"),
            (6, ["object", "show", "eg"], "egg"),
            (6, ["up", "--hand", "shdow"], "shadow"),
            (6, ["experiment", "rotation", "--object", "zoo_cylinder_lyin", *out], "zoo_cylinder_lying"),
            (2, ["experiment", "rotation", "--noise", "papr", *out], "paper"),
            (2, ["experiment", "rotation", "--case", "a: objct=egg", *out], "object"),
            (6, ["experiment", "rotation", "--set", "gait.spped=0.3", *out], "gait.speed_rad_s"),
        ]:
            with self.subTest(words):
                self.assertIn(f"did you mean '{near}'?", self.refused(code, *words)[0])
        self.assertIn("allowed are object, tilt, push, turns, criterion, gravity and names of parameters",
                      self.refused(2, "experiment", "rotation", "--case", "a: speed=3", *out)[0])
        self.assertIn("help up", self.refused(6, "up", "--hand", "shdow")[1])

    def test_hints_name_the_socket_that_the_line_has_named(self):
        named = self.dir / "a socket"
        for words, hint in [(["statu"], f"regrasp -s '{named}' status"), (["status"], f"regrasp -s '{named}' up"), (["explore"], "regrasp help explore")]:
            done = subprocess.run([REGRASP, *words, "-s", named], env=environment(), capture_output=True, text=True, timeout=HANG_S, check=False)
            self.assertEqual(done.stderr.splitlines()[1], "  try: " + hint)
            done = subprocess.run([REGRASP, *words], env=environment(REGRASP_SOCKET=str(named)), capture_output=True, text=True, timeout=HANG_S, check=False)
            self.assertEqual(done.stderr.splitlines()[1], "  try: " + hint.replace(f"-s '{named}' ", ""))

    def test_what_prints_no_table_refuses_csv(self):
        for words in (["object", "show", "egg"], ["hand", "check", "shadow"], ["hand", "new", "shadow", "-o", self.dir / "x.toml"],
                      ["replay", self.dir / "x.mcap"]):
            with self.subTest(words):
                self.assertIn("prints no table", self.refused(2, "--csv", *words)[0])

    def test_options_that_are_like_no_other_get_the_help_and_no_guess(self):
        for words in (["explore", "ring", "--offset", "5mm"], ["move", "--shift", "0,0,5"], ["rotate", "--rate", "4"], ["push", "--weight", "1"]):
            with self.subTest(words):
                self.assertEqual(self.refused(2, *words)[1], "  try: regrasp help " + words[0])

    def test_incomplete_and_contradictory_words_are_usage_errors(self):
        for words in [[], ["noise"], ["job"], ["explore"], ["param", "set", "gravity"], ["explore", "ring", "extra"], ["--json", "--csv", "status"],
                      ["-q", "-v", "status"], ["--json=2", "status"], ["noise", "set"], ["job", "show", "x"], ["job", "show", "0"], ["call", "status", "[1]"],
                      ["call", "status", "{"], ["completion", "tcsh"], ["--color", "red", "status"], ["--seed", "1", "status"]]:
            with self.subTest(words):
                done = self.expect(2, *words)
                self.assertEqual(done.stdout, "")
        asked = self.refused(2, "noise")[0]
        self.assertIn("'noise' needs a further word: ", asked)
        for word in ("show", "set", "preset", "off"):
            self.assertIn(word, asked)
        everything = self.refused(2)[0]
        for word in ("grasp", "experiment", "plot", "shell"):
            self.assertIn(word, everything)
        self.assertIn("'stop' has nothing to wait for", self.refused(2, "stop", "--wait")[0])

    def test_numbers_must_be_finite_and_in_range(self):
        for words in [["noise", "set", "--position", "nan"], ["noise", "set", "--position", "inf"], ["noise", "set", "--position", "1e9"],
                      ["noise", "set", "--position", "-1"], ["noise", "set", "--position", "1deg"], ["noise", "set", "--position", "1 furlong"],
                      ["push", "--force", "1s,2,3"], ["push", "--force", "1,2"], ["push", "--force", "1,nan,2"],
                      ["explore", "ring", "--seed", "1.5"], ["--timeout", "nan", "status"], ["--timeout", "0", "status"], ["step", "0"], ["noise", "set", "--pose", "1"],
                      ["watch", "status", "--rate", "0"], ["watch", "status", "--count", "0"]]:
            with self.subTest(words):
                self.refused(2, *words)
        self.assertIn("allowed are 0 to 2^53", self.refused(2, "explore", "ring", "--seed", "-1")[0])
        self.assertIn("--max-cycles 2000000: allowed are 1 to 1000000", self.refused(2, "explore", "ring", "--max-cycles", "2000000")[0])

    def test_units_of_options_that_are_not_on_the_wire(self):
        for words, told in [
            (["hand", "new", "none.urdf", "-o", "none.toml", "--object-size", "50s"], "allowed are mm, cm, m, um"),
            (["hand", "new", "none.urdf", "-o", "none.toml", "--object-size", "1cm"], "--object-size 10"),
            (["experiment", "rotation", "-o", "none", "--tilt", "1turn"], "--tilt 360: allowed are -180 to 180 deg"),
            (["hand", "new", "none.urdf", "-o", "none.toml", "--tilt", "181"], "--tilt 181: allowed are -180 to 180 deg"),
            (["hand", "new", "none.urdf", "-o", "none.toml", "--object-size", "1m"], "--object-size 1000: allowed are 20 to 150 mm"),
            (["hand", "new", "none.urdf", "-o", "none.toml", "--seed", "9007199254740993"], "allowed are 0 to 2^53"),
            (["experiment", "rotation", "-o", "none", "--push", "-1"], "--push -1: allowed are 0 to 100 N"),
            (["experiment", "rotation", "-o", "none", "--speed", "600"], "--speed 600: allowed are 0.0572958 to 572.957 deg/s"),
            (["rotate", "--turns", "1", "--speed", "600"], "--speed 600: allowed are 0.0572958 to 572.957 deg/s"),
            (["experiment", "rotation", "-o", "none", "--tilt", "3mm"], "allowed are deg, rad, turn"),
        ]:
            with self.subTest(words):
                self.assertIn(told, self.refused(2, *words)[0])

    def test_names_of_commands_may_be_arguments(self):
        # Each gets as far as looking for the daemon: the words were understood.
        for words in [["watch", "status"], ["noise", "preset", "off"], ["call", "status"], ["plot", "quality"], ["param", "get", "status"],
                      ["status", "--json"], ["push", "--force", "-1,-.5,0"], ["param", "set", "x", "-.5"], ["param", "set", "x", "-1,0,0"]]:
            with self.subTest(words):
                self.expect(3, *words)

    def test_errors_are_objects_with_json(self):
        for words in [["--json", "statu"], ["statu", "--json"], ["--json=1", "explore"]]:
            done = self.expect(2, *words)
            self.assertEqual(done.stdout, "")
            error = json.loads(done.stderr)["error"]
            self.assertEqual(error["exit_code"], 2)
            self.assertTrue(error["message"])
            self.assertTrue(error["hint"])

    def test_help_covers_every_command_and_fits_80_columns(self):
        overview = self.expect(0, "help").stdout
        commands = self.json("help")["commands"]
        self.assertGreater(len(commands), 30)
        for command in commands:
            self.assertIn(command["words"], overview)
            text = self.expect(0, "help", *command["words"].split()).stdout
            self.assertEqual(text, self.expect(0, *command["words"].split(), "--help").stdout)
            for line in text.splitlines() + overview.splitlines():
                self.assertLessEqual(len(line), 80, line)
            self.assertNotRegex(text, r"\d[eE][+-]?\d", "a limit with an exponent")


class Start(Case):
    def test_version(self):
        self.assertRegex(self.expect(0, "version").stdout, r"^regrasp \d+\.\d+\.\d+\n$")
        self.assertRegex(self.json("version")["version"], r"^\d+\.\d+\.\d+$")
        self.assertEqual(self.expect(0, "--version").stdout, self.expect(0, "version").stdout)
        self.assertEqual(self.expect(0, "-q", "version").stdout, "")

    def test_links_neither_simulation_nor_pictures(self):
        libraries = subprocess.run(["ldd", str(REGRASP)], capture_output=True, text=True, check=True).stdout
        for name in ("opencv", "libode", "urdfdom", "tinyxml", "assimp"):
            self.assertNotIn(name, libraries)

    def test_a_full_disk_is_an_io_error(self):
        for words in (["version"], ["help"], ["version", "--json"], ["completion", "bash"]):
            with open("/dev/full", "w", encoding="utf-8") as full:
                done = subprocess.run([str(REGRASP), *words], stdout=full, stderr=subprocess.PIPE, text=True, timeout=HANG_S, check=False)
            self.assertEqual(done.returncode, 74)
            self.assertIn("No space left", done.stderr)

    def test_runs_with_everything_closed(self):
        done = subprocess.run(["bash", "-c", f"exec {REGRASP} version <&- 2>&-"], capture_output=True, text=True, env=environment(), check=False)
        self.assertEqual((done.returncode, done.stdout[:8]), (0, "regrasp "))

    def test_a_closed_output_is_an_io_error(self):
        fake = FakeDaemon(self.socket, {"status": lambda _: {"state": "holding"}})
        self.addCleanup(fake.close)
        done = subprocess.run(["bash", "-c", f"exec {REGRASP} -s {self.socket} status >&-"], capture_output=True, text=True, env=environment(), check=False)
        self.assertEqual(done.returncode, 74, done.stderr)
        self.assertIn("Bad file descriptor", done.stderr)

    def test_colour_is_for_terminals_that_want_it(self):
        def coloured(*words, **env):
            terminal = Terminal([REGRASP, "help", *words], environment(TERM="xterm", **env))
            self.assertEqual(terminal.finish(), 0)
            return "\x1b[" in terminal.text
        self.assertTrue(coloured())
        self.assertFalse(coloured(NO_COLOR="1"))
        self.assertFalse(coloured("--color", "never"))
        self.assertTrue(coloured("--color", "always", NO_COLOR="1"))
        self.assertNotIn("\x1b[", self.expect(0, "help").stdout)
        self.assertIn("\x1b[", self.expect(0, "--color", "always", "help").stdout)

    def test_colour_of_errors_too(self):
        def coloured(*words, **env):
            terminal = Terminal([REGRASP, "status", *words], environment(**{"TERM": "xterm", "REGRASP_SOCKET": str(self.socket), **env}))
            self.assertEqual(terminal.finish(), 3)
            return "\x1b[" in terminal.text
        self.assertTrue(coloured())
        self.assertFalse(coloured(NO_COLOR="1"))
        self.assertFalse(coloured(TERM="dumb"))
        self.assertFalse(coloured("--color", "never"))
        self.assertNotIn("\x1b[", self.expect(3, "status").stderr)
        self.assertIn("\x1b[", self.expect(3, "--color", "always", "status").stderr)


class Evaluate(Case):
    def write(self, text):
        file = self.dir / "grasp.json"
        file.write_text(text if isinstance(text, str) else json.dumps(text))
        return file

    def test_three_contacts_on_the_equator(self):
        answer = self.json("evaluate", self.write(GRASP))
        self.assertTrue(answer["force_closure"])
        # Forces: G Gᵀ of the translations is 3·I (three contacts, orthonormal axes each); about z the three
        # tangential forces act with lever 1, the other two torques share lever 1 on e_z: eigenvalues 3 and 1.5.
        self.assertAlmostEqual(answer["min_singular_value"], math.sqrt(1.5), delta=1e-9)
        self.assertAlmostEqual(answer["isotropy"], math.sqrt(0.5), delta=1e-9)
        self.assertGreater(answer["epsilon"], 0)
        self.assertNotIn("load_margin_n", answer)

    def test_reads_standard_input_and_writes_csv(self):
        table = self.expect(0, "--csv", "evaluate", "-", stdin=json.dumps(GRASP)).stdout.splitlines()
        self.assertEqual(len(table), 2)
        row = dict(zip(table[0].split(","), table[1].split(",")))
        for name in ("epsilon", "volume", "min_singular_value", "sqrt_det", "isotropy", "force_closure"):
            self.assertIn(name, row)
        self.assertAlmostEqual(float(row["min_singular_value"]), math.sqrt(1.5), delta=1e-9)

    def test_refuses_bad_files_by_name(self):
        for text in ["", "{", "[]", '{"contacts": 1, "torque_scale_m": 1}', json.dumps({**GRASP, "cone_edge": 8}), json.dumps(GRASP).replace("0.8", "NaN", 1)]:
            cause, _ = self.refused(2, "evaluate", self.write(text))
            self.assertIn("grasp.json", cause)
        errors = self.refused_list(2, "evaluate", self.write('{"contacts": [{"mu": -1, "position_m": [0, 0, 1]}], "cone_edge\\n": 8}'))
        self.assertEqual(errors, ["cone_edge\\x0a: unknown name; nearest: cone_edges", "contacts[0].normal: missing", "torque_scale_m: missing",
                                  "contacts[0].mu: -1; allowed: 0 ... 10"])
        self.refused(6, "evaluate", self.dir / "absent.json")
        if os.geteuid() != 0:
            file = self.write(GRASP)
            file.chmod(0)
            self.refused(77, "evaluate", file)
        self.refused(74, "evaluate", self.dir)


if __name__ == "__main__":
    unittest.main()
