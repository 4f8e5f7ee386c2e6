"""Parameters as a person handles them: list, get, set, reset, save, load."""

import json
import unittest

from harness import DaemonCase


class Parameters(DaemonCase):
    ARGUMENTS = ["--paused"]

    def changed(self):
        return {p["name"]: p["value"] for p in self.json("param", "list", "--changed")["parameters"]}

    def test_words_and_their_errors(self):
        self.expect(0, "param", "set", "gait.mode", "exploring")
        self.assertEqual(self.json("param", "get", "gait.mode")["value"], "exploring")
        text = self.expect(0, "param", "get", "gait.mode").stdout
        self.assertIn("gait.mode = exploring", text)
        self.assertIn("default returning", text)
        self.assertIn("exploring | returning", text)
        self.expect(0, "param", "set", "gait.hop", "false")
        self.assertIs(self.json("param", "get", "gait.hop")["value"], False)
        self.assertIn("object.friction is one number, with a point", self.refused(2, "param", "set", "object.friction", "0,5")[0])
        self.assertIn("'exploring'", self.refused(2, "param", "set", "gait.mode", "explore")[0])
        self.assertIn("out of range", self.refused(2, "param", "set", "object.friction", "7")[0])
        self.assertIn("true or false", self.refused(2, "param", "set", "gait.hop", "2")[0])
        self.refused(6, "param", "set", "gait.mod", "1")
        self.assertEqual(self.changed(), {"gait.mode": "exploring", "gait.hop": False})

    def test_what_is_changed_is_told_and_set_back(self):
        self.assertIn("every parameter has its default", self.expect(0, "param", "list", "--changed").stdout)
        self.expect(0, "param", "set", "gravity", "0,0,-1.62")
        self.expect(0, "param", "set", "gait.lead", "0.25")
        self.assertIn("gait.lead = 0.25, gravity = 0,0,-1.62", self.expect(0, "status").stdout)
        self.assertIn("changed parameters stay: gait.lead = 0.25", self.expect(0, "reset").stdout)
        self.assertEqual(self.json("param", "reset", "gait")["parameters"][0]["before"], 0.25)
        self.assertEqual(self.changed(), {"gravity": [0, 0, -1.62]})
        self.expect(0, "param", "reset")
        self.assertEqual(self.changed(), {})
        self.assertNotIn("changed", self.expect(0, "status").stdout)
        names = {line.split()[0] for line in self.expect(0, "param", "list", "gait").stdout.splitlines()[1:]}
        self.assertTrue(all(name.startswith("gait.") for name in names) and len(names) > 10, names)

    def test_a_saved_file_brings_everything_back(self):
        file = self.dir / "mine.toml"
        for name, value in (("gait.preset", "paper"), ("gait.margin_min", "0.05"), ("gait.hop", "false"), ("gravity", "0,0.1,-9.7"), ("exploration.max_cycles", "700"),
                            ("exploration.lambda", "0.123456789012345678")):
            self.expect(0, "param", "set", name, value)
        before = self.changed()
        self.assertIn("12 parameters that differ from their defaults", self.expect(0, "param", "save", file).stdout)
        self.assertEqual(self.expect(0, "param", "save", "-").stdout, file.read_text())
        self.expect(0, "param", "reset")
        self.expect(0, "param", "load", file)
        self.assertEqual(self.changed(), before)
        # The same file is a configuration file.
        self.assertIn("is fine", self.expect(0, "config", "check", file).stdout)
        everything = self.dir / "all.toml"
        self.expect(0, "param", "save", "--all", everything)
        self.expect(0, "param", "reset")
        self.expect(0, "param", "set", "gait.hop", "false")
        self.assertIn("1 parameter that differs from its default", self.expect(0, "param", "save", self.dir / "one.toml").stdout)
        self.expect(0, "param", "reset")
        self.expect(0, "param", "load", everything)
        self.assertEqual(self.changed(), before)

    def test_a_bad_file_changes_nothing_and_names_the_line(self):
        file = self.dir / "bad.toml"
        for text, code, line in (
                ("[parameters]\ngait.hop = false\ngait.mode = 'walk'\n", 2, ":3: gait.mode"),
                ("[parameters]\ngait.hop = false\n\ngait.mod = 1\n", 6, ":4: no parameter named 'gait.mod'"),
                ("[parameters]\ngait.lead = nan\n", 2, ":2: gait.lead"),
                ("[parameters]\ngait.lead = 1979-05-27\n", 2, ":2: gait.lead"),
                ("[parameters]\ngravity = [[1], 2, 3]\n", 2, ":2: gravity"),
                ("[parameters\n", 2, ":1: "),
                ("parameters = 3\n", 2, "no table [parameters]"),
                ("gait.hop = false\n", 2, "no table [parameters]")):
            file.write_text(text)
            self.assertIn(line, self.refused(code, "param", "load", file)[0])
            self.assertEqual(self.changed(), {}, text)
        file.write_text("[parameters]\nobject.friction = 7\ngait.mod = 1\ngait.hop = false\ngait.mode = 'walk'\ngait.lead = nan\n")
        errors = self.refused_list(2, "param", "load", file)
        for error, place in zip(errors, (":2: object.friction = 7 is out of range; allowed: 0.001 ... 1", ":3: no parameter named 'gait.mod'; did you mean 'gait.mode'?",
                                         ":5: gait.mode = 'walk': expected exploring or returning", ":6: gait.lead: expected")):
            self.assertTrue(error.startswith(f"{file}{place}"), errors)
        self.assertEqual(self.changed(), {})
        error = json.loads(self.regrasp("--json", "param", "load", file).stderr)["error"]
        self.assertEqual(error["errors"], errors)
        self.assertTrue(error["message"].startswith("4 errors:\n"))
        # Also what has a name too long to be repeated names the file; what are too many are counted.
        file.write_text("[parameters]\n" + f"{'a' * 80} = 1\n" + "".join(f"b{i} = 1\n" for i in range(69)))
        many = self.refused_list(6, "param", "load", file)
        self.assertTrue(all(error.startswith(f"{file}:") for error in many[:-1]), many)
        self.assertIn(f"{file}: no parameter named 'aaa", many[-2])
        self.assertEqual(many[-1], "and 20 more")
        self.refused(6, "param", "load", self.dir / "absent.toml")
        # What stands beside the table is no parameter, however much it looks like one.
        file.write_text("object.friction = 0.41\n[parameters]\ngait.hop = false\n")
        cause, _ = self.refused(2, "param", "load", file)
        self.assertEqual(cause, f"regrasp: {file}:1: object.friction: is outside of [parameters]; only what stands in that table is a parameter")
        file.write_text('"parameters.gait.hop" = true\n[parameters]\ngait.hop = false\n')
        self.assertIn(":1: parameters.gait.hop: is outside of [parameters]", self.refused(2, "param", "load", file)[0])
        file.write_text('seed = "x"\n[parameters]\ngait.mod = 1\n[object]\nmas_kg = 1\n')
        errors = self.refused_list(2, "param", "load", file)
        for error, place in zip(errors, (":1: seed: is outside", ":5: object.mas_kg: is outside"), strict=True):
            self.assertTrue(error.startswith(f"{file}{place}"), errors)
        self.assertEqual(self.changed(), {})
        self.refused(74, "param", "save", self.dir / "absent" / "x.toml")
        self.assertEqual([path.name for path in self.dir.iterdir() if path.name.endswith(".part") or path.name.startswith(".")], [])


if __name__ == "__main__":
    unittest.main()
