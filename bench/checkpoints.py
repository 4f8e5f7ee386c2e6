#!/usr/bin/env python3
"""How long a client waits for a checkpoint to be on the disk, and to be loaded again (job.wait included).

    PYTHONPATH=cli/python python3 bench/checkpoints.py [N]      N of each, 100; build/release/bin in PATH
"""
import sys
import time

import regrasp


def milliseconds(action):
    start = time.perf_counter()
    action()
    return 1e3 * (time.perf_counter() - start)


def main():
    n = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    if n < 1:
        sys.exit(f"checkpoints: N is {n}; allowed: at least 1")
    with regrasp.start(seed=1) as hand:
        hand.grasp().done()
        hand.rotate(turns=1000)  # goes on all the while
        names = [f"bench-{k}" for k in range(n)]
        rows = {
            "version": [milliseconds(hand.version) for _ in names],
            "checkpoint.save": [milliseconds(lambda name=name: hand.checkpoint_save(name=name)) for name in names],
            "checkpoint.restore": [milliseconds(lambda name=name: hand.checkpoint_restore(name=name).wait())
                                   for name in names],
        }
        print("at the end:", hand.status()["state"])
    print("[ms]                 median   p90   most")
    for name, times in rows.items():
        times.sort()
        print(f"{name:20} {times[n // 2]:6.2f} {times[9 * n // 10]:6.2f} {times[-1]:6.2f}")


if __name__ == "__main__":
    main()
