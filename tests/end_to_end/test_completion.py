"""Completion: what `regrasp __complete` offers, and the scripts in the shells they are for."""

import subprocess
import time
import unittest

from harness import Case, DaemonCase, FakeDaemon, HANG_S, REGRASP, environment


def bash(words):
    """What bash offers for the last of `words`."""
    quoted = " ".join(f"'{word}'" for word in words)
    return (f'eval "$(regrasp completion bash)"; COMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}; _regrasp; '
            'printf "%s\\n" "${COMPREPLY[@]}"')


def zsh(words):
    """The same; `_describe` and `_files` of zsh's completion system need an editor, so they are replaced by ones that print."""
    quoted = " ".join(f"'{word}'" for word in words)
    return ('compdef() { : }; _files() { print -l :files "$@" }; compadd() { print -l -- $1 ${(P)2} }; '
            "_describe() { local name=$3; print -l -- ${${(P)name}%%:*} }; "
            f'eval "$(regrasp completion zsh)"; words=({quoted}); CURRENT={len(words)}; _regrasp')


def fish(words):
    return "regrasp completion fish | source; complete -C '" + " ".join(words) + "'"


SHELLS = {"bash": bash, "zsh": zsh, "fish": fish}


class Shells(Case):
    def ask(self, shell, *words):
        env = environment(PATH=f"{REGRASP.parent}:/usr/bin:/bin", REGRASP_SOCKET=str(self.socket), HOME=str(self.dir), ZDOTDIR=str(self.dir))
        done = subprocess.run([shell, "-c", SHELLS[shell](["regrasp", *words])], capture_output=True, text=True, env=env, timeout=HANG_S, cwd=self.dir, check=False)
        self.assertEqual(done.stderr, "", shell)
        return [line.split("\t")[0] for line in done.stdout.splitlines() if line]

    def test_the_three_shells_offer_the_same(self):
        (self.dir / "grasp.json").write_text("{}")
        for words, wanted in [(["noise", "preset", "t"], ["taxel"]), (["expl"], ["explore"]), (["noise", "s"], ["set", "show"]),
                              (["explore", "ring", "--cr"], ["--criterion"]), (["explore", "ring", "--criterion", "s"], ["stability", "switched"]),
                              (["--color", "al"], ["always"]), (["help", "job", "w"], ["wait"])]:
            for shell in SHELLS:
                with self.subTest(shell=shell, words=words):
                    self.assertEqual(sorted(self.ask(shell, *words)), wanted)
        for shell in SHELLS:
            with self.subTest(shell):
                self.assertIn(":files" if shell == "zsh" else "grasp.json", self.ask(shell, "evaluate", "gra"))

    def test_runs_are_run_files_and_directories(self):
        for name in ("a.mcap", "-b.mcap", "notes.txt"):
            (self.dir / name).write_text("")
        (self.dir / "folder").mkdir()
        wanted = {"bash": ["./-b.mcap", "a.mcap", "folder"], "zsh": ["-a", "./-b.mcap", ":files", "-g", "*.mcap"],
                  "fish": ["a.mcap", "folder/"]}  # which hides what begins with a point until it is typed
        for shell in SHELLS:
            with self.subTest(shell):
                self.assertEqual(sorted(self.ask(shell, "replay", "")), sorted(wanted[shell]))


