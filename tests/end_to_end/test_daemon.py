"""The two real programs together. Every test has a daemon of its own."""

import json
import os
import pathlib
import signal
import stat
import subprocess
import unittest

from harness import Case, DaemonCase, HANG_S, REGRASP, SOURCE, Terminal, environment, wait_until_it_minds

PNG = b"\x89PNG\r\n\x1a\n"
FINGERS = ["first", "middle", "ring", "little", "thumb"]


class UpAndDown(Case):
    def test_a_life(self):
        up = self.json("up", "--speed", "max", "--models-dir", SOURCE / "models", "--output-dir", self.dir / "out")
        self.addCleanup(self.regrasp, "down")
        self.assertTrue(up["started"])
        self.assertEqual(up["socket"], str(self.socket))
        self.assertEqual(stat.S_IMODE(os.stat(self.socket).st_mode), 0o600)
        self.assertEqual(stat.S_IMODE(os.stat(self.socket.parent).st_mode), 0o700)
        again = self.json("up")
        self.assertFalse(again["started"])
        self.assertIn("already running", self.expect(0, "up").stdout)
        self.assertEqual(self.json("down")["stopped"], True)
        self.assertFalse(self.socket.exists())
        self.refused(3, "status")
        self.refused(3, "down")

    def test_a_daemon_that_cannot_start_says_why(self):
        for words, cause in [(["--noise", "papr"], "papr"), (["--object", "unicorn"], "unicorn"), (["--speed", "nan"], "nan")]:
            with self.subTest(words):
                done = self.regrasp("up", *words, "--models-dir", SOURCE / "models")
                self.assertNotIn(done.returncode, (0, 4), done.stderr)
                self.assertIn(cause, done.stderr)
                self.assertEqual(done.stdout, "")

    def test_what_cannot_be_a_socket_is_refused_before_anything_is_made(self):
        for path in (self.dir / "d" / ("n" * 120), self.dir / "file"):
            (self.dir / "file").touch()
            self.socket = path
            self.assertIn(str(path), self.regrasp("up").stderr)
            self.assertEqual([entry.name for entry in self.dir.iterdir()], ["file"])

    def test_it_keeps_nothing_that_its_caller_had_open(self):
        read, write = os.pipe()
        self.addCleanup(self.regrasp, "down")
        up = subprocess.run([str(REGRASP), "-s", str(self.socket), "up", "--models-dir", SOURCE / "models"], env=environment(), pass_fds=[write],
                            capture_output=True, text=True, timeout=HANG_S, check=False)
        self.assertEqual(up.returncode, 0, up.stderr)
        os.close(write)
        os.set_blocking(read, False)
        self.assertEqual(os.read(read, 1), b"")  # at its end: nobody can write any more
        os.close(read)

    def test_one_whose_socket_file_was_removed_is_named(self):
        pid = self.json("up", "--models-dir", SOURCE / "models")["pid"]
        self.socket.unlink()
        self.addCleanup(os.kill, pid, signal.SIGTERM)
        self.assertIn(f"process {pid} holds {self.socket}.lock", self.refused(4, "--timeout", "0.5", "up")[0])

    def test_a_stale_socket_is_taken_over(self):
        up = self.json("up", "--models-dir", SOURCE / "models")
        os.kill(up["pid"], 9)
        while True:  # the kernel closes the socket when it has reaped the process
            done = self.regrasp("status")
            if done.returncode == 3 and "stale" in done.stderr:
                break
        self.assertTrue(self.json("up", "--models-dir", SOURCE / "models")["started"])
        self.expect(0, "down")


