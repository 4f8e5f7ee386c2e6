"""The programs in examples/, each run as its first lines say."""

import json
import subprocess
import sys
import unittest

from harness import DaemonCase, HANG_S, SOURCE, environment

EXAMPLES = SOURCE / "examples"


class Examples(DaemonCase):
    def run_example(self, *words, **env):
        done = subprocess.run([str(word) for word in words], capture_output=True, text=True, env=environment(**env), cwd=self.dir, timeout=HANG_S, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""), done.stdout)
        return done.stdout

    def test_each_finds_the_socket(self):
        watch = self.dir / "watch"
        subprocess.run(["g++", "-std=c++20", EXAMPLES / "watch.cc", "-o", watch], check=True, timeout=HANG_S)
        (self.dir / "regrasp").symlink_to(self.socket.parent)  # where `regrasp up` would have put it
        for env in ({"REGRASP_SOCKET": str(self.socket)}, {"XDG_RUNTIME_DIR": str(self.dir)}):
            with self.subTest(*env):
                self.run_example("sh", EXAMPLES / "grasp_and_turn.sh", **env)
                self.run_example(sys.executable, EXAMPLES / "explore.py", **env)
                self.run_example(watch, **env)
                self.expect(0, "reset", "--seed", "1")

    def test_shell(self):
        grasped, turned, truth = map(json.loads, self.run_example("sh", EXAMPLES / "grasp_and_turn.sh", self.socket).splitlines())
        self.assertEqual((grasped["result"]["method"], grasped["result"]["state"]), ("grasp", "done"))
        self.assertEqual(turned["result"]["method"], "rotate")
        # The true angle: the gait ends within a few degrees of what was asked for, here 90.
        self.assertGreater(turned["result"]["angle_rad"], 1.4)
        self.assertEqual(len(truth["result"]["object"]["p_WO_m"]), 3)

    def test_python(self):
        lines = self.run_example(sys.executable, EXAMPLES / "explore.py", self.socket).splitlines()
        self.assertEqual([line.split()[0] for line in lines], list(self.json("quality")["fingers"]))
        explored = [job for job in self.json("job", "list")["jobs"] if job["method"] == "explore"]
        self.assertGreaterEqual(len(explored), 4)  # the thumb may be refused: the rest holds too little without it
        self.assertEqual(sum("phi" in line for line in lines), sum(job["state"] == "done" for job in explored))

    def test_python_reads_the_configuration_file(self):
        file = self.dir / "regraspd.toml"
        file.write_text(f'socket = "{self.socket}"\n')
        self.assertIn("ring", self.run_example(sys.executable, EXAMPLES / "explore.py", REGRASP_CONFIG=str(file)))

    def test_cplusplus(self):
        watch = self.dir / "watch"
        subprocess.run(["g++", "-std=c++20", "-Wall", "-Wextra", "-Werror", EXAMPLES / "watch.cc", "-o", watch], check=True, timeout=HANG_S)
        self.expect(0, "grasp", "--wait")
        lines = self.run_example(watch, self.socket, 5).splitlines()
        self.assertEqual(len(lines), 5)
        for line in lines:
            words = line.split()
            self.assertEqual(words[1::2][0], "s")
            self.assertEqual(words.count("N"), 5)
        times = [float(line.split()[0]) for line in lines]
        self.assertEqual(times, sorted(times))


if __name__ == "__main__":
    unittest.main()
