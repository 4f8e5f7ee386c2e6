"""Run files and checkpoints that are damaged or made by an enemy: an error or what is left, never a crash, and
nothing outside the place that was named."""

import copy
import json
import os
import pathlib
import shutil
import struct
import subprocess
import unittest

from harness import Case, DaemonCase, HANG_S, REGRASP, REGRASPD, SOURCE, environment

MAGIC = b"\x89MCAP0\r\n"


def text(value):
    return struct.pack("<I", len(value)) + value


def record(opcode, content):
    return struct.pack("<BQ", opcode, len(content)) + content


def channel(number, topic):
    return (record(3, struct.pack("<H", number) + text(b"x") + text(b"jsonschema") + text(b"{}")) +
            record(4, struct.pack("<HH", number, number) + text(topic) + text(b"json") + text(b"")))


def message(number, data):
    return record(5, struct.pack("<HIQQ", number, 0, 0, 0) + data)


class BadFiles(DaemonCase):
    ARGUMENTS = ["--speed", "max", "--seed", "1", "--paused"]

    def setUp(self):
        super().setUp()
        self.json("record", "start", "good.mcap")
        self.expect(0, "grasp")
        self.expect(0, "step", 2800, "--wait")
        self.good = pathlib.Path(self.json("record", "stop")["path"])
        self.json("checkpoint", "save", "good")

    def left(self, code, *words):
        """Runs a command that makes a file; checks that the file is there exactly when that is said."""
        done = self.regrasp(*words, "-o", self.dir / "made")
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertEqual((self.dir / "made").exists(), code != 74, done.stdout + done.stderr)
        self.assertEqual([f for f in os.listdir(self.dir) if f.startswith(".draft")], [])
        if (self.dir / "made").is_dir():
            shutil.rmtree(self.dir / "made")
        (self.dir / "made").unlink(missing_ok=True)
        return done.stdout + done.stderr

    def file(self, data):
        path = self.dir / "bad.mcap"
        path.write_bytes(data)
        return path

    def test_a_turned_bit_costs_a_chunk_and_is_named(self):
        data = bytearray(self.good.read_bytes())
        at = len(data) // 2
        data[at] ^= 16
        path = self.file(data)
        for form in ("mcap", "csv", "npz"):
            said = self.left(1, "export", path, "--format", form)
            self.assertIn("lost: ", said)
        lost = json.loads(self.regrasp("--json", "export", path, "--format", "npz", "-o", self.dir / "x.npz").stdout)["lost"]
        self.assertEqual(len(lost), 1)
        self.assertLessEqual(lost[0]["offset"], at)
        self.assertGreater(lost[0]["offset"] + lost[0]["bytes"], at)
        replayed = self.json("replay", path, code=1)
        self.assertTrue(replayed["identical"])
        self.assertEqual(replayed["lost"], lost)

    def test_lost_samples_are_named_by_all_that_execute_the_stretch(self):
        data = bytearray(self.good.read_bytes())
        chunks, place = [], 8
        while data[place] != 15:  # the end of the data
            if data[place] == 6:
                chunks.append((place, *struct.unpack_from("<QQ", data, place + 9)))
            place += 9 + struct.unpack_from("<Q", data, place + 1)[0]
        place, start, end = next(chunk for chunk in chunks if chunk[1] > 1e9 and chunk[2] - chunk[1] > 5e7 and b"method" not in data[chunk[0]:chunk[0] + 9 + struct.unpack_from("<Q", data, chunk[0] + 1)[0]])
        data[place + 8 + struct.unpack_from("<Q", data, place + 1)[0]] ^= 16
        path = self.file(data)
        within = ["--from", f"{start * 1e-9 + 0.01}", "--to", f"{end * 1e-9}"]
        before = ["--from", "0.1", "--to", f"{start * 1e-9 - 0.1}"]
        cases = {"replay": ["replay", path], "film": ["video", path, "--fps", "5", "-o", self.dir / "made.gif"],
                 "export": ["export", path, "--format", "csv", "--rate", "50", "-o", self.dir / "made"]}
        for name, words in cases.items():
            for stretch, code in ((within, 1), (before, 0), ([], 1)):
                with self.subTest(name, stretch=stretch):
                    lost = self.json(*words, *stretch, code=code)["lost"]
                    self.assertEqual([loss["offset"] for loss in lost], [place] if code else [])
                    self.remove_made()
        # Chunks of the journal are read wherever they lie: what is lost of them counts within the stretch alone.
        late = bytearray(self.good.read_bytes())
        for at, begin, _ in chunks:
            if begin > 1e9:
                late[at + 8 + struct.unpack_from("<Q", late, at + 1)[0]] ^= 16
        spoilt = self.dir / "late.mcap"
        spoilt.write_bytes(late)
        for kind in ("csv", "npz", "mcap"):
            stretch = ["export", spoilt, "--format", kind, "-o", self.dir / f"made.{kind}", "--from", 0, "--to", 0.5]
            self.assertEqual(self.json(*stretch)["lost"], [], kind)
        plot = self.regrasp("plot", "quality", path, "-o", self.dir / "made.png")
        self.assertEqual((plot.returncode, plot.stdout), (1, f"{self.dir / 'made.png'}\n"))
        self.assertIn(f"note: bad.mcap lost {9 + struct.unpack_from('<Q', data, place + 1)[0]} bytes at {place} (", plot.stderr)
        self.assertEqual(len(self.json("plot", "quality", path, "-o", self.dir / "made.png", code=1)["lost"]), 1)

        # What is lost after the job that is shown is none of the picture's.
        data, (place, start, _) = bytearray(self.good.read_bytes()), chunks[-1]
        self.assertGreater(start * 1e-9, self.json("job", "show", "1")["ended_s"])
        data[place + 8 + struct.unpack_from("<Q", data, place + 1)[0]] ^= 16
        late = self.file(data)
        self.assertEqual(len(self.json("replay", late, code=1)["lost"]), 1)
        self.assertEqual(self.json("plot", "contacts", late, "-o", self.dir / "made.png")["lost"], [])

        path = self.file(self.good.read_bytes()[: len(data) // 2])
        for words in (["replay", path], ["plot", "quality", path, "-o", self.dir / "made.png"], cases["film"]):
            self.remove_made()
            said = self.regrasp(*words)
            self.assertEqual(said.returncode, 0, said.stderr)
            self.assertIn("has no end: ", said.stdout + said.stderr)

    def remove_made(self):
        for file in self.dir.glob("made*"):
            shutil.rmtree(file) if file.is_dir() else file.unlink()  # pylint: disable=expression-not-assigned

    def test_a_damaged_beginning_leaves_the_rest(self):
        data = bytearray(self.good.read_bytes())
        place = 8
        while data[place] != 6:  # the first chunk
            place += 9 + struct.unpack_from("<Q", data, place + 1)[0]
        data[place + 8 + struct.unpack_from("<Q", data, place + 1)[0]] ^= 16
        path = self.file(data)
        for form in ("mcap", "csv", "npz"):
            said = self.left(1, "export", path, "--format", form)
            self.assertIn(f"lost: {9 + struct.unpack_from('<Q', data, place + 1)[0]} bytes at {place}", said)
            self.assertNotIn(": 0 messages", said)
        self.assertIn("lost: ", self.left(74, "export", self.file(data[: place + 9 + struct.unpack_from("<Q", data, place + 1)[0]]), "--format", "csv"))

    def test_what_holds_no_run_is_an_error_and_leaves_nothing(self):
        data = self.good.read_bytes()
        for bad in (b"", b"hello", data[:2000], MAGIC, MAGIC + channel(1, b"state") + message(1, b"{}"), bytes(5000)):
            path = self.file(bad)
            for form in ("mcap", "csv", "npz"):
                self.left(74, "export", path, "--format", form)
            self.expect(74, "replay", path)

    def test_names_that_lead_elsewhere_are_refused(self):
        outside = self.dir / "pwned"
        for topic in (b"../../pwned", str(outside).encode(), b"-x", b".x", b"a\x1bb", b"\xe2\x80\xae", b""):
            path = self.file(MAGIC + channel(1, topic) + channel(2, b"run") + message(2, b'{"model":{"hand":{"joints":[],"fingers":[]}}}') +
                             message(1, b'{"a":1}'))
            for form in ("mcap", "csv", "npz"):
                said = self.left(74, "export", path, "--format", form)
                self.assertNotIn("\x1b", said)
        self.assertFalse(list(self.dir.rglob("pwned*")))

    def test_a_configuration_that_is_none_ends_no_program(self):
        lines = (self.good.parent / "good.checkpoint").read_text(encoding="utf-8").split("\n")
        config = json.loads(lines[1])

        def spoilt(change):
            broken = copy.deepcopy(config)
            change(broken["model"], broken)
            return broken

        changes = [lambda m, c: m["hand"]["links"][3].update(parent_joint=1000), lambda m, c: m["hand"]["joints"][3].update(child_link=99999),
                   lambda m, c: m["hand"]["fingers"][0].update(tip_link=-7), lambda m, c: m["hand"].update(fingers=m["hand"]["fingers"] * 4),
                   lambda m, c: m["hand"].update(links=[]), lambda m, c: c["world"].update(dt_s=1e-300),
                   lambda m, c: m["object"].update(kind=3, vertices_O=[[0, 0, 0], [1, 0, 0], [0, 1, 0]], triangles=[[0, 1, 10**9]])]
        for i, change in enumerate(changes):
            broken = spoilt(change)
            state = {"segment": 0, "tick": 5, "commands": 0, "state_hash": "0" * 16}
            path = self.file(MAGIC + channel(1, b"run") + channel(2, b"commands") + channel(3, b"state") + message(1, json.dumps(broken).encode()) +
                             message(3, json.dumps(state).encode()))
            self.refused(74, "replay", path)
            name = f"bad{i}"
            (self.good.parent / f"{name}.checkpoint").write_text("\n".join([lines[0], json.dumps(broken), *lines[2:]]), encoding="utf-8")
            self.refused(74, "checkpoint", "restore", name)
        head = json.loads(lines[0])
        head["commands"] = 10**9
        (self.good.parent / "many.checkpoint").write_text(json.dumps(head) + "\n" + "\n".join(lines[1:]), encoding="utf-8")
        os.mkfifo(self.good.parent / "pipe.checkpoint")
        os.mkfifo(self.good.parent / "pipe.mcap")
        os.symlink("/dev/zero", self.good.parent / "zero.checkpoint")
        os.symlink("/dev/zero", self.good.parent / "zero.mcap")
        self.expect(74, "checkpoint", "restore", "many")
        shutil.copy(self.good.parent / "good.checkpoint", self.good.parent / "copy.checkpoint")
        names = [c["name"] for c in self.json("checkpoint", "list")["checkpoints"]]
        self.assertLessEqual({"good", "copy"}, set(names))
        self.assertEqual(len(names), len(set(names)))  # by the files' names, whatever they call themselves
        self.assertEqual([r["file"] for r in self.json("record", "list")["recordings"]], ["good.mcap"])
        for name in ("pipe", "zero"):
            self.expect(74, "checkpoint", "restore", name)
        self.expect(0, "status")


class BadModels(Case):
    """A file of settings or a model that would end what reads it."""

    def refused(self, code, word, *words, program=REGRASP):
        done = subprocess.run([program, *words], env=environment(), capture_output=True, timeout=HANG_S, check=False)
        self.assertEqual(done.returncode, code, done.stderr[-500:])
        self.assertIn(word, done.stderr)
        self.assertNotIn(b"\x1b", done.stderr)

    def test_a_key_of_many_parts(self):
        file = self.dir / "deep.toml"
        file.write_text("a." * 300_000 + "b = 1")
        self.refused(2, b"nested deeper than 32", "--config", file, "--check-config", program=REGRASPD)
        self.refused(2, b"nested deeper than 32", "param", "load", file)
        shutil.copy(SOURCE / "models/objects/sphere.urdf", self.dir / "deep.urdf")
        self.refused(1, b"nested deeper than 32", "object", "show", self.dir / "deep.urdf")

    def test_a_mistake_in_a_configuration_is_told(self):
        # Each of these ended the command line by a signal, as the reader of TOML throws.
        for line in ("seed = 0,5", 'seed = "5', '"gait.mode" = returning"', "{", '[parameters]\nobject.friction = 0,5'):
            file = self.dir / "c.toml"
            file.write_text(line + "\n")
            self.refused(2, b"c.toml:", "param", "load", file)
            done = subprocess.run([REGRASP, "status"], env=environment(REGRASP_CONFIG=str(file)), capture_output=True, timeout=HANG_S, check=False)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(b"c.toml:", done.stderr)

    def test_names_that_are_none(self):
        hand = (SOURCE / "models/hands/allegro.urdf").read_bytes()
        for name, cause in ((b"p\xe9lm", b"is not UTF-8"), (b"p&#27;[2Jlm", b"holds a control character")):
            file = self.dir / "hand.urdf"
            file.write_bytes(hand.replace(b'"palm"', b'"' + name + b'"'))
            self.refused(1, cause, "hand", "check", file)
            self.refused(1, cause, "--json", "hand", "check", file)
            self.refused(1, cause, "object", "show", file)

    def test_a_run_that_is_no_text(self):
        run = self.dir / "run.mcap"
        run.write_bytes(MAGIC + channel(1, b"run") + message(1, b'{"a": \xe9\x1b[31m'))
        for words in (["replay", run], ["export", run, "--format", "csv", "-o", self.dir / "out"], ["video", run, "-o", self.dir / "v.mp4"]):
            for json_flag in ([], ["--json"]):
                self.refused(74, b"not JSON", *json_flag, *words)


if __name__ == "__main__":
    unittest.main()