class Session(DaemonCase):
    def test_grasp_inspect_release(self):
        self.assertEqual(self.json("status")["state"], "idle")
        record = self.json("grasp", "--wait")
        self.assertEqual((record["method"], record["state"]), ("grasp", "done"))
        status = self.json("status")
        self.assertEqual((status["state"], status["paused"], status["hand"], status["seed"]), ("holding", False, "shadow", 1))
        contacts = self.json("contacts")["fingers"]
        self.assertEqual(set(contacts), set(FINGERS))
        self.assertTrue(all(finger["in_contact"] and finger["role"] == "hold" for finger in contacts.values()))
        self.assertGreater(self.json("quality")["stability"], 0)
        self.assertEqual(len(self.json("joints")["joints"]), 22)
        truth = self.json("truth")
        self.assertAlmostEqual(truth["object"]["mass_kg"], 0.08, delta=1e-9)
        self.assertEqual({contact["finger"] for contact in truth["contacts"]}, set(FINGERS))
        self.assertEqual(self.json("release", "--wait")["state"], "done")
        self.assertEqual([job["method"] for job in self.json("job", "list")["jobs"]], ["grasp", "release"])
        self.assertEqual(self.refused(5, "grasp", "--wait")[1], "  try: regrasp reset")
        kinds = [event["kind"] for event in self.json("events")["events"]]
        self.assertIn("job_finished", kinds)

    def test_every_answer_is_readable_at_80_columns(self):
        self.expect(0, "grasp", "--wait")
        for words in (["status"], ["contacts"], ["joints"], ["quality"], ["truth"], ["job", "list"], ["job", "show", "1"], ["noise", "show"], ["param", "list"],
                      ["param", "get", "gravity"], ["param", "get", "object.friction"], ["events"], ["explore", "ring"], ["stop"]):
            with self.subTest(words):
                text = self.expect(0, *words).stdout
                self.assertTrue(text)
                for line in text.splitlines():
                    self.assertEqual(line, line.rstrip())
                    if str(self.socket) not in line:
                        self.assertLessEqual(len(line), 80, line)

    def test_csv_has_one_width(self):
        # A clock that goes on: every line of `watch` is another moment.
        self.expect(0, "down")
        self.expect(0, "up", "--speed", "max", "--clock", "continuous", "--models-dir", SOURCE / "models")
        self.expect(0, "grasp", "--wait")
        for words, rows in [(["contacts"], 5), (["joints"], 22), (["job", "list"], 1), (["status"], 1), (["watch", "quality", "--count", "3"], 3)]:
            with self.subTest(words):
                lines = self.expect(0, "--csv", *words).stdout.splitlines()
                self.assertEqual(len(lines), rows + 1)
                self.assertEqual(len(set(lines)), rows + 1 if rows > 1 else 2)

    def test_refusals(self):
        self.refused(5, "explore", "ring")
        self.refused(2, "explore", "tail")
        self.refused(6, "job", "show", "99")
        self.refused(2, "param", "set", "object.friction", "7")
        self.refused(6, "param", "get", "object.frictoin")
        self.refused(8, "call", "nonsense")
        self.assertIn("'../x' is not a name for a checkpoint", self.refused(2, "checkpoint", "save", "../x")[0])
        self.assertIn("file 'a/b.mcap' is not a plain file name: it holds a '/'", self.refused(2, "record", "start", "a/b.mcap")[0])
        self.refused(2, "call", "status", '{"x": 1}')
        # What to try is a command; what the daemon hints at is part of the cause.
        for words, part, next_command in [(["param", "set", "object.friction", "7"], "object.friction = 7 is out of range; allowed: 0.001 ... 1", "regrasp param list"),
                                          (["param", "set", "gait.mode", "zzz"], "gait.mode = 'zzz': expected exploring or returning", "regrasp param list"),
                                          (["param", "get", "object.frictoin"], "did you mean 'object.friction'?", "regrasp param list"),
                                          (["reset", "--object", "eg"], "did you mean 'egg'?", "regrasp help reset"),
                                          (["job", "show", "99"], "no job 99; call job.list for the last jobs", "regrasp job list"),
                                          (["call", "status", '{"x": 1}'], "status takes no parameters", "regrasp help call")]:
            with self.subTest(words):
                done = self.regrasp(*words)
                cause, hint = done.stderr.splitlines()
                self.assertTrue(cause.endswith(part), cause)
                self.assertEqual(hint, f"  try: {next_command}")
        self.assertEqual(self.json("status")["state"], "idle")

    def test_noise_and_parameters_take_effect(self):
        noise = self.json("noise", "set", "--position", "2", "--pose", "3,4")
        self.assertAlmostEqual(noise["position_m"], 0.002, delta=1e-12)
        self.assertAlmostEqual(noise["object_position_m"], 0.003, delta=1e-12)
        self.assertEqual(self.json("noise", "show"), noise)
        self.assertEqual(self.json("noise", "preset", "coarse")["preset"], "coarse")
        self.assertEqual(self.json("noise", "off")["position_m"], 0)
        taxels = self.json("noise", "set", "--taxel-pitch", "4", "--object-rate", "30", "--object-delay-frames", "2")
        self.assertEqual((taxels["taxel_pitch_m"], taxels["object_rate_hz"], taxels["object_delay_frames"], taxels["preset"]), (0.004, 30, 2, "custom"))
        self.assertIn("allowed are 0 to 7", self.refused(2, "noise", "set", "--object-delay-frames", "8")[0])
        self.assertIn("object_rate_hz is 0", self.refused(2, "noise", "set", "--object-rate", "0", "--object-delay-frames", "2")[0])
        self.assertNotIn("pose delay", self.expect(0, "noise", "set", "--object-rate", "0", "--taxel-pitch", "0.1").stdout)
        self.assertIn("0.10 mm", self.expect(0, "noise", "show").stdout)
        self.assertEqual(self.json("param", "set", "object.friction", "0.5")["value"], 0.5)
        self.assertEqual(self.json("param", "get", "object.friction")["value"], 0.5)
        self.assertEqual(self.json("param", "set", "gravity", "0,0,-1")["value"], [0, 0, -1])
        self.assertIn("object.friction", [p["name"] for p in self.json("param", "list")["parameters"]])

    def test_pictures_go_where_they_are_asked_for(self):
        self.expect(0, "grasp", "--wait")
        for name in ("quality", "contacts", "scene"):
            file = self.dir / f"{name}-copy.png"
            self.assertEqual(self.expect(0, "plot", name, "-o", file).stdout, f"{file}\n")
            self.assertTrue(file.read_bytes().startswith(PNG))
        path = self.expect(0, "plot", "quality").stdout.strip()
        self.assertEqual(path, str(self.dir / "out" / "quality-2.png"))  # the first one stays
        self.refused(74, "plot", "quality", "-o", self.dir / "absent" / "x.png")
        for run in ([], [self.dir / "no.mcap"]):
            cause, hint = self.refused(2, "plot", "quality", *run, "-o", self.dir / "x.gif")
            self.assertIn(f"{self.dir / 'x.gif'}: a picture ends in .png, .jpg, .jpeg, .pdf, .svg", cause)
            self.assertIn(f"-o {self.dir / 'x.png'}", hint)
        (self.dir / "pictures.d").mkdir()
        self.expect(0, "plot", "quality", "-o", self.dir / "pictures.d")
        self.assertEqual([file.suffix for file in (self.dir / "pictures.d").iterdir()], [".png"])
        # In the output directory itself it is there already; to standard output it goes as it is.
        self.expect(0, "plot", "quality", "-o", self.dir / "out" / "quality.png")
        done = subprocess.run([str(REGRASP), "-s", str(self.socket), "plot", "quality", "-o", "-"], env=environment(), capture_output=True, timeout=HANG_S, check=True)
        self.assertTrue(done.stdout.startswith(PNG))
        self.refused(2, "plot", "quality", "-o", "-", "--show")

    def test_streams_are_json_lines(self):
        lines = [json.loads(line) for line in self.expect(0, "--json", "watch", "status", "--rate", "50", "--count", "5").stdout.splitlines()]
        self.assertEqual([line["seq"] for line in lines], sorted({line["seq"] for line in lines}))
        self.assertEqual(len(lines), 5)

    def test_a_move_says_whether_it_got_there(self):
        self.refused(5, "move", "--by", "0,0,3")
        self.refused(2, "move")
        self.expect(0, "grasp", "--wait")
        for words, part in [(["--by", "0,0,60"], "--by 60: allowed are -50 to 50 mm"), (["--by", "40,40,0"], "--by is 56.57 mm long; allowed are at most 50"),
                            (["--turn", "150,150,0"], "--turn is 212.1 degrees long; allowed are at most 180"), (["--by", "0,0,0"], "leave nothing to move"), (["--turn", "1,2"], "--turn")]:
            with self.subTest(words):
                cause, _ = self.refused(2, "move", *words)
                self.assertIn(part, cause)
        record = self.json("move", "--by", "0,0,3", "--turn", "0,0,-10", "--wait")
        self.assertEqual((record["method"], record["state"], record["reached"], record["end"]), ("move", "done", True, "reached"))
        self.assertAlmostEqual(record["offset_m"][2], 0.003)
        # README's bound for one motion is 4 mm; a tenth of a millimetre or two is usual.
        self.assertAlmostEqual(record["achieved_offset_m"][2], 0.003, delta=0.002)
        text = self.expect(0, "job", "show", record["id"]).stdout
        self.assertIn("move done, reached", text)
        far = self.expect(1, "move", "--turn", "0,0,170", "--wait").stdout
        self.assertRegex(far, r"move ended")
        self.assertLessEqual(max(map(len, far.splitlines())), 80)
        record = self.json("job", "show", self.json("job", "list")["jobs"][-1]["id"])
        self.assertEqual((record["state"], record["reached"]), ("done", False))
        self.assertEqual(self.json("status")["state"], "holding")

    def test_pictures_of_a_run_in_which_nothing_happened_are_refused(self):
        for name in ("gait", "quality"):
            self.assertIn("no time has passed", self.refused(5, "plot", name)[0])

    def test_who_waits_for_a_job_that_dropped_the_object_is_told_why(self):
        self.expect(0, "param", "set", "object.friction", "0.05")
        for _ in range(50):  # the answer came before the record at times
            self.expect(0, "reset", "--seed", "1")
            record = self.json("grasp", "--wait", code=1)
            self.assertIsNotNone(record["incident"])
            self.assertEqual(record, self.json("job", "show", record["id"]))

    def test_a_lost_object_is_a_failure(self):
        self.expect(0, "grasp", "--wait")
        self.expect(0, "param", "set", "object.friction", "0.05")
        job = self.regrasp("explore", "ring", "--wait")
        self.assertIn(job.returncode, (1, 5), job.stdout + job.stderr)  # 5: it was lost before the job began

    def test_a_drop_explains_itself(self):
        self.refused(6, "plot", "incident")
        self.expect(0, "grasp", "--wait")
        self.assertNotIn("incident", self.expect(0, "status").stdout)
        self.expect(0, "pause")
        job = self.json("explore", "ring")["job"]
        self.expect(0, "param", "set", "object.friction", "0.05")
        self.expect(0, "step", "10000", "--wait")
        record = self.json("status")["incident"]["record"]
        (line,) = [line for line in self.expect(0, "status").stdout.splitlines() if line.startswith("incident")]
        self.assertIn(record, line)
        text = self.expect(0, "job", "show", job).stdout
        self.assertIn(record, text)
        self.assertIn("object.friction = 0.05", " ".join(text.split()))
        with open(record, encoding="utf-8") as file:
            self.assertEqual(json.load(file)["job"]["id"], job)
        (event,) = [event for event in self.json("events")["events"] if event["kind"] == "dropped"]
        self.assertTrue(record.endswith("/" + event["incident"]))
        file = self.dir / "why.png"
        self.expect(0, "plot", "incident", "-o", file)
        titled, untitled, as_before = (self.dir / name for name in ("titled.svg", "untitled.svg", "as-before.svg"))
        self.expect(0, "plot", "quality", "-o", titled)
        self.expect(0, "plot", "quality", "--no-title", "-o", untitled)
        self.expect(0, "plot", "quality", "--title=false", "-o", as_before)
        self.assertIn("Manipulability and grasp stability", titled.read_text())
        self.assertNotIn("Manipulability and grasp stability", untitled.read_text())
        self.assertEqual(as_before.read_text(), untitled.read_text())
        self.assertTrue(file.read_bytes().startswith(PNG))
        self.assertEqual(file.read_bytes(), pathlib.Path(record).with_suffix(".png").read_bytes())

    def test_full_disk(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run([str(REGRASP), "-s", str(self.socket), "status"], stdout=full, stderr=subprocess.PIPE, text=True, env=environment(),
                                  timeout=HANG_S, check=False)
        self.assertEqual(done.returncode, 74)


class Scripted(DaemonCase):
    """Paused, so that every command has its tick."""

    ARGUMENTS = ["--speed", "max", "--seed", "5", "--paused"]

    def test_pictures_that_cannot_be_are_refused_in_the_words_of_who_asked(self):
        run = self.dir / "out" / "run.mcap"

        def refused(code, *words):
            cause, hint = self.refused(code, "plot", *words, "-o", self.dir / "x.png")
            for file in (str(self.dir), ".draft"):  # no file is to blame
                self.assertNotIn(file, cause + hint.replace(str(run), "RUN"))
            return cause.removeprefix("regrasp: "), hint.removeprefix("  try: regrasp ").split("    (")[0].split()
        self.json("record", "start", "run.mcap")
        self.expect(0, "grasp")
        self.expect(0, "step", "200", "--wait")
        nothing = "nothing to draw: no finger held the object in these frames"
        self.assertEqual(refused(5, "contacts"), (nothing, ["grasp", "--wait"]))
        self.assertEqual(refused(5, "contacts", "--last", "0.1"), (nothing, ["plot", "contacts"]))
        self.json("record", "stop")
        for words in (["contacts", run], ["contacts", run, "--last", "0.1"]):
            self.assertEqual(refused(5, *words)[0], "run.mcap: " + nothing)
        self.assertEqual(refused(2, "quality", run, run), ("quality shows one run, 2 are given; only comparison shows several", ["plot", "quality", str(run)]))
        self.assertEqual(refused(2, "incident", run)[1], ["plot", "quality", str(run)])
        for words in (["quality"], ["quality", str(run), "--last", "0.1"]):
            cause, again = refused(2, *words, "--size", "88mm", "--dpi", "100")
            self.assertRegex(cause, r"^88 mm at 100 dpi are a picture of 346 x \d+ pixels; allowed are 400 x 300 to 8000 x 8000, so 1\d\d to 1200 dpi$")
            self.assertEqual(again[:len(words[:2]) + 1], ["plot", *words[:2]])
            self.expect(0, *again, *words[2:], "-o", self.dir / "allowed.png")  # the dpi it names
        self.assertRegex(refused(2, "quality", "--size", "300", "--dpi", "1200")[0], r"so 50 to 67\d dpi$")

    def test_what_says_how_a_picture_is_printed_needs_a_printed_width(self):
        run = str(self.json("record", "start", "run.mcap")["path"])
        self.expect(0, "grasp")
        self.expect(0, "step", "200", "--wait")
        self.json("record", "stop")
        for printed in (["--dpi", "50"], ["--dpi", "300"], ["--dpi", "1200"], ["--font-size", "9"]):
            for words in (["quality"], ["quality", run], ["comparison", "a.mcap", "b.mcap"]):
                cause, hint = self.refused(2, "plot", *words, *printed, "-o", self.dir / "x.png")
                self.assertEqual(cause, f"regrasp: {' '.join(printed)} says how a picture is printed, and --size is missing")
                again = hint.removeprefix("  try: regrasp ").split()
                self.assertEqual(again[:1 + len(words)] + again[-2:], ["plot", *words, *printed])
                if words == ["quality"]:
                    self.expect(0, *again, "-o", self.dir / "x.png")
        for name, value in (("dpi", 300), ("font_size_pt", 9)):
            asked = self.expect(2, "call", "plot", json.dumps({"name": "quality", name: value}))
            self.assertIn(f"{name} says how a picture is printed, and size_m is missing", asked.stderr)

    def test_of_a_run_without_a_job_the_hint_names_a_picture_that_it_has(self):
        run = self.json("record", "start", "idle.mcap")["path"]
        self.expect(0, "step", "200", "--wait")
        self.json("record", "stop")
        for name, other in (("quality", "quality"), ("gait", "gait"), ("scene", "scene"), ("contacts", "quality"), ("shape", "quality")):
            cause, hint = self.refused(5, "plot", name, run, "-o", self.dir / "x.png")
            self.assertEqual(cause, "regrasp: idle.mcap: no job in the last segment")
            self.assertEqual(hint, f"  try: regrasp plot {other} {run} --last 10    (the last 10 s)")
            self.expect(0, *hint.split("    (")[0].split()[2:], "-o", self.dir / "x.png")

    def hash_after(self, ticks):
        self.expect(0, "reset", "--seed", "5")
        self.expect(0, "grasp")
        self.assertEqual(self.json("step", ticks, "--wait")["state"], "done")
        status = self.json("status")
        return status["tick"], status["state_hash"]

    def test_same_commands_same_bits(self):
        first = self.hash_after(3000)
        self.assertEqual(first[0], 3000)
        self.assertEqual(self.hash_after(3000), first)

    def test_interrupting_a_wait_leaves_the_job(self):
        self.expect(0, "grasp")
        process = subprocess.Popen([str(REGRASP), "-s", str(self.socket), "job", "wait", "1"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env=environment())
        wait_until_it_minds(process, signal.SIGINT)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=HANG_S)
        self.assertEqual((process.returncode, out), (130, ""))
        self.assertIn("job 1 goes on", err)
        self.assertIn(self.json("job", "show", "1")["state"], ("queued", "running"))

    def test_progress_on_a_terminal(self):
        self.expect(0, "grasp")
        terminal = Terminal([REGRASP, "-s", self.socket, "job", "wait", "1"], environment(TERM="xterm"))
        terminal.read_until("grasp")  # a progress line, while the clock stands still
        self.expect(0, "resume")
        self.assertEqual(terminal.finish(), 0)
        self.assertIn("done", terminal.text.split("\r\x1b[K")[-1])


class Demo(Case):
    def test_the_demo_shows_the_claims(self):
        done = self.regrasp("--json", "demo", "-o", self.dir / "demo", "--repeats", "1", "--models-dir", SOURCE / "models")
        answer = json.loads(done.stdout)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertTrue(answer["ok"])
        self.assertGreaterEqual(len(answer["claims"]), 10)
        start = answer["measured"]["figure2"]["start_hash"]
        self.assertEqual(start[0], start[1])
        for picture in answer["measured"]["pictures"]:
            with open(picture, "rb") as file:
                self.assertEqual(file.read(8), PNG)
        names = {os.path.basename(picture) for picture in answer["measured"]["pictures"]}
        self.assertLessEqual({"figure1.png", "figure2.png", "figure3a.png", "figure3b.png"}, names)
        # The demo's own figures, seed 1: every claim of the table is met.
        self.assertEqual([claim for claim in answer["claims"] if claim["verdict"] != "shown"], [])


if __name__ == "__main__":
    unittest.main()
