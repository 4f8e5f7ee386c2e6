"""Run files as users meet them: recorded by one process, replayed by another, read by the public MCAP library,
whole and after kill -9."""

import csv
import json
import math
import os
import pathlib
import select
import shutil
import signal
import struct
import subprocess
import time
import unittest

from harness import Case, DaemonCase, HANG_S, REGRASP, SOURCE, children, environment
from read_exports import read_gif, read_npz


class Runs(DaemonCase):
    ARGUMENTS = ["--speed", "max", "--seed", "1", "--paused"]

    def step(self, ticks):
        self.expect(0, "step", ticks, "--wait")

    def record(self, name="run.mcap"):
        """A grasp, an exploration, a push, noise changes, a rotation, a move; 6.7 s. Returns the path."""
        path = self.json("record", "start", name)["path"]
        self.expect(0, "grasp")
        self.step(2800)
        self.expect(0, "noise", "preset", "coarse")
        self.expect(0, "explore", "ring", "--max-cycles", 800)
        self.step(1200)
        self.expect(0, "push", "--force", "0.2,0,0", "--duration", "0.05")
        self.expect(0, "noise", "set", "--position", "0.5")
        self.step(400)
        self.expect(0, "stop")
        self.step(200)
        self.expect(0, "rotate", "--angle", "10")
        self.step(600)
        self.expect(0, "stop")
        self.step(1000)
        self.expect(0, "move", "--by", "0,0,1", "--turn", "0,5,0")
        self.step(500)
        return pathlib.Path(path)

    def test_a_run_replays_in_another_process_and_tampering_shows(self):
        path = self.record()
        self.assertIn("run.mcap", self.expect(0, "status").stdout)
        stopped = self.json("record", "stop")
        self.assertNotIn("run.mcap", self.expect(0, "status").stdout)
        self.assertEqual(stopped["dropped"], 0)
        whole = self.json("replay", "run")  # by its name in the output directory
        self.assertTrue(whole["identical"])
        self.assertTrue(whole["same_build"])
        self.assertEqual((whole["commands"], whole["ticks"]), (9, 6700))
        self.assertGreater(whole["states_compared"], 500)
        self.expect(0, "down")
        self.assertIn("identical", self.expect(0, "replay", path, "--speed", "20").stdout)  # and without a daemon

        tampered = self.dir / "tampered.mcap"
        data = path.read_bytes()
        at = data.index(b'"duration_s":0.05')
        # Same length, so that every offset stays; the chunk's checksum is taken out of the way.
        tampered.write_bytes(without_checksums(data[:at] + b'"duration_s":0.06' + data[at + 17:]))
        found = self.json("replay", tampered, code=1)
        self.assertEqual(found["first_difference"]["tick"], 4000)
        self.assertEqual(found["first_difference"]["last_equal_tick"], 4000)
        self.assertIn("differs at tick 4000, at command 3 (push)", self.regrasp("replay", tampered).stdout)

    def test_exports_hold_the_same_numbers(self):
        path = self.record()
        self.expect(0, "record", "stop")
        self.expect(0, "export", path, "--format", "csv", "-o", self.dir / "csv")
        self.expect(0, "export", path, "--format", "npz", "-o", self.dir / "run.npz")
        self.expect(0, "export", path, "--format", "mcap", "-o", self.dir / "copy.mcap")
        self.assertTrue(self.json("replay", self.dir / "copy.mcap")["identical"])
        with open(self.dir / "csv" / "joints.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        angles = [column for column in rows[0] if column.startswith("angle_rad.")]
        self.assertEqual(len(angles), 22)
        self.assertTrue(all(column.endswith(" [rad]") for column in angles), angles)
        self.assertIn("t_s [s]", rows[0])
        # The configuration: a parameter's unit is that of its table.
        with open(self.dir / "csv" / "run.csv", encoding="utf-8") as file:
            columns = next(csv.reader(file))
        for unit in ("parameters.object.mass_kg.0 [kg]", "parameters.gravity.z [m/s2]", "parameters.control.grip_force.0 [N]",
                     "parameters.exploration.dither_hz.0 [Hz]", "parameters.exploration.lambda.0", "noise.object_rate_hz [Hz]",
                     "world.contact_stiffness_n_m [N/m]", "world.contact_damping_n_s_m [N s/m]"):
            self.assertIn(unit, columns)
        arrays = read_npz(self.dir / "run.npz")
        shape, values = arrays["joints.angle_rad"]
        self.assertEqual(shape, (len(rows), 22))
        for i, column in enumerate(angles):
            self.assertEqual(float(rows[-1][column]), values[-22 + i])
        self.assertEqual(arrays["contacts.p_WC_m"][0], (len(rows), 5, 3))
        self.assertIn("joints.torque_nm [N m]", arrays["units"][1])
        self.assertIn("exists", self.refused(74, "export", path, "--format", "npz", "-o", self.dir / "run.npz")[0])

    def test_a_replay_from_a_saved_state_comes_to_the_same(self):
        path = self.record()
        self.expect(0, "record", "stop")
        whole = self.json("replay", path, "--from", 0)
        self.assertEqual((whole["from"], whole["identical"], whole["end_tick"]), ("state", True, 6700))
        for start in (0.7, 3.3, 4.2, 5.05, 6.5):  # in a grasp, an exploration, a push, a rotation, a move
            part = self.json("replay", path, "--from", start)
            self.assertEqual((part["from"], part["identical"]), ("state", True), start)
            self.assertLess(part["ticks"], 6700 - 1000 * start + 1000)
            self.assertEqual(part["state_hash"], whole["state_hash"], start)
        piece = self.json("replay", path, "--from", "3s", "--to", "3500ms")
        self.assertEqual((piece["identical"], piece["end_tick"]), (True, 3500))
        self.assertIn("nothing happens", self.refused(2, "replay", path, "--from", 100)[0])
        self.assertIn("more than --from", self.refused(2, "replay", path, "--from", 3, "--to", 2)[0])

    def test_a_saved_state_is_not_trusted(self):
        path = self.record()
        self.expect(0, "record", "stop")
        data = bytearray(without_checksums(path.read_bytes()))
        at = 0
        while (at := data.find(b'"saved_state":"', at + 1)) >= 0:  # every one: another number near its end
            end = data.index(b'"', at + 15)
            if end - at > 2000:
                data[end - 1000] = ord("A") if data[end - 1000] != ord("A") else ord("B")
        (self.dir / "false.mcap").write_bytes(data)
        done = self.regrasp("--json", "replay", self.dir / "false.mcap", "--from", 3)
        self.assertEqual(done.returncode, 0)
        self.assertIn("executed from the start instead", done.stderr)
        found = json.loads(done.stdout)
        self.assertEqual((found["from"], found["identical"]), ("commands", True))
        whole = self.json("replay", self.dir / "false.mcap", code=1)
        self.assertFalse(whole["identical"])
        self.assertIsNotNone(whole["false_saved_state_tick"])
        self.assertIsNone(whole["first_difference"])

    def test_exports_of_a_stretch_and_at_another_rate(self):
        self.step(1000)
        self.expect(0, "grasp")
        self.step(1000)
        path = pathlib.Path(self.json("record", "start", "late.mcap")["path"])
        self.step(1000)
        self.expect(0, "record", "stop")

        def joints(name, *options):
            self.expect(0, "export", path, "--format", "csv", "-o", self.dir / name, *options)
            with open(self.dir / name / "joints.csv", encoding="utf-8") as file:
                return {int(row["tick"]): row for row in csv.DictReader(file)}
        recorded, part = joints("whole"), joints("part", "--from", 2.4, "--to", "2600ms")
        self.assertEqual(part, {tick: row for tick, row in recorded.items() if 2400 <= tick <= 2600})
        self.assertGreater(len(part), 1)
        again = joints("again", "--rate", "1kHz", "--from", 0.5)
        self.assertEqual(sorted(again), list(range(500, 3001)))  # also what was before the recording
        for tick, row in recorded.items():
            self.assertEqual(again[tick], row)
        self.expect(0, "export", path, "--format", "mcap", "-o", self.dir / "short.mcap", "--rate", 10, "--from", 1, "--to", 2)
        self.assertTrue(self.json("replay", self.dir / "short.mcap")["identical"])

    def test_every_segment_is_exported_at_another_rate(self):
        path = self.json("record", "start", "two.mcap")["path"]
        self.expect(0, "grasp")
        self.step(500)
        self.expect(0, "reset", "--seed", 2, "--object", "egg")
        self.step(300)
        self.expect(0, "grasp")
        self.step(400)
        self.expect(0, "noise", "preset", "coarse")  # at the last tick
        self.expect(0, "record", "stop")

        def exported(name, topic, *options):
            self.expect(0, "export", path, "--format", "csv", "-o", self.dir / name, *options)
            with open(self.dir / name / (topic + ".csv"), encoding="utf-8") as file:
                return list(csv.DictReader(file))
        places = [(row["segment"], int(row["tick"])) for row in exported("fine", "joints", "--rate", "1kHz")]
        self.assertEqual(places, [("0", tick) for tick in range(501)] + [("1", tick) for tick in range(701)])
        recorded, fine = exported("recorded", "commands"), exported("again", "commands", "--rate", "100")
        self.assertEqual(fine, recorded)
        self.assertEqual(len(fine), 3)
        # A stretch is of the last one, and tables say so.
        part = exported("part", "joints", "--rate", "100", "--from", 0.2, "--to", 0.3)
        self.assertEqual({row["segment"] for row in part}, {"1"})
        self.expect(0, "export", path, "--format", "mcap", "-o", self.dir / "fine.mcap", "--rate", 100)
        found = self.json("replay", self.dir / "fine.mcap")
        self.assertEqual((found["identical"], found["segments"], found["commands"], found["ticks"]), (True, 2, 3, 1200))
        self.expect(0, "export", path, "--format", "mcap", "-o", self.dir / "last.mcap", "--rate", 100, "--from", 0.1)
        self.assertTrue(self.json("replay", self.dir / "last.mcap")["identical"])

    def test_more_samples_than_ticks_are_refused(self):
        path = self.json("record", "start", "short.mcap")["path"]
        self.step(20)
        self.expect(0, "record", "stop")
        for rate in ("3000", "1.001kHz"):
            cause, hint = self.refused(2, "export", path, "--format", "csv", "-o", self.dir / "csv", "--rate", rate)
            self.assertRegex(cause, r"--rate [\d.]+ Hz: expected at most 1000 Hz")
            self.assertEqual(hint, "  try: regrasp help export")
        self.assertFalse((self.dir / "csv").exists())
        self.expect(0, "export", path, "--format", "csv", "-o", self.dir / "csv", "--rate", "1e-320")  # one sample
        self.assertRegex(" ".join(self.expect(0, "help", "export").stdout.split()), r"--rate HZ [^-]*at most each tick \(1000\)")

    def test_an_array_of_commands_holds_numbers_and_text(self):
        path = self.record()
        self.expect(0, "record", "stop")
        self.expect(0, "export", path, "--format", "npz", "-o", self.dir / "run.npz")
        arrays = read_npz(self.dir / "run.npz")
        methods = arrays["commands.method"][1]
        for field, method, value in (("duration_s", "push", 0.05), ("max_cycles", "explore", 800), ("speed_rad_s", "rotate", None)):
            shape, values = arrays["commands." + field]
            self.assertEqual(shape, (9,))
            for number, of in zip(values, methods, strict=True):
                self.assertIsInstance(number, float)
                self.assertEqual(math.isnan(number), of != method, (field, of))
                self.assertTrue(of != method or value in (None, number))
        shape, values = arrays["commands.force_W_n"]
        self.assertEqual(shape, (9, 3))
        self.assertEqual([number for number in values if not math.isnan(number)], [0.2, 0, 0])
        self.assertEqual(set(arrays["commands.finger"][1]), {"", "ring"})
        self.assertIn("", arrays["events.finger"][1])
        for name, (_, values) in arrays.items():
            self.assertNotIn("null", values, name)

    def test_a_file_that_was_removed_meanwhile_is_an_error(self):
        for change in (os.unlink, lambda path: os.rename(path, path + ".old"), lambda path: shutil.copy(path, path + ".new") and os.rename(path + ".new", path)):
            path = self.json("record", "start")["path"]
            self.step(100)
            change(path)
            cause, hint = self.refused(74, "record", "stop")
            self.assertIn(f"cannot write {path}: the file was removed, renamed or replaced meanwhile", cause)
            self.assertIn("record list", hint)
            self.assertNotIn("recording", self.expect(0, "status").stdout)

    def test_a_film_has_its_pictures(self):
        path = self.record()
        self.expect(0, "record", "stop")
        film = self.json("video", path, "-o", self.dir / "run.mp4", "--from", "4", "--to", "4.4", "--fps", "10")
        self.assertEqual((film["frames"], film["duration_s"], film["codec"]), (4, 0.4, "H.264"))
        self.assertGreater(film["made_in_s"], 0)
        data = (self.dir / "run.mp4").read_bytes()
        self.assertEqual(data[4:8], b"ftyp")
        self.assertIn(b"avc1", data)
        self.assertLess(data.index(b"moov"), data.index(b"mdat"), "a player must read the index first")
        gif = self.json("video", path, "-o", self.dir / "run.gif", "--from", "4", "--to", "4.4", "--fps", "10", "--scene-only")
        self.assertEqual((gif["frames"], gif["codec"]), (4, "GIF"))
        pictures = read_gif((self.dir / "run.gif").read_bytes())
        self.assertEqual([(w, h, len(p)) for w, h, p in pictures], [(640, 320, 640 * 320)] * 4)
        for _, _, pixels in pictures:
            self.assertGreater(len(set(pixels)), 200)  # colours: the shades are not bands
            self.assertEqual(set(pixels[:640]), {(255, 255, 255)})  # the edge stays paper white: nothing is scattered over it
        said = self.expect(0, "video", path, "-o", self.dir / "told.gif", "--from", "4", "--to", "4.4", "--fps", "10", "--scene-only").stdout
        self.assertRegex(said, r"told\.gif: 4 frames, 0\.4 s, GIF, made in [\d.]+ s \([\d.e+-]+ times real time\)\n$")
        self.assertIn(".mp4 or .gif", self.refused(2, "video", path, "-o", self.dir / "run.avi")[0])
        self.expect(0, "video", path, "-o", self.dir / "told.GIF", "--from", "4", "--to", "4.4", "--fps", "10", "--scene-only")
        self.expect(0, "video", path, "-o", self.dir / "told.MP4", "--from", "4", "--to", "4.4", "--fps", "10", "--scene-only")

    def test_an_interrupted_film_leaves_nothing(self):
        path = self.record()
        self.expect(0, "record", "stop")
        before = set(self.dir.iterdir())
        with subprocess.Popen([str(REGRASP), "video", str(path), "-o", str(self.dir / "run.mp4"), "--speed", "0.02"], env=environment(),
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True) as process:
            while not any(p.name.startswith(".draft") for p in self.dir.iterdir()):
                self.assertIsNone(process.poll())
            os.killpg(process.pid, signal.SIGINT)
            process.communicate(timeout=HANG_S)
        deadline = 1000
        while set(self.dir.iterdir()) != before and deadline:
            deadline -= 1
            time.sleep(0.02)
        self.assertEqual(set(self.dir.iterdir()), before)

    def test_a_stretch_beyond_the_end_is_refused(self):
        path = self.record()
        self.expect(0, "record", "stop")
        out = self.dir / "made"
        for words in (["replay", path], ["export", path, "--format", "csv", "-o", out], ["export", path, "--format", "mcap", "-o", out],
                      ["export", path, "--format", "npz", "--rate", "10", "-o", out], ["video", path, "-o", out.with_suffix(".mp4")]):
            with self.subTest(words):
                cause, hint = self.refused(2, *words, "--from", "100")
                self.assertRegex(cause, r"nothing happens from --from 100 s on: the run ends at [\d.]+ s")
                self.assertEqual(hint, f"  try: regrasp help {words[0]}")
        self.assertEqual([f.name for f in self.dir.iterdir() if f.name.startswith(("made", ".draft"))], [])

    def test_interrupted_alone_it_ends_its_program_and_says_so(self):
        path = self.record()
        self.expect(0, "record", "stop")
        before = set(self.dir.iterdir())
        for words in (["replay", path, "--speed", "0.01"], ["export", path, "--format", "csv", "--rate", "1000", "-o", self.dir / "csv"],
                      ["video", path, "-o", self.dir / "run.mp4", "--speed", "0.02"]):
            for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
                with self.subTest(words=words, number=number):
                    with subprocess.Popen(list(map(str, [REGRASP, *words])), env=environment(), stdout=subprocess.DEVNULL,
                                          stderr=subprocess.PIPE, text=True) as process:
                        while not (programs := children(process.pid)):
                            self.assertIsNone(process.poll())
                        ended = os.pidfd_open(programs[0])
                        self.addCleanup(os.close, ended)
                        process.send_signal(number)
                        self.assertEqual(select.select([ended], [], [], HANG_S)[0], [ended])
                        said = process.communicate(timeout=HANG_S)[1]
                    if number != signal.SIGKILL:
                        self.assertEqual((process.returncode, said.splitlines()[-1]), (130, "regrasp: interrupted"))
                        self.assertEqual(set(self.dir.iterdir()), before)
                    for left in self.dir.glob(".draft*"):  # of a kill that nothing can answer
                        shutil.rmtree(left) if left.is_dir() else left.unlink()

    def test_after_kill_9_everything_up_to_the_last_command_is_there(self):
        path = self.record()
        os.kill(pid_of(path), signal.SIGKILL)
        found = self.json("replay", path)
        self.assertFalse(found["complete"])
        self.assertTrue(found["identical"])
        self.assertEqual(found["commands"], 9)
        self.assertGreaterEqual(found["ticks"], 6200)  # the last command, at the least
        self.public_reader(path, complete=False, killed=True)
        said = self.expect(0, "export", path, "--format", "mcap", "-o", self.dir / "mended.mcap")
        self.assertIn("the file has no end", said.stdout)
        self.assertTrue(self.json("replay", self.dir / "mended.mcap")["complete"])
        self.public_reader(self.dir / "mended.mcap", complete=True, killed=True)

    def test_the_public_library_reads_a_finished_file(self):
        path = self.record()
        messages = self.json("record", "stop")["messages"]
        counts = self.public_reader(path, complete=True)
        self.assertEqual(sum(stream for stream, _ in counts.values()), messages)
        self.assertEqual(counts["commands"][0], 9)

    def public_reader(self, path, complete, killed=False):
        """Reads `path` with @mcap/core; every message by stream, and by index when the file is complete."""
        if not shutil.which("node"):
            self.skipTest("node is not installed: the public MCAP library cannot be asked")
        modules = pathlib.Path(os.environ["REGRASP_NODE_DIR"])
        if not (modules / "node_modules" / "@mcap" / "core").exists():
            modules.mkdir(parents=True, exist_ok=True)
            for name in ("package.json", "package-lock.json"):
                shutil.copy(SOURCE / "tests" / "end_to_end" / "mcap_reader" / name, modules)
            done = subprocess.run(["npm", "ci", "--no-audit", "--no-fund", "--ignore-scripts"], cwd=modules,
                                  capture_output=True, text=True, timeout=HANG_S, check=False)
            self.assertEqual(done.returncode, 0, "npm could not install @mcap/core: " + done.stdout + done.stderr)
        done = subprocess.run(["node", str(SOURCE / "tests" / "end_to_end" / "mcap_reader" / "read.js"), str(path)],
                              env=environment(NODE_PATH=str(modules / "node_modules")),
                              capture_output=True, text=True, timeout=HANG_S, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        counts = json.loads(done.stdout)
        for topic, (stream, index) in counts.items():
            self.assertEqual(index, stream if complete else 0, topic)
        # The last fifth of a second may be missing after a kill: the gait had just begun.
        for topic in ("run", "commands", "state", "events", "joints", "contacts", "forces", "object", "quality",
                      *([] if killed else ["gait"])):
            self.assertGreater(counts[topic][0], 0, topic)
        return counts


class WithoutARun(Case):
    def test_errors(self):
        self.assertIn("no daemon to ask", self.refused(6, "replay", "nothing.mcap")[0])
        text = self.dir / "text.mcap"
        text.write_text("not a run")
        self.assertIn("not an MCAP file", self.refused(74, "replay", text)[0])
        self.refused(2, "export", text, "--format", "xls")
        self.refused(2, "replay", text, "--speed", "0")


def pid_of(path):
    """The process that has `path` open."""
    for link in pathlib.Path("/proc").glob("[0-9]*/fd/*"):
        try:
            if os.readlink(link) == str(path):
                return int(link.parts[2])
        except OSError:
            continue
    raise AssertionError(f"nobody has {path} open")


def without_checksums(data):
    """The MCAP file with the checksum of every chunk set to 0, which means: not checked."""
    data = bytearray(data)
    at = 8
    while at + 9 <= len(data) - 8:
        opcode, length = data[at], struct.unpack_from("<Q", data, at + 1)[0]
        if opcode == 6:
            struct.pack_into("<I", data, at + 9 + 24, 0)
        at += 9 + length
    return bytes(data)


if __name__ == "__main__":
    unittest.main()