class Names(DaemonCase):
    def offered(self, *words, **env):
        done = subprocess.run([REGRASP, "__complete", *words], env=environment(**env), capture_output=True, text=True, timeout=HANG_S, check=True)
        return [line.split("\t")[0] for line in done.stdout.splitlines()]

    def test_the_daemon_knows_fingers_objects_and_parameters(self):
        # A daemon that a loaded machine keeps from answering in 150 ms is not waited for: like a user, Tab again.
        deadline = time.monotonic() + HANG_S
        for words, wanted in [(["explore", "t"], "thumb"), (["reset", "--object", "eg"], "egg"), (["param", "set", "object.f"], "object.friction"),
                              (["--socket", str(self.socket), "explore", "t"], "thumb"), ([f"--socket={self.socket}", "explore", "t"], "thumb"),
                              (["--socket", "=", str(self.socket), "explore", "t"], "thumb")]:
            with self.subTest(words):
                env = {} if words[0].startswith("--socket") else {"REGRASP_SOCKET": str(self.socket)}
                while not (offered := self.offered(*words, **env)):
                    self.assertLess(time.monotonic(), deadline)
                self.assertEqual(offered, [wanted])


    def test_the_daemon_knows_the_words_of_a_parameter(self):
        deadline = time.monotonic() + HANG_S
        for words, wanted in [(["param", "set", "gait.preset", ""], ["paper", "planned"]), (["param", "set", "gait.preset", "pl"], ["planned"]),
                              (["param", "set", "gait.plan", ""], ["false", "true"]), (["param", "set", "object.friction", ""], [])]:
            with self.subTest(words):
                while (offered := sorted(self.offered(*words, REGRASP_SOCKET=str(self.socket)))) != wanted:
                    self.assertLess(time.monotonic(), deadline, offered)

    def test_the_daemon_knows_checkpoints_jobs_and_run_files(self):
        self.expect(0, "record", "start", "turn.mcap")
        self.expect(0, "grasp", "--wait")
        self.expect(0, "checkpoint", "save", "held")
        self.expect(0, "record", "stop")
        deadline = time.monotonic() + HANG_S
        for words, wanted in [(["checkpoint", "restore", ""], "held"), (["job", "wait", ""], "1"), (["job", "show", ""], "1"),
                              (["replay", "t"], "turn.mcap"), (["export", ""], "turn.mcap"), (["video", ""], "turn.mcap"),
                              (["plot", "quality", ""], "turn.mcap"), (["plot", "quality", "--no"], "--no-title"),
                              (["experiment", "exploration", "--finger", "ri"], "ring")]:
            with self.subTest(words):
                while wanted not in (offered := self.offered(*words, REGRASP_SOCKET=str(self.socket))):
                    self.assertLess(time.monotonic(), deadline, offered)


class Patience(Case):
    def test_a_silent_daemon_is_not_waited_for(self):
        # It never answers: without a limit this would last as long as the test may.
        fake = FakeDaemon(self.socket, {"describe": lambda _: None, "hello": lambda _: None})
        self.addCleanup(fake.close)
        done = subprocess.run([REGRASP, "__complete", "explore", ""], env=environment(REGRASP_SOCKET=str(self.socket)), capture_output=True, text=True,
                              timeout=HANG_S, check=True)
        self.assertEqual((done.stdout, done.stderr), ("", ""))
        self.assertIn(("describe", {"method": "explore"}), fake.requests)

    def test_without_a_daemon_the_grammar_is_left(self):
        done = subprocess.run([REGRASP, "__complete", "explore", "ring", "--estimator", ""], env=environment(REGRASP_SOCKET=str(self.socket)),
                              capture_output=True, text=True, timeout=HANG_S, check=True)
        self.assertEqual([line.split("\t")[0] for line in done.stdout.splitlines()], ["least_squares", "secant"])


    def test_models_and_words_that_the_daemon_checks_go_without_one(self):
        def offered(*words):
            done = subprocess.run([REGRASP, "__complete", *words], env=environment(REGRASP_SOCKET=str(self.socket)), capture_output=True, text=True,
                                  timeout=HANG_S, check=True)
            return [line.split("\t")[0] for line in done.stdout.splitlines()]

        for words, wanted in [(["up", "--object", "sphere_6"], [":files", "sphere_60mm"]), (["up", "--hand", "l"], [":files", "leap"]),
                              (["experiment", "rotation", "--hand", "al"], [":files", "allegro"]), (["object", "show", "eg"], [":files", "egg"]),
                              (["hand", "new", "--object", "eg"], [":files", "egg"]), (["hand", "check", "sh"], [":files", "shadow"]),
                              (["experiment", "zoo", "--objects", "eg"], ["egg"]), (["up", "--noise", "ta"], ["taxel"]),
                              (["up", "--clock", ""], ["continuous", "lockstep"]), (["up", "--stepper", ""], ["auto", "exact", "fast", "round"]),
                              (["experiment", "exploration", "--estimator", "s"], ["secant"])]:
            with self.subTest(words):
                self.assertEqual(offered(*words), wanted)


if __name__ == "__main__":
    unittest.main()
