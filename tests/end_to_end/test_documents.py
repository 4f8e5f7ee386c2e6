"""The documents do not lie: every command in the help, the manual pages and README is run here, and pages made by
programs are what the programs print."""

import ast
import json
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from harness import BIN, Case, DaemonCase, HANG_S, REGRASP, REGRASPD, SOURCE, environment

# Commands that are not run as they stand, and what is run instead (None: nothing, for the reason given).
INSTEAD = {
    "./demo": (None, "installs and builds; its last step, `regrasp demo`, is test_daemon"),
    "./check": (None, "is what runs this test"),
    "regrasp demo": (None, "minutes: test_daemon runs it with --repeats 1"),
    "regrasp demo -o figures": (None, "minutes: test_daemon runs it with --repeats 1"),
    "regrasp events -f": ("timeout 1 regrasp events -f || [ $? -eq 124 ]", "without end"),
    "regrasp rotate --continuous": ("regrasp rotate --continuous && regrasp stop", "without end"),
    "regrasp up": ("regrasp up --speed max", "in real time it would take as long as it says"),
    "regraspd": ("regraspd --check-config", "without end; test_service runs it"),
    "regraspd --speed max --seed 7": ("regraspd --speed max --seed 7 --check-config", "without end"),
    "systemctl enable --now regraspd.socket": (None, "needs systemd; daemon/package/try_in_fresh_root.sh"),
    "regrasp replay run-001.mcap": (None, "needs a run file: test_record"),
    "regrasp export run-001.mcap --format csv -o run-001": (None, "needs a run file: test_record"),
    "regrasp video run-001.mcap -o run-001.mp4": (None, "needs a run file: test_record"),
    "regrasp top": (None, "needs a terminal: test_top"),
    "regrasp shell": (None, "needs a terminal: test_shell"),
}
# Measurements: the same program, as short as it can be.
SHORTER = [(r"--seconds [\d.]+", "--seconds 1"), (r"--seeds \d+", "--seeds 1"), (r"--turns \d+", "--turns 0.1"), (r"(--seeds|-n) \d+", r"\1 1"),
           (r"experiment rotation (?!.*--turns)", "experiment rotation --turns 0.1 "), (r"bench_socket$", "bench_socket 20"), (r"bench_creep$", "bench_creep --seconds 1"), (r"bench_watchers.*", "bench_watchers 1"), (r"bench_quality$", "bench_quality --benchmark_min_time=0.01")]


def help_examples():
    """(command, example) for every example of `regrasp help`."""
    done = subprocess.run([REGRASP, "--json", "help"], capture_output=True, text=True, env=environment(), check=True)
    return [(command["words"], example["line"]) for command in json.loads(done.stdout)["commands"] for example in command["examples"]]


def fenced(text):
    """Commands in the fenced blocks of Markdown, those of other languages left out: lines after `$ `, or all lines where a block has none;
    comments and what follows `#` go."""
    commands = []
    for language, block in re.findall(r"^```(\w*)\n(.*?)^```", text, re.S | re.M):
        if language not in ("", "console", "sh"):
            continue
        lines = block.splitlines()
        prompted = [line[2:] for line in lines if line.startswith("$ ")]
        commands += [re.sub(r"\s+#\s.*", "", line).strip() for line in prompted or lines]
    return [command for command in commands if command]


