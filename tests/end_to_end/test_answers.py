"""Every request is answered exactly once and in order, whatever the daemon is doing.

    REGRASP_REQUESTS=100000 REGRASP_BIN_DIR=build/release/bin REGRASP_SOURCE_DIR=. python3 tests/end_to_end/test_answers.py
"""

import json
import os
import pathlib
import random
import select
import unittest

from harness import HANG_S, DaemonCase, Wire

REQUESTS = int(os.environ.get("REGRASP_REQUESTS", "3000"))
SEED = int(os.environ.get("REGRASP_SEED_OF_REQUESTS", "1"))


class Client(Wire):
    """Pipelines requests, reads answers, checks that each id comes once and in order (job.wait may be overtaken)."""

    def __init__(self, path):
        super().__init__(path)
        self.open = {}  # id -> method, in the order of asking
        self.rest = b""  # of what came, the line that has not ended
        self.answer = None  # to the last request

    def send(self, requests, batch=False):
        messages = []
        for method, params in requests:
            messages.append(self.request(method, params))
            self.open[self.last] = method
        if batch:
            self.write(messages)
        else:
            self.write(*messages)

    def take(self, answer):
        number = answer.get("id")
        if number is None:
            assert answer.get("method") == "event", answer
            return
        assert number in self.open, f"{number} is answered twice, or was never asked: {answer}"
        assert ("result" in answer) != ("error" in answer), answer
        if "error" in answer:
            assert answer["error"]["code"] != -32603, f"{self.open[number]}: {answer}"
        waits = {"job.wait"}
        earlier = [i for i, method in self.open.items() if i < number and method not in waits]
        if self.open[number] not in waits:
            assert not earlier, f"{number} is answered before {earlier}"
        del self.open[number]
        if number == self.last:
            self.answer = answer

    def read(self):
        """What is there."""
        data = self.socket.recv(1 << 16)
        assert data, f"the connection ended with {self.open} open"
        *lines, self.rest = (self.rest + data).split(b"\n")
        for line in lines:
            message = json.loads(line)
            for answer in message if isinstance(message, list) else [message]:
                self.take(answer)

    def read_all(self, others=()):
        """Until everything is answered. Others read meanwhile: who reads nothing for 10 s is disconnected, and this may take longer."""
        clients = {client.socket: client for client in (self, *others)}
        while self.open:
            ready = select.select(clients, [], [], HANG_S)[0]
            assert ready, f"no answer to {self.open}"
            for each in ready:
                clients[each].read()

    def ask(self, method, **params):
        self.send([(method, params)])
        while self.last in self.open:
            self.read()
        return self.answer



def request(r):
    """One of everything the protocol has, valid or not."""
    job = r.randint(1, 40)
    return r.choice([
        ("status", {}), ("version", {}), ("contacts", {}), ("joints", {}), ("quality", {}), ("truth", {}), ("describe", {}),
        ("events", {"count": r.randint(1, 1000)}), ("job.list", {}), ("job.get", {"id": job}), ("job.cancel", {"id": job}),
        ("job.wait", {"id": job, "timeout_s": r.choice([0, 0.01, 0.05])}), ("grasp", {}), ("release", {}), ("stop", {}),
        ("explore", {"finger": r.choice(["ring", "thumb", "nose"]), "max_cycles": 1}), ("rotate", {"angle_rad": r.uniform(-0.1, 0.1)}),
        ("move", {"offset_m": [0, 0, 0.001]}), ("pause", {}), ("resume", {}), ("step", {"ticks": r.randint(1, 20)}),
        ("reset", {"seed": r.randint(0, 9)}), ("noise.get", {}), ("noise.set", {"preset": r.choice(["off", "paper", "loud"])}),
        ("push", {"force_n": [0, 0, 0.01], "duration_s": 0.01}), ("param.get", {}), ("param.set", {"name": "object.friction", "value": 0.7}),
        ("param.set", {"name": "object.friction", "value": 7}), ("record.start", {"file": f"r{r.randint(0, 99999)}.mcap"}),
        ("record.start", {"file": "../x.mcap"}), ("record.stop", {}), ("record.list", {}), ("checkpoint.save", {"name": r.choice("abc-")}),
        ("checkpoint.list", {}), ("checkpoint.restore", {"name": r.choice("abcd")}), ("subscribe", {"topic": "events"}),
        ("unsubscribe", {"sub": r.randint(1, 40)}), ("hello", {"protocol": [1, 1]}), ("nonsense", {}), ("status", {"x": 1}),
        ("plot", {"name": "scene", "file": f"{r.choice('pq')}.png", "overwrite": r.random() < 0.5}) if r.random() < 0.1 else ("version", {})])


class Answers(DaemonCase):
    def test_a_random_client_gets_every_answer_once_and_in_order(self):
        r = random.Random(SEED)
        clients = [Client(self.socket) for _ in range(4)]
        asked = 0
        while asked < REQUESTS:
            client = r.choice(clients)
            count = r.randint(1, 24)
            client.send([request(r) for _ in range(count)], batch=r.random() < 0.2)
            asked += count
            if r.random() < 0.05:  # leaves with its answers open
                client.close()
                clients.remove(client)
                clients.append(Client(self.socket))
            elif r.random() < 0.5:
                client.read_all(clients)
        for client in clients:
            client.read_all(clients)
        for client in clients[1:]:
            client.close()
        # Nobody who left is still here: every answer they waited for has been dropped or made.
        while (status := clients[0].ask("status"))["result"]["clients"] != 1:
            self.assertIn("result", status)
        clients[0].close()

    def test_what_is_asked_during_a_restore_is_answered(self):
        client = Client(self.socket)
        client.ask("resume")
        job = client.ask("grasp")["result"]["job"]
        client.ask("job.wait", id=job)
        self.assertIn("result", client.ask("checkpoint.save", name="far"))
        # In one go, so that the second and third meet the restore.
        client.send([("checkpoint.restore", {"name": "far"}), ("checkpoint.save", {"name": "x"}), ("record.stop", {}), ("status", {})])
        client.read_all()
        client.close()

    def test_a_large_checkpoint_holds_up_only_who_asked_for_it(self):
        reads, asks = Client(self.socket), Client(self.socket)
        path = pathlib.Path(asks.ask("checkpoint.save", name="large")["result"]["path"])
        first_line = path.read_bytes().split(b"\n")[0]
        path.write_bytes(first_line + b"\n" + b" " * (100 << 20) + b"\n")
        # Were it read by the thread that answers, at most one `version` could come before it. Once is enough.
        for _ in range(10):
            reads.send([("checkpoint.restore", {"name": "large"})])
            for _ in range(10):
                asks.ask("version")
            first = not select.select([reads.socket], [], [], 0)[0]
            reads.read_all()
            if first:
                break
        self.assertTrue(first)
        reads.close()
        asks.close()

    def test_shutdown_answers_what_was_asked_before(self):
        client = Client(self.socket)
        client.send([("status", {})] * 20 + [("checkpoint.save", {"name": "last"}), ("shutdown", {})])
        client.read_all()
        self.assertEqual(client.rest + client.socket.recv(1), b"")
        client.close()


if __name__ == "__main__":
    unittest.main()
