"""A daemon of its own, started as it is and not by `regrasp up`, and a connection that tells when it was given up."""

import json
import subprocess
import time

from harness import HANG_S, REGRASPD, SOURCE, Case, Wire, environment


class Connection(Wire):
    """`ask` returns the answer, `None` where the connection was given up."""

    def __init__(self, path):
        super().__init__(path)
        self.events = []

    def send(self, method, **params):
        self.write(self.request(method, params))

    def ask(self, method, **params):
        try:
            self.send(method, **params)
            while line := self.lines.readline():
                answer = json.loads(line)
                if answer.get("id") == self.last:
                    return answer
                self.events.append(answer)
        except ConnectionError:
            pass
        return None

    def result(self, method, **params):
        answer = self.ask(method, **params)
        if answer is None or "result" not in answer:
            raise AssertionError(f"{method} {params}: {answer}")
        return answer["result"]

    def event(self, kind):
        """The next event of that kind; others are passed over."""
        while True:
            for i, message in enumerate(self.events):
                if message.get("params", {}).get("kind") == kind:
                    del self.events[:i + 1]
                    return message["params"]
            self.events = []
            line = self.lines.readline()
            if not line:
                raise AssertionError(f"the connection ended before {kind}")
            self.events.append(json.loads(line))


class SystemCase(Case):
    def start(self, *arguments, preexec=None, stderr=subprocess.DEVNULL, **env):
        self.socket.parent.mkdir(mode=0o700, exist_ok=True)
        self.out = self.dir / "out"
        self.daemon = subprocess.Popen([str(REGRASPD), "--socket", str(self.socket), "--output-dir", str(self.out), "--models-dir",
                                        str(SOURCE / "models"), *arguments], env=environment(**env), stderr=stderr, preexec_fn=preexec)
        self.addCleanup(self.daemon.wait)
        self.addCleanup(self.daemon.kill)
        while True:
            self.assertIsNone(self.daemon.poll(), "the daemon has ended")
            try:
                wire = Connection(self.socket)
            except OSError:
                time.sleep(0.01)
                continue
            wire.result("version")  # it minds signals now
            return wire

    def goes_on(self, wire):
        """The simulation moves, and the daemon ends cleanly when asked."""
        before = wire.result("status")["tick"]
        while wire.result("status")["tick"] <= before:
            pass
        self.daemon.terminate()
        self.assertEqual(self.daemon.wait(HANG_S), 0)