class Documents(DaemonCase):
    def setUp(self):
        super().setUp()
        shutil.copy(SOURCE / "examples/grasp.json", self.dir)
        shutil.copy(SOURCE / "models/hands/shadow.urdf", self.dir / "my_hand.urdf")
        shutil.copy(SOURCE / "models/objects/sphere.urdf", self.dir / "my_object.urdf")
        (self.dir / "hand.toml").write_text("seed = 3\n")
        self.env = environment(PATH=f"{BIN}:/usr/bin:/bin", REGRASP_SOCKET=str(self.socket), HOME=str(self.dir), REGRASP_MODELS_DIR=str(SOURCE / "models"),
                               REGRASP_OUTPUT_DIR=str(self.dir / "out"))

    def run_line(self, line):
        line, _ = INSTEAD.get(line, (line, ""))
        if line is None:
            return
        if re.search(r"claims |bench_|^regrasp experiment ", line):
            line = line.replace("-o DIR", f"-o {tempfile.mkdtemp(dir=self.dir)}")
            for pattern, shorter in SHORTER:
                line = re.sub(pattern, shorter, line)
        done = subprocess.run(["bash", "-c", line], capture_output=True, text=True, env=self.env, cwd=self.dir, timeout=HANG_S, check=False)
        self.assertEqual(done.returncode, 0, f"{line}\n{done.stdout}{done.stderr}")

    def prepare(self, words):
        """What an example takes for granted: a daemon that holds the object (job 1), and for `job cancel` a second job."""
        # Options of an `up` before this one may differ: then another daemon takes its place.
        self.run_line("regrasp down || true" if words == "up" else "(regrasp up --speed max || (regrasp down && regrasp up --speed max)) && regrasp resume")
        if words == "step":
            self.run_line("regrasp reset --seed 1")
        if words in ("release", "rotate", "move", "explore", "grasp", "push", "job cancel"):
            self.run_line("regrasp reset --seed 1 && regrasp noise preset paper && regrasp param set object.friction 0.8 && regrasp param set gravity 0,0,-9.81")
            if words != "grasp":
                self.run_line("regrasp grasp --wait")
        if words == "job cancel":
            self.run_line("regrasp down && regrasp up --speed max && regrasp grasp --wait && regrasp rotate --continuous")

    def test_examples_of_the_help(self):
        self.run_line("regrasp grasp --wait")
        for words, line in help_examples():
            if words.startswith("experiment"):
                continue  # minutes: test_experiment
            with self.subTest(line):
                self.prepare(words)
                self.run_line(line)

    def test_examples_of_the_daemon(self):
        text = subprocess.run([REGRASPD, "--help"], capture_output=True, text=True, env=environment(), check=True).stdout
        lines = [re.split(r"\s{2,}", line.strip())[0] for line in text.splitlines() if line.startswith("  regraspd")]
        self.assertGreaterEqual(len(lines), 4)
        for line in lines:
            with self.subTest(line):
                self.run_line(line)

    def test_what_the_protocol_pages_show(self):
        (self.dir / "regrasp").symlink_to(self.socket.parent)  # where `regrasp up` would have put it
        env = {**self.env, "XDG_RUNTIME_DIR": str(self.dir)}
        for page in ("docs/protocol.md", "docs/man/regrasp-protocol.7.scd"):
            text = (SOURCE / page).read_text().replace(r"\\n", r"\n")  # scdoc's way to write a backslash
            (line,) = re.findall(r"^\$ (.*)$", text, re.M)
            with self.subTest(page, line=line):
                done = subprocess.run(["bash", "-c", line], capture_output=True, text=True, env=env, timeout=HANG_S, check=True)
                self.assertIn("state", json.loads(done.stdout)["result"])
            program = re.search(r"^import json.*?(?=^```)", text, re.S | re.M)[0]
            with self.subTest(page, program=program):
                self.run_line("regrasp reset")
                with subprocess.Popen([sys.executable, "-u", "-c", program], stdout=subprocess.PIPE, text=True, env=env) as client:
                    self.assertIn("job", ast.literal_eval(client.stdout.readline())["result"])
                    client.kill()  # it listens for ever

    def test_the_configuration_file_of_the_manual(self):
        text = (SOURCE / "docs/man/regraspd.8.scd").read_text()
        (file,) = [block for block in re.findall(r"^```\n(.*?)^```", text, re.S | re.M) if "[parameters]" in block]
        (self.dir / "manual.toml").write_text(file)
        self.run_line("regrasp config check manual.toml")

    def test_commands_of_the_readme_in_their_order(self):
        text = (SOURCE / "README.md").read_text()
        for line in fenced(text):
            with self.subTest(line):
                self.run_line(line)
        outside = re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)
        for line in re.findall(r"`((?:claims|bench_|regrasp )[^`]*)`", outside):
            with self.subTest(line):
                self.prepare("release")
                self.run_line(line)


class Pages(Case):
    def printed(self, *words):
        return subprocess.run([str(word) for word in words], capture_output=True, text=True, env=environment(), check=True).stdout

    def test_the_manual_pages_are_current(self):
        for page, words in [("regrasp.1", (REGRASP, "help", "--manual")), ("regraspd.8", (REGRASPD, "--print-manual")),
                            ("regrasp-protocol.7", (REGRASPD, "--print-protocol-manual"))]:
            with self.subTest(page):
                self.assertEqual((SOURCE / "docs/man" / f"{page}.scd").read_text(), self.printed(*words), 
                                 f"{' '.join(map(str, words))} > docs/man/{page}.scd")

    def test_the_manual_pages_render_without_warnings(self):
        for page in ("regrasp.1", "regraspd.8", "regrasp-protocol.7"):
            with self.subTest(page):
                source = (SOURCE / "docs/man" / f"{page}.scd").read_bytes()
                roff = subprocess.run(["scdoc"], input=source, capture_output=True, check=True).stdout
                (self.dir / page).write_bytes(roff)
                done = subprocess.run(["man", "--warnings", "-l", self.dir / page], capture_output=True, text=True, check=True,
                                      env=environment(MANWIDTH="80", HOME=str(self.dir)))
                self.assertEqual(done.stderr, "")
                self.assertIn("NAME", done.stdout)

    def test_every_command_has_an_example(self):
        with_examples = {words for words, _ in help_examples()}
        for command in json.loads(self.printed(REGRASP, "--json", "help"))["commands"]:
            self.assertIn(command["words"], with_examples, "cli/help/examples.cc")

    def test_links_in_the_readme_lead_somewhere(self):
        for target in re.findall(r"\]\(([^)#]+)\)", (SOURCE / "README.md").read_text()):
            if "://" not in target:
                self.assertTrue((SOURCE / target).exists(), target)


if __name__ == "__main__":
    unittest.main()
