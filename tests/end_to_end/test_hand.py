"""`regrasp hand`: hands that nobody has prepared, from a URDF to an object that is held, without a daemon until then."""

import json
import math
import re
import resource
import shlex
import signal
import subprocess
import unittest

from harness import HANG_S, REGRASP, SOURCE, Case, environment

INERTIAL = '<inertial><origin xyz="0 0 {0}"/><mass value="{1}"/><inertia ixx="{2}" ixy="0" ixz="0" iyy="{2}" iyz="0" izz="{2}"/></inertial>'
JOINT = """<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/><origin xyz="{xyz}" rpy="0 0 {yaw}"/>
<axis xyz="{axis}"/><limit lower="{lower}" upper="{upper}" effort="{effort}" velocity="5"/>{more}</joint>
"""


def hand(fingers, effort=1, more='<dynamics damping="0.05"/>'):
    """Equal fingers of three joints on a circle, bending towards its axis. Made up for this test."""
    text = '<robot name="made_up"><link name="palm"/>\n'
    for f in range(fingers):
        a = 2 * math.pi * f / fingers
        n = f"arm{f + 1}"
        text += f'<link name="{n}a">{INERTIAL.format(0, 0.01, 1e-6)}</link>\n'
        for part, length in (("b", 0.05), ("c", 0.04)):
            text += f"""<link name="{n}{part}">{INERTIAL.format(length / 2, 0.02, 5e-6)}<collision><origin xyz="0 0 {0.6 * length}"/>
<geometry><cylinder radius="0.008" length="{0.6 * length}"/></geometry></collision></link>
"""
        text += JOINT.format(name=n + "_side", parent="palm", child=n + "a", xyz=f"{0.045 * math.cos(a):.6f} {0.045 * math.sin(a):.6f} 0",
                             yaw=f"{a:.6f}", axis="1 0 0", lower=-0.6, upper=0.6, effort=effort, more=more)
        text += JOINT.format(name=n + "_near", parent=n + "a", child=n + "b", xyz="0 0 0.01", yaw=0, axis="0 -1 0", lower=-0.3, upper=1.5,
                             effort=effort, more=more)
        text += JOINT.format(name=n + "_far", parent=n + "b", child=n + "c", xyz="0 0 0.05", yaw=0, axis="0 -1 0", lower=-0.2, upper=1.7,
                             effort=effort, more=more)
    return text + "</robot>\n"


