"""What is written is whole under its name, takes nobody else's, and is nobody else's to write: also where the writer is
killed.

    REGRASP_KILLS=100 REGRASP_BIN_DIR=build/release/bin REGRASP_SOURCE_DIR=. python3 tests/end_to_end/test_outputs.py
kills that many; the suite a few.
"""

import json
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import time
import unittest

from harness import BIN, DaemonCase, HANG_S, REGRASP, environment
from system_case import SystemCase

KILLS = int(os.environ.get("REGRASP_KILLS", "2"))


class Outputs(SystemCase):
    def drop(self, wire):
        """The same life each time: grasp, and a push that no grasp bears. Its incident's file."""
        wire.result("reset", seed=1)
        wire.result("job.wait", id=wire.result("grasp")["job"])
        wire.result("push", force_n=[0, 0, 40], duration_s=0.3)
        wire.result("job.wait", id=wire.result("step", ticks=1500)["job"])
        return pathlib.Path(wire.result("status")["incident"]["record"])

    def test_incidents_of_the_same_tick_do_not_take_each_others_names(self):
        wire = self.start("--clock", "lockstep", "--speed", "max")
        first = self.drop(wire)
        before = first.read_bytes()
        second = self.drop(wire)
        self.assertEqual(second.name, first.name.replace(".json", "-2.json"))
        self.assertEqual(first.read_bytes(), before)
        wire.close()

    def test_nobody_else_may_write_to_what_is_written(self):
        wire = self.start("--clock", "lockstep", "--speed", "max", preexec=lambda: os.umask(0))
        wire.result("record.start", file="r.mcap")
        self.drop(wire)
        wire.result("record.stop")
        wire.result("checkpoint.save", name="c")
        wire.result("plot", name="scene", file="s.png")
        written = [self.out, *self.out.iterdir()]
        self.assertGreater(len(written), 4, written)
        for path in written:
            self.assertEqual(path.stat().st_mode & 0o022, 0, path)
        wire.close()
        for words in (["export", self.out / "r.mcap", "--format", "csv", "-o", self.dir / "csv"], ["export", self.out / "r.mcap", "--format", "npz", "-o", self.dir / "r.npz"],
                      ["param", "save", self.dir / "p.toml"]):
            done = subprocess.run([str(REGRASP), "-s", str(self.socket), *map(str, words)], env=environment(), capture_output=True, text=True, timeout=HANG_S,
                                  preexec_fn=lambda: os.umask(0), check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
        for path in [self.dir / "csv", self.dir / "csv" / "joints.csv", self.dir / "r.npz", self.dir / "p.toml"]:
            self.assertEqual(path.stat().st_mode & 0o022, 0, path)


class Kills(SystemCase):
    def test_the_daemon_while_it_writes_everything_at_once(self):
        r = random.Random(11)
        for number in range(KILLS):
            wire = self.start("--speed", "max")
            self.assertEqual([f for f in os.listdir(self.out) if f.startswith(".draft")] if self.out.exists() else [], [])
            wire.send("record.start", file=f"r{number}.mcap")
            wire.send("grasp")
            for i in range(20):
                wire.send("checkpoint.save", name=f"c{i}")
                wire.send("plot", name="scene", file=f"p{i}.png", overwrite=True)
            for _ in range(r.randrange(40)):
                wire.lines.readline()
            self.daemon.kill()
            self.daemon.wait()
            wire.close()
            for file in self.out.iterdir():
                if file.name.startswith(".draft"):
                    continue
                if file.suffix == ".png":
                    data = file.read_bytes()
                    self.assertEqual((data[:4], data[-8:-4]), (b"\x89PNG", b"IEND"), file)
                elif file.suffix == ".checkpoint":
                    for line in file.read_text(encoding="utf-8").splitlines():
                        json.loads(line)
            run = self.out / f"r{number}.mcap"
            if run.exists() and run.stat().st_size > 0:
                done = self.regrasp("--json", "replay", run)
                self.assertIn(done.returncode, (0, 74), done.stdout + done.stderr)  # 74: killed before the run was in it
                self.assertTrue(done.returncode == 74 or json.loads(done.stdout)["identical"])


class KilledTools(DaemonCase):
    ARGUMENTS = ["--speed", "max", "--seed", "1", "--paused"]

    def test_export_and_video_leave_all_or_nothing_under_the_name(self):
        self.json("record", "start", "run.mcap", "--rate", "100")
        self.expect(0, "grasp")
        self.expect(0, "step", 4000, "--wait")
        run = pathlib.Path(self.json("record", "stop")["path"])
        r = random.Random(5)
        made = self.dir / "made"
        for suffix, words in (("", ["export", "--format", "csv"]), (".npz", ["export", "--format", "npz"]),
                              (".mcap", ["export", "--format", "mcap"]), (".mp4", ["video", "--to", "1"])):
            target = made / f"x{suffix}"
            command = [str(BIN / ("regrasp-film" if words[0] == "video" else "regrasp-run")), words[0], str(run), *words[1:], "--output", str(target)]
            started = time.monotonic()
            self.assertEqual(subprocess.run(command, env=environment(), capture_output=True, check=False).returncode, 0)
            whole_s = time.monotonic() - started
            whole = self.size(target)
            for _ in range(KILLS):
                self.remove(target)
                tool = subprocess.Popen(command, env=environment(), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                time.sleep(r.uniform(0, 1.2 * whole_s))
                tool.kill()
                tool.wait()
                if target.exists():
                    self.assertEqual(self.size(target), whole, target)
            # What those left beside goes with the next one.
            self.remove(target)
            self.assertEqual(subprocess.run(command, env=environment(), capture_output=True, check=False).returncode, 0)
            self.assertEqual(sorted(f.name for f in made.iterdir()), [target.name])
            self.remove(target)

    def test_a_file_that_has_no_room_tells_so_and_leaves_nothing(self):
        self.json("record", "start", "run.mcap", "--rate", "100")
        self.expect(0, "grasp")
        self.expect(0, "step", 3000, "--wait")
        run = pathlib.Path(self.json("record", "stop")["path"])
        made = self.dir / "made"

        def small():  # as a disk that is full: 8 kB and no more
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (8192, 8192))
        for suffix, words in (("", ["export", "--format", "csv"]), (".npz", ["export", "--format", "npz"]), (".mcap", ["export", "--format", "mcap"]),
                              (".mp4", ["video", "--to", "1"]), (".gif", ["video", "--to", "0.2"])):
            command = [str(BIN / ("regrasp-film" if words[0] == "video" else "regrasp-run")), words[0], str(run), *words[1:],
                       "--output", str(made / f"x{suffix}")]
            done = subprocess.run(command, env=environment(), capture_output=True, text=True, preexec_fn=small, check=False)
            self.assertEqual(done.returncode, 74, done.stderr)
            self.assertIn("File too large", done.stderr, suffix)
            self.assertEqual(sorted(f.name for f in made.iterdir()), [], suffix)

    @staticmethod
    def size(path):
        return {f.name: f.stat().st_size for f in path.iterdir()} if path.is_dir() else path.stat().st_size

    @staticmethod
    def remove(path):
        shutil.rmtree(path) if path.is_dir() else path.unlink(missing_ok=True)


if __name__ == "__main__":
    unittest.main()
