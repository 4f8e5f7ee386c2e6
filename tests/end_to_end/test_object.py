"""`regrasp object show`, which needs no daemon; and what `up`, `reset` and `grasp` say of an object that begins inside the hand."""

import json
import subprocess
import unittest

from harness import REGRASPD, Case, DaemonCase, environment

BALL = """<?xml version="1.0"?>
<robot name="ball"><link name="object">
  <inertial><origin xyz="0 0 {z}"/><mass value="{mass}"/>
    <inertia ixx="{moment}" ixy="0" ixz="0" iyy="{moment}" iyz="0" izz="{moment}"/></inertial>
  {collisions}
</link></robot>
"""
SPHERE = '<collision><origin xyz="{x} 0 0"/><geometry><sphere radius="{r}"/></geometry></collision>'


class Shown(Case):
    def ball(self, mass=0.08, moment=2e-5, z=0, collisions=None):
        path = self.dir / "my ball.urdf"
        path.write_text(BALL.format(mass=mass, moment=moment, z=z, collisions=collisions or SPHERE.format(x=0, r=0.025)))
        return path

    def test_a_ball_is_what_the_formulas_say(self):
        shown = self.json("object", "show", self.ball())
        volume = 4 / 3 * 3.141592653589793 * 0.025**3
        self.assertEqual(shown["object"], "my ball")
        self.assertEqual([shown["shape"], shown["closed"], shown["accepted"], shown["pieces"]], ["sphere", True, True, 1])
        self.assertEqual(shown["size_m"], [0.05] * 3)
        self.assertAlmostEqual(shown["volume_m3"], volume, delta=1e-12)
        self.assertAlmostEqual(shown["density_kg_m3"], 0.08 / volume, delta=1e-6)
        for moment in shown["principal_moments_kg_m2"]:
            self.assertAlmostEqual(moment, 2e-5, delta=1e-15)
        self.assertAlmostEqual(shown["homogeneous_moments_kg_m2"][0], 0.4 * 0.08 * 0.025**2, delta=1e-12)
        self.assertEqual([shown["warnings"], shown["refusals"]], [[], []])
        text = self.expect(0, "object", "show", self.ball()).stdout
        for word in ("1 in 1 <collision>", "80 g", "50, 50, 50 mm", "65.45 cm³", "1222 kg/m³", "20, 20, 20 kg mm²"):
            self.assertIn(word, text)

    def test_pieces_are_one_body(self):
        shown = self.json("object", "show", self.ball(collisions=SPHERE.format(x=-0.02, r=0.02) + SPHERE.format(x=0.02, r=0.02)), "--inertia-from-shape")
        self.assertEqual([shown["shape"], shown["collisions"], shown["pieces"], shown["overlap_m3"]], ["mesh", 2, 2, 0])
        self.assertAlmostEqual(shown["size_m"][0], 0.08, delta=1e-4)
        along, across = shown["principal_moments_kg_m2"][0], shown["principal_moments_kg_m2"][2]
        self.assertAlmostEqual(along, 0.4 * 0.08 * 0.02**2, delta=0.005 * along)
        self.assertAlmostEqual(across, 0.4 * 0.08 * 0.02**2 + 0.08 * 0.02**2, delta=0.005 * across)

    def test_a_body_that_cannot_be_is_shown_with_every_reason(self):
        path = self.ball(mass=80, moment=1, z=0.04)
        done = self.expect(1, "--json", "object", "show", path)
        shown = json.loads(done.stdout)
        self.assertFalse(shown["accepted"])
        self.assertEqual(shown["mass_kg"], 80)
        self.assertEqual(len(shown["refusals"]), 3, shown["refusals"])
        for word in ("density", "outside of the shape", "--inertia-from-shape"):
            self.assertTrue(any(word in reason for reason in shown["refusals"]), shown["refusals"])
        self.assertTrue(all(f"{path}:4" in reason for reason in shown["refusals"]))
        forced = self.json("object", "show", path, "--force")
        self.assertEqual([forced["accepted"], len(forced["warnings"]), forced["refusals"]], [True, 3, []])
        text = self.expect(1, "object", "show", path).stdout
        self.assertEqual(text.count("  refused: "), 3)

    def test_what_is_refused_is_shown_as_the_file_has_it(self):
        path = self.ball()
        for wrong, told in (('izz="2e-05"', 'izz="4.5e-5"'), ('ixy="0"', 'ixy="5e-5"')):
            text = self.ball().read_text()
            self.assertIn(wrong, text)
            path.write_text(text.replace(wrong, told))
            shown = json.loads(self.expect(1, "--json", "object", "show", path).stdout)
            self.assertIn("principal moment", shown["refusals"][0])
            expected = [2e-5, 2e-5, 4.5e-5] if "izz" in wrong else [-3e-5, 2e-5, 7e-5]
            for moment, value in zip(shown["principal_moments_kg_m2"], expected, strict=True):
                self.assertAlmostEqual(moment, value, delta=1e-12)
            self.assertAlmostEqual(shown["homogeneous_moments_kg_m2"][0], 2e-5, delta=1e-12)
        path.write_text(text[: text.index("<inertia ")] + "</inertial>" + text.split("</inertial>")[1])
        shown = json.loads(self.expect(1, "--json", "object", "show", path).stdout)
        self.assertEqual([shown["principal_moments_kg_m2"], shown["inertia_kg_m2"]], [None, None])
        self.assertIn("moments      none in the file", self.expect(1, "object", "show", path).stdout)

    def test_every_program_gives_a_bad_model_the_same_code(self):
        bad = {"mass": self.ball().read_text().replace('mass value="0.08"', 'mass value="nan"'), "centre": self.ball(z=0.04).read_text(),
               "size": self.ball(collisions=SPHERE.format(x=0, r=25)).read_text(), "friction": self.ball().read_text()}
        for name, text in bad.items():
            path = self.dir / f"{name}.urdf"
            path.write_text(text)
            if name == "friction":
                path.with_suffix(".toml").write_text("friction = 2\n")
            with self.subTest(name):
                self.assertIn(str(path.with_suffix("")), self.expect(1, "object", "show", path).stdout + self.expect(1, "object", "show", path).stderr)
                self.expect(1, "up", "--object", path)
                check = subprocess.run([REGRASPD, "--check-config", "--object", str(path)], capture_output=True, text=True, env=environment(), check=False)
                self.assertEqual(check.returncode, 1, check.stderr)
        self.expect(6, "up", "--object", self.dir / "gone.urdf")
        self.expect(6, "up", "--object", "nosuch")

    def test_the_flag_a_message_names_mends_the_file(self):
        path = self.ball(moment=1e-3)
        reasons = json.loads(self.expect(1, "--json", "object", "show", path).stdout)["refusals"]
        self.assertIn("--inertia-from-shape", reasons[0])
        mended = self.json("object", "show", path, "--inertia-from-shape")
        self.assertAlmostEqual(mended["principal_moments_kg_m2"][0], 2e-5, delta=1e-12)

    def test_pictures_are_drawn_where_they_are_asked_for(self):
        for suffix, head in ((".png", b"\x89PNG"), (".pdf", b"%PDF"), (".svg", b"<?xml")):
            picture = self.dir / ("ball" + suffix)
            shown = self.json("object", "show", "egg", "-o", picture)
            self.assertEqual(shown["picture"], str(picture))
            self.assertTrue(picture.read_bytes().startswith(head))
        cause, _ = self.refused(74, "object", "show", "egg", "-o", self.dir / "ball.txt")
        self.assertIn("ball.txt", cause)
        cause, _ = self.refused(74, "object", "show", "egg", "-o", self.dir / "nowhere" / "ball.png")
        self.assertIn("nowhere", cause)

    def test_what_is_told_of_a_file_is_told_when_it_is_refused_too(self):
        path = self.ball(collisions=SPHERE.format(x=0, r=0.01) + SPHERE.format(x=0.1, r=0.01), moment=2)
        shown = json.loads(self.expect(1, "--json", "object", "show", path).stdout)
        self.assertGreater(len(shown["refusals"]), 0)
        (told,) = shown["warnings"]
        self.assertIn("2 parts that do not touch, 80 mm apart", told)

    def test_what_is_no_object_is_refused(self):
        cause, hint = self.refused(6, "object", "show", "eg")
        self.assertIn("available are", cause)
        self.assertIn("regrasp help object show", hint)
        cause, _ = self.refused(6, "object", "show", self.dir / "gone.urdf")
        self.assertIn("gone.urdf", cause)
        path = self.dir / "bad.urdf"
        path.write_text(self.ball().read_text().replace("0.025", "0,025").replace("0.08", "${m}"))
        done = self.expect(1, "object", "show", path)
        self.assertIn("2 errors", done.stderr)
        self.assertEqual(done.stdout, "")
        self.refused(2, "object", "show")
        error = json.loads(self.expect(1, "--json", "object", "show", path).stderr)["error"]
        self.assertIn("bad.urdf:3", error["message"])