class Hand(Case):
    def write(self, name, text):
        path = self.dir / name
        path.write_text(text, encoding="utf-8")
        return path

    def check(self, *words):
        done = self.regrasp("--json", "hand", "check", *words)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return json.loads(done.stdout)

    def refused(self, code, *words):
        done = self.regrasp(*words)
        self.assertEqual((done.returncode, done.stdout), (code, ""), done.stdout + done.stderr)
        self.assertIn("\n  try: ", done.stderr)
        return done.stderr

    def test_a_urdf_becomes_a_hand_that_holds(self):
        self.write("four.urdf", hand(4))
        made = self.regrasp("--json", "hand", "new", self.dir / "four.urdf", "-o", self.dir / "mine.toml", "--seed", "3")
        self.assertEqual(made.returncode, 0, made.stdout + made.stderr)
        sheet = json.loads(made.stdout)
        self.assertEqual(len(sheet["fingers"]), 4)
        self.assertGreater(sheet["load_margin_n"], 0.2)
        self.assertTrue(all(finger["manipulability"] > 0 for finger in sheet["fingers"]))
        self.assertTrue(sheet["held"], sheet)
        # Tried by what it is for: 9 seeds, each of 4 fingers, and a turn.
        used = sheet["used"]
        self.assertEqual((used["explorations"], used["turns"]), (36, 9))
        self.assertGreaterEqual(used["rose"], 27)
        self.assertGreaterEqual(used["turned"], 7)
        self.assertIn("searching a grasp", made.stderr)
        self.assertIn("exploring and turning with it", made.stderr)
        before = (self.dir / "mine.toml").read_text(encoding="utf-8")
        # The same seed finds the same; nothing is overwritten.
        again = self.regrasp("-q", "hand", "new", self.dir / "four.urdf", "-o", self.dir / "again.toml", "--seed", "3")
        self.assertEqual((again.returncode, again.stdout, again.stderr), (0, "", ""))
        self.assertEqual((self.dir / "again.toml").read_text(encoding="utf-8").replace("again", "mine"), before)
        self.assertIn("nothing is overwritten", self.refused(74, "hand", "new", self.dir / "four.urdf", "-o", self.dir / "mine.toml"))
        self.assertEqual((self.dir / "mine.toml").read_text(encoding="utf-8"), before)
        # And a daemon holds with it.
        self.addCleanup(self.regrasp, "down")
        self.expect(0, "up", "--hand", self.dir / "mine.toml", "--speed", "max", "--paused")
        self.expect(0, "grasp")
        self.expect(0, "step", 9000, "--wait")
        status = self.json("status")
        self.assertEqual((status["state"], status["hand"]), ("holding", "mine"))
        # Why this stepper: tried at load, and told alike by everything that is asked.
        self.assertEqual(status["stepper"], "fast")
        self.assertRegex(status["stepper_reason"], "^passed at load: .* within 5 %; 1 s of free motion$")
        shown = " ".join(self.expect(0, "status").stdout.split())  # lines of at most 80 columns
        self.assertIn(f"stepper fast ({status['stepper_reason']})", shown)
        self.assertEqual(self.check(self.dir / "mine.toml")["stepper_reason"], status["stepper_reason"])

    def test_check_tells_what_a_file_says(self):
        told = self.check(self.write("three.urdf", hand(3, more="")), "-o", self.dir / "three.png")
        self.assertEqual([finger["joints"] for finger in told["fingers"]][1], ["arm2_side", "arm2_near", "arm2_far"])
        self.assertEqual(told["fingers"][0]["tip_radius_m"], 0.008)
        self.assertEqual(len(told["joints"]), 9)
        self.assertIsNone(told["scenario"])
        self.assertIn(told["stepper"], ("fast", "exact"))
        self.assertRegex(told["stepper_reason"], "^(passed|failed) at load: ")
        warnings = "\n".join(told["warnings"])
        self.assertIn("<dynamics damping> is missing for 9 joints", warnings)
        self.assertIn("three fingers: none can leave", warnings)
        self.assertEqual((self.dir / "three.png").read_bytes()[:4], b"\x89PNG")
        # The hand that ships has nothing to warn of.
        self.assertEqual(self.check("shadow")["warnings"], [])

    def test_a_name_of_several_lines_is_told_in_one(self):
        told = self.expect(0, "hand", "check", self.write("four\n\x1b[2J.urdf", hand(4))).stdout
        self.assertIn("four\\x0a\\x1b[2J.urdf\n", told)
        self.assertNotIn("\x1b", told)

    def test_everything_that_is_wrong_is_told_at_once(self):
        text = hand(3, effort=-1).replace('radius="0.008"', 'radius="0,008"', 1)
        error = self.refused(1, "hand", "check", self.write("bad.urdf", text))
        self.assertIn("0,008", error)
        error = self.refused(1, "hand", "check", self.write("weak.urdf", hand(3, effort=-1)))
        self.assertEqual(error.count("effort [N m] = -1; must be >= 0"), 9)
        error = self.refused(1, "hand", "new", self.dir / "weak.urdf", "-o", self.dir / "weak.toml")
        self.assertEqual(error.count("effort [N m] = -1; must be >= 0"), 9)
        self.assertFalse((self.dir / "weak.toml").exists())

    def test_what_carries_the_whole_hand_is_held(self):
        rail = '<link name="{0}"/><joint name="{0}_j" type="{1}"><parent link="{0}"/><child link="{2}"/><axis xyz="0 0 1"/>{3}</joint>'
        limit = '<limit lower="-1" upper="1" effort="100" velocity="1"/>'
        for kind in ("prismatic", "floating", "planar"):
            carried = rail.format("floor", kind, "sled", limit) + rail.format("sled", "prismatic", "turntable", limit)
            carried += rail.format("turntable", "revolute", "palm", limit)
            sheet = self.check(self.write("carried.urdf", hand(3).replace("</robot>", carried + "</robot>")))
            bare = self.check(self.write("bare.urdf", hand(3)))
            self.assertEqual([f["joints"] for f in sheet["fingers"]], [f["joints"] for f in bare["fingers"]])
            warned = " ".join(sheet["warnings"])
            self.assertIn(f'joint "floor_j": type "{kind}" is not simulated; it moves every finger and is held at 0', warned)
            self.assertIn('joint "sled_j": type "prismatic" is not simulated', warned)
        sliding = self.write("sliding.urdf", hand(3).replace('"arm1_side" type="revolute"', '"arm1_side" type="prismatic"'))
        self.assertIn('joint "arm1_side": type "prismatic" moves some fingers and is not supported', self.refused(1, "hand", "check", sliding))

    def test_fingers_that_only_slide_are_named(self):
        sliding = self.write("gripper.urdf", hand(2).replace('type="revolute"', 'type="prismatic"'))
        for words in (["check", sliding], ["new", sliding, "-o", self.dir / "gripper.toml"]):
            error = self.refused(1, "hand", *words)
            self.assertIn("arm1_side (prismatic)", error)
            self.assertIn("a finger must turn", error)

    def test_joints_that_hardly_move_are_told(self):
        strong = self.write("strong.urdf", hand(3, more='<dynamics damping="100"/>'))
        warned = " ".join(self.check(strong)["warnings"])
        self.assertIn("lets 9 joints (arm1_side, ", warned)
        self.assertIn("they hardly move", warned)
        made = self.regrasp("hand", "new", strong, "-o", self.dir / "strong.toml").stdout
        self.assertIn("does not hold", made)
        self.assertIn("next: regrasp hand new", made.splitlines()[-1])
        self.assertNotIn("hardly", " ".join(self.check(self.write("fine.urdf", hand(3)))["warnings"]))

    def test_a_first_axis_along_x_of_its_link_can_be_built_at_rest(self):
        text = hand(3)
        for turned in ("0 0 1.5707963", "0 0 3.1415927", "0 0 0"):
            first = text.replace('rpy="0 0 0.000000"', f'rpy="{turned}"')
            first = first.replace('xyz="0 0 0.01" rpy="0 0 0"', 'xyz="0 0 0" rpy="0 0 0"')
            self.assertEqual(len(self.check(self.write("turned.urdf", first))["fingers"]), 3)

    def test_an_effort_that_was_not_filled_in_is_taken_from_the_default(self):
        told = self.check(self.write("idle.urdf", hand(3, effort=0)))
        self.assertIn("<limit> effort is 0 for 9 joints", "\n".join(told["warnings"]))
        self.assertEqual({joint["effort_nm"] for joint in told["joints"]}, {1})

    def test_fingers_that_cannot_touch_are_left_out(self):
        # One finger of four stands half a metre away.
        far = re.sub(r'(<child link="arm4a"/><origin xyz=)"[^"]*"', r'\1"0 -0.5 0"', hand(4))
        self.assertIn("0 -0.5 0", far)
        done = self.regrasp("--json", "hand", "new", self.write("far.urdf", far), "-o", self.dir / "far.toml")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        told = json.loads(done.stdout)
        self.assertEqual([finger["name"] for finger in told["fingers"]], ["finger1", "finger2", "finger3"])
        self.assertTrue(told["held"])
        self.assertIn("finger4 is left out and locked: with it no grasp was found that holds", "\n".join(told["remarks"]))
        self.assertIn("arm4_near", (self.dir / "far.toml").read_text().split("[locked_deg]")[1])

    def test_three_fingers_that_cannot_touch_together_are_told(self):
        far = re.sub(r'(<child link="arm3a"/><origin xyz=)"[^"]*"', r'\1"0 -0.5 0"', hand(3))
        error = self.refused(1, "-q", "hand", "new", self.write("far.urdf", far), "-o", self.dir / "far.toml")
        self.assertIn("no posture found in which 3 fingertips touch a ball of 50 mm", error)
        self.assertFalse((self.dir / "far.toml").exists())

    def test_fingers_that_follow_one_motor_are_told(self):
        text = re.sub(r'(<joint name="arm[2-4]_(\w+)".*?velocity="5"/>)', r'\1<mimic joint="arm1_\2"/>', hand(4), flags=re.DOTALL)
        self.assertEqual(text.count("<mimic"), 9)
        cause = "0 of 4 fingers have a motor of their own"
        self.assertIn(cause, "\n".join(self.check(self.write("one.urdf", text))["warnings"]))
        self.assertNotIn("motor", "\n".join(self.check(self.write("four.urdf", hand(4)))["warnings"]))
        # Where they cannot touch the ball, that is why.
        far = re.sub(r'(<child link="arm[34]a"/><origin xyz=)"[^"]*"', r'\1"0 -0.5 0"', text)
        error = self.refused(1, "-q", "hand", "new", self.write("far.urdf", far), "-o", self.dir / "far.toml")
        self.assertIn("no posture found", error)
        self.assertIn(cause, error)

    def test_the_hint_repeats_the_flags_that_help(self):
        text = hand(3).replace('<cylinder radius="0.008" length="0.03"/>', '<mesh filename="gone.stl"/>')
        error = self.refused(1, "hand", "check", self.write("gone.urdf", text))
        self.assertEqual(error.count("file not found"), 3)
        self.assertTrue(error.endswith("  try: mend the file, or the same with --fill-missing-meshes\n"), error)
        self.check(self.dir / "gone.urdf", "--fill-missing-meshes")

    def test_what_two_or_three_fingers_cannot_do_is_said_before_it_is_tried(self):
        for n in (3, 2):
            with self.subTest(fingers=n):
                self.expect(0, "-q", "hand", "new", self.write(f"few{n}.urdf", hand(n)), "-o", self.dir / f"few{n}.toml")
                self.addCleanup(self.regrasp, "down")
                self.expect(0, "up", "--hand", self.dir / f"few{n}.toml", "--clock", "lockstep")
                self.expect(0, "grasp", "--wait")
                tick = self.json("status")["tick"]
                error = self.refused(5, "explore", "finger1")
                self.assertIn("exploring needs a hand of four fingers or more", error)
                self.assertIn("regrasp move", error)
                for turn in (["--angle", "21"], ["--turns", "-1"], ["--continuous"]):
                    error = self.refused(5, "rotate", *turn)
                    self.assertIn("turning by more than gait.step_rad needs a hand of four fingers or more", error)
                status = self.json("status")
                self.assertEqual((status["state"], status["tick"]), ("holding", tick), "nothing was tried")
                self.assertEqual(len(self.json("job", "list")["jobs"]), 1)
                # What needs no regrasp goes, and within gait.step_rad that is a turn, too.
                if n == 3:
                    self.expect(0, "rotate", "--angle", "15", "--wait")
                    self.assertEqual(self.json("job", "show", "2")["regrasps"], 0)
                self.expect(0, "down")

    def test_what_was_granted_to_three_fingers_is_not_taken_from_a_turn_that_runs(self):
        self.expect(0, "-q", "hand", "new", self.write("three.urdf", hand(3)), "-o", self.dir / "three.toml")
        self.addCleanup(self.regrasp, "down")
        self.expect(0, "up", "--hand", self.dir / "three.toml", "--speed", "max", "--paused")
        self.expect(0, "grasp")
        self.expect(0, "step", 9000, "--wait")
        self.expect(0, "rotate", "--angle", "15")
        turn = self.json("job", "list")["jobs"][-1]["id"]
        self.expect(0, "step", 100, "--wait")
        error = self.refused(5, "param", "set", "gait.step_rad", "0.05")
        self.assertIn("gait.step_rad cannot be lowered while a hand whose fingers cannot regrasp turns", error)
        self.expect(0, "param", "set", "gait.step_rad", "0.4")  # more is no harm
        self.refused(5, "param", "reset", "gait")
        self.expect(0, "step", 9000, "--wait")
        done = self.json("job", "show", str(turn))
        self.assertEqual((done["state"], done["regrasps"]), ("done", 0), done)
        self.expect(0, "param", "set", "gait.step_rad", "0.05")

    def test_a_turn_that_ends_short_has_failed(self):
        # Without its stiffness the object stays behind: 21 of 28 degrees.
        self.expect(0, "-q", "hand", "new", self.write("three.urdf", hand(3)), "-o", self.dir / "three.toml")
        self.addCleanup(self.regrasp, "down")
        self.expect(0, "up", "--hand", self.dir / "three.toml", "--clock", "lockstep", "--speed", "max")
        self.expect(0, "param", "set", "control.follow_object", "0")  # a grasp by which it stays that far behind
        self.expect(0, "grasp", "--wait")
        for name, value in (("control.rotation_stiffness", 0), ("control.rotation_integral", 0), ("gait.step_rad", 0.7)):
            self.expect(0, "param", "set", name, value)
        done = self.expect(1, "rotate", "--angle", "28", "--wait")
        record = self.json("job", "show", "2")
        self.assertEqual(record["state"], "failed", record)
        self.assertLess(record["angle_rad"], math.radians(28 - 5))
        self.assertIn(f"turned by {math.degrees(record['angle_rad']):.1f} instead of 28.0 degrees", record["error"])
        self.assertIn(record["error"], done.stdout)
        self.assertEqual(self.json("status")["state"], "holding")

    def test_a_scenario_for_an_object_turns_it_until_it_fits(self):
        # A flat box, 20 x 60 x 70 mm, named from where the scenario stands; its inertia cannot be.
        (self.dir / "things").mkdir()
        box = self.dir / "things" / "flat.urdf"
        box.write_text('<robot name="flat"><link name="o"><inertial><mass value="0.09"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0"'
                       ' izz="1"/></inertial><collision><geometry><box size="0.06 0.02 0.07"/></geometry></collision></link></robot>', encoding="utf-8")
        self.write("four.urdf", hand(4))
        arguments = ["--object", box, "-o", self.dir / "flat.toml"]
        self.assertIn("--inertia-from-shape", self.refused(1, "-q", "hand", "new", self.dir / "four.urdf", *arguments))
        done = self.regrasp("--json", "hand", "new", self.dir / "four.urdf", *arguments, "--inertia-from-shape")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        told = json.loads(done.stdout)
        self.assertTrue(told["held"], told)
        self.assertEqual(told["object"], "things/flat.urdf")
        # The search's margins are of a ball; those of the object as it is held are told beside them, and what does not work.
        self.assertGreater(told["held_load_margin_n"], 0)
        self.assertTrue(all(finger["held_load_margin_without_n"] >= 0 for finger in told["fingers"]))
        score = (self.dir / "flat.toml").read_text(encoding="utf-8").splitlines()[1]
        self.assertIn(f"N of the ball of {1e3 * told['ball_m']:g} mm that stands for the object; without", score)
        used = told["used"]
        self.assertEqual(any("turns was completed" in remark for remark in told["remarks"]), used["turned"] == 0)
        self.assertEqual(len(used["may_not_leave"]), 4)
        for name, count in used["may_not_leave"].items():
            self.assertEqual(any(f"{name} may not leave in {count} of {used['turns']}" in remark for remark in told["remarks"]), count > 0)
        self.addCleanup(self.regrasp, "down")
        up = self.expect(0, "up", "--hand", self.dir / "flat.toml", "--clock", "lockstep")
        self.assertNotIn("warning: the object", up.stdout)
        self.expect(0, "grasp", "--wait")
        status = self.json("status")
        self.assertEqual((status["state"], status["object"]), ("holding", "flat"))

    def test_a_ball_of_a_size_that_does_not_ship_gets_a_file_of_its_own(self):
        three = self.write("three fingers.urdf", hand(3))
        done = self.regrasp("--json", "hand", "new", three, "-o", self.dir / "wide.toml", "--object-size", "57", "--inertia-from-shape")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        told = json.loads(done.stdout)
        self.assertEqual((told["object"], told["ball_file"], told["held"]), ("wide_ball.urdf", "wide_ball.urdf", True))
        ball = self.json("object", "show", self.dir / "wide_ball.urdf")
        self.assertEqual((ball["shape"], ball["size_m"][0], ball["mass_kg"]), ("sphere", 0.057, 0.08))
        # The command in its first line makes the same again, from where the scenario stands.
        made = (self.dir / "wide.toml").read_text(encoding="utf-8")
        words = shlex.split(made.splitlines()[0].removeprefix("# Made by: "))
        self.assertEqual(words[:4], ["regrasp", "hand", "new", "three fingers.urdf"])
        self.assertEqual(words[-1], "--inertia-from-shape")
        self.assertIn("exists", self.refused(74, "hand", "new", three, "-o", self.dir / "wide.toml", "--object-size", "57"))
        (self.dir / "wide.toml").unlink()
        self.assertIn("wide_ball.urdf: exists", self.refused(74, "hand", "new", three, "-o", self.dir / "wide.toml", "--object-size", "57"))
        (self.dir / "wide_ball.urdf").unlink()
        again = subprocess.run([REGRASP, *words[1:]], env=environment(), cwd=self.dir, capture_output=True, text=True, timeout=HANG_S, check=False)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual((self.dir / "wide.toml").read_text(encoding="utf-8"), made)

    def test_a_scenario_that_the_disk_has_no_room_for_leaves_nothing(self):
        def full():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (100, resource.RLIM_INFINITY))

        words = [REGRASP, "-q", "hand", "new", self.write("two.urdf", hand(2)), "-o", self.dir / "two.toml"]
        done = subprocess.run(list(map(str, words)), env=environment(), preexec_fn=full, capture_output=True, text=True, timeout=HANG_S, check=False)
        self.assertEqual(done.returncode, 74, done.stderr)
        self.assertIn("two.toml", done.stderr)
        self.assertEqual([file.name for file in self.dir.iterdir() if file.suffix == ".toml"], [])

    def test_usage(self):
        four = self.write("four.urdf", hand(4))
        self.assertIn("file not found", self.refused(6, "hand", "check", self.dir / "gone.urdf"))
        self.assertIn("available are allegro", self.refused(6, "hand", "check", "gone"))
        lost = self.write("lost.toml", 'urdf = "none.urdf"\n' + (SOURCE / "models/hands/shadow.toml").read_text())
        alone = self.write("alone.toml", (SOURCE / "models/hands/shadow.toml").read_text())
        for scenario, cause in ((lost, "file not found"), (alone, "no alone.urdf beside it")):
            for words in (["hand", "check", scenario], ["up", "--hand", scenario], ["experiment", "rotation", "--hand", scenario, "-o", self.dir / "o"]):
                self.assertIn(cause, self.refused(6, *words))
        self.assertEqual(self.regrasp("hand", "check", "shadow", env=environment(REGRASP_MODELS_DIR="/nope")).returncode, 6)
        self.assertIn("--seed is given twice", self.refused(2, "hand", "new", "x.urdf", "-o", "x.toml", "--seed", "1", "--seed", "2"))
        self.assertIn("must end in .toml", self.refused(2, "hand", "new", four, "-o", self.dir / "x.txt"))
        self.assertIn("control character", self.refused(2, "hand", "new", four, "-o", self.dir / "a\nb.toml"))
        self.assertIn("no such directory", self.refused(74, "hand", "new", four, "-o", self.dir / "no" / "x.toml"))
        self.assertIn("20 to 150", self.refused(2, "hand", "new", four, "-o", self.dir / "x.toml", "--object-size", "500"))
        self.refused(2, "hand", "new", four)
        self.assertIn("a hand has 2 .. 8", self.refused(1, "hand", "check", self.write("one.urdf", hand(1))))


if __name__ == "__main__":
    unittest.main()
