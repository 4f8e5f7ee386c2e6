#!/usr/bin/env python3
"""Lets every finger improve the grasp in turn and prints what that brought. Standard library only.

    regrasp up --speed max && python3 explore.py [SOCKET]
"""

import json
import os
import socket
import sys
import tomllib


class Regrasp:
    """One connection: requests go out with a number, answers come back in their order."""

    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.socket.connect(path)
        self.lines = self.socket.makefile("r", encoding="utf-8")
        self.last_id = 0

    def call(self, method, **params):
        self.last_id += 1
        request = {"jsonrpc": "2.0", "id": self.last_id, "method": method, "params": params}
        self.socket.sendall(json.dumps(request).encode() + b"\n")
        answer = json.loads(self.lines.readline())
        if "error" in answer:
            error = answer["error"]
            raise RuntimeError(f"{method}: {error['message']} (try: {error['data']['hint']})")
        return answer["result"]

    def finish(self, method, **params):
        """Starts a job and waits for its record."""
        return self.call("job.wait", id=self.call(method, **params)["job"])


def configured_socket():
    """What the configuration file says, if it says anything."""
    home = os.environ.get("XDG_CONFIG_HOME") or os.path.expanduser("~/.config")
    usual = [folder + "/regrasp/regraspd.toml" for folder in (home, "/etc")]
    file = os.environ.get("REGRASP_CONFIG") or next(filter(os.path.exists, usual), None)
    if not file:
        return None
    with open(file, "rb") as text:
        return tomllib.load(text).get("socket")


def find_socket():
    """The path that was named, or the first that is there of the places where `regrasp up` puts it."""
    named = sys.argv[1] if len(sys.argv) > 1 else os.environ.get("REGRASP_SOCKET") or configured_socket()
    if named:
        return named
    folders = [os.environ.get("XDG_RUNTIME_DIR", "/run") + "/regrasp", "/run/regrasp", f"/tmp/regrasp-{os.getuid()}"]
    paths = [folder + "/regrasp.sock" for folder in folders]
    return next(filter(os.path.exists, paths), paths[0])


def main():
    path = find_socket()
    try:
        hand = Regrasp(path)
    except OSError as error:
        print(f"no daemon: {path}: {error.strerror}; try: regrasp up --speed max", file=sys.stderr)
        sys.exit(3)
    if hand.call("status")["state"] == "idle":
        hand.finish("grasp")
    for finger in hand.call("quality")["fingers"]:
        try:
            job = hand.finish("explore", finger=finger, max_cycles=1500)
        except RuntimeError as refusal:
            print(f"{finger:7} {refusal}")
            continue
        if job["state"] != "done":
            print(f"{finger:7} {job['state']}: {job['error']}")
            continue
        print(f"{finger:7} phi {job['phi_true_initial']:.4f} -> {job['phi_true_final']:.4f}, "
              f"{1e3 * job['path_length_m']:.1f} mm, {job['reason']}")


if __name__ == "__main__":
    main()