class Restored(DaemonCase):
    ARGUMENTS = ["--speed", "max", "--paused"]

    def test_a_checkpoint_of_an_object_that_is_loaded_is_restored(self):
        path = self.dir / "slick.urdf"
        for mass, moment, friction in ((0.08, 2e-5, 0.005), (2.4, 6e-4, 0.8)):
            path.write_text(BALL.format(mass=mass, moment=moment, z=0, collisions=SPHERE.format(x=0, r=0.03)))
            path.with_suffix(".toml").write_text(f"friction = {friction}\nforce = true\n")
            self.expect(0, "down")
            self.expect(0, "up", *self.ARGUMENTS, "--output-dir", self.dir / "out", "--object", path)
            self.expect(0, "checkpoint", "save", "mine")
            self.expect(0, "step", "5", "--wait")
            self.expect(0, "checkpoint", "restore", "mine", "--wait")
            for name, value in (("object.friction", friction), ("object.mass_kg", mass)):
                parameter = self.json("param", "get", name)
                self.assertEqual(parameter["value"], value)
                self.assertTrue(parameter["min"] <= value <= parameter["max"], parameter)
                self.expect(0, "param", "set", name, value)
            (self.dir / "out" / "mine.checkpoint").unlink()


class InsideTheHand(DaemonCase):
    ARGUMENTS = ["--speed", "max"]

    def test_an_object_that_begins_inside_a_link_is_said_so(self):
        self.assertEqual(self.json("status")["warnings"], [])
        big = self.dir / "objects" / "big.urdf"
        big.parent.mkdir()
        big.write_text(BALL.format(mass=1.0, moment=1.5e-3, z=0, collisions=SPHERE.format(x=0, r=0.06)))
        self.expect(0, "down")
        done = self.expect(0, "up", "--speed", "max", "--models-dir", self.dir, "--object", "big")
        self.assertRegex(done.stdout, r"warning: the object begins \d+\.\d mm inside the link \w+; grasp will refuse: regrasp hand new HAND --object FILE")
        self.assertEqual(len(self.json("status")["warnings"]), 1)
        failed = self.expect(1, "--json", "grasp", "--wait").stdout
        self.assertRegex(json.loads(failed)["error"], "inside the link .*; regrasp hand new HAND --object FILE -o NAME.toml fits a hand to it$")
        (told,) = [event["text"] for event in self.json("events")["events"] if event["kind"] == "refused"]
        self.assertEqual(told, "refused: " + json.loads(failed)["error"])
        self.assertEqual(self.json("reset", "--object", "sphere")["warnings"], [])
        self.assertIn("inside the link", self.expect(0, "reset", "--object", "big").stdout)
        self.expect(0, "reset", "--object", "sphere")
        self.expect(0, "grasp", "--wait")


if __name__ == "__main__":
    unittest.main()
