"""CSV: a list has every column that one of its rows has, a stream the same columns whatever goes on."""

import csv
import json
import shlex
import subprocess
import unittest

from harness import DaemonCase, REGRASP, environment


def by_option(words):
    """Each word with the option before it, if there is one: in any order."""
    words = list(words)
    return sorted((before if before.startswith("-") else "", word) for before, word in zip([""] + words, words))


class Csv(DaemonCase):
    ARGUMENTS = ["--speed", "max", "--seed", "1", "--clock", "continuous", "--paused"]

    def columns(self, *words):
        return next(csv.reader(self.expect(0, "--csv", *words).stdout.splitlines()))

    def test_a_list_has_the_columns_of_all_its_rows(self):
        self.expect(0, "grasp")
        self.expect(0, "step", "--until-job-ends", "--wait")
        self.expect(0, "explore", "ring", "--max-cycles", "10")
        self.expect(0, "step", "--until-job-ends", "--wait")
        rows = list(csv.DictReader(self.expect(0, "--csv", "job", "list").stdout.splitlines()))
        explored = next(row for row in rows if row["method"] == "explore")
        self.assertEqual((explored["finger"], explored["criterion"]), ("ring", "manipulability"))
        self.assertEqual(rows[0]["finger"], "")

    def test_what_prints_no_table_says_how_it_is_told_instead(self):
        for words in (["object", "show", "a b.urdf"], ["hand", "check", "a b.urdf", "--inertia-from-shape"], ["plot", "quality", "a b.mcap", "c.mcap", "-o", "d.png"]):
            with self.subTest(words):
                cause, hint = self.refused(2, "--csv", *words)
                self.assertIn("prints no table", cause)
                again = shlex.split(hint.removeprefix("  try: "))
                self.assertEqual(again[:2], ["regrasp", "--json"])
                self.assertEqual(by_option(again[2:]), by_option("--output" if word == "-o" else word for word in words))

    def test_a_stream_has_the_same_columns_idle_and_holding(self):
        topics = ("status", "contacts", "quality", "joints", "truth")
        idle = {topic: self.columns("watch", topic, "--count", "1") for topic in topics}
        for column in ("fingers.ring.p_WC_m.2", "fingers.thumb.normal_W.0", "fingers.ring.in_contact"):
            self.assertIn(column, idle["contacts"])
        for column in ("job.id", "job.state", "job.progress", "job.more", "state", "gait", "incident"):
            self.assertIn(column, idle["status"])
        self.assertIn("contacts", idle["truth"])
        self.expect(0, "grasp")
        self.expect(0, "step", "--until-job-ends", "--wait")
        self.expect(0, "rotate", "--angle", "20")
        self.expect(0, "step", "500", "--wait")
        for topic in topics:
            with self.subTest(topic):
                self.assertEqual(self.columns("watch", topic, "--count", "1"), idle[topic])

    def test_a_stream_that_began_idle_shows_what_comes(self):
        with subprocess.Popen([REGRASP, "-s", self.socket, "--csv", "watch", "truth"], env=environment(), stdout=subprocess.PIPE, text=True) as watch:
            lines = [watch.stdout.readline(), watch.stdout.readline()]
            self.expect(0, "grasp")
            self.expect(0, "step", "--until-job-ends", "--wait")
            while not json.loads((row := list(csv.DictReader([lines[0], watch.stdout.readline()]))[0])["contacts"]):
                pass
            watch.kill()
        self.assertIn("force_W_n", json.loads(row["contacts"])[0])


if __name__ == "__main__":
    unittest.main()
