"""What touching reveals of an object: in figures, as a mesh that other programs open, and as a picture."""

import math
import struct
import unittest

from harness import DaemonCase


class Shape(DaemonCase):
    ARGUMENTS = ["--speed", "max", "--seed", "1", "--clock", "lockstep", "--object", "egg"]

    def ply(self, path):
        """(names of the vertices' properties, vertices, triangles) of a PLY file in text."""
        head, body = path.read_text().split("end_header\n")
        lines = [line.split() for line in head.splitlines()]
        self.assertEqual(lines[0], ["ply"])
        counts = {line[1]: int(line[2]) for line in lines if line[0] == "element"}
        names = [line[2] for line in lines if line[:2] == ["property", "float"]]
        rows = [[float(x) for x in row.split()] for row in body.splitlines()]
        self.assertEqual(len(rows), counts["vertex"] + counts["face"])
        triangles = [[int(i) for i in row[1:]] for row in rows[counts["vertex"]:]]
        return names, rows[:counts["vertex"]], triangles

    def test_an_egg(self):
        before = self.json("shape")
        self.assertEqual((before["touched_cells"], before["truth"], before["mean_radius_m"]), (0, None, None))
        cause, hint = self.refused(5, "plot", "shape", "-o", self.dir / "early.svg")
        self.assertIn("no finger has felt the object", cause)
        self.assertIn("regrasp grasp", hint)
        self.assertFalse((self.dir / "early.svg").exists())
        self.expect(0, "record", "start", "egg.mcap")
        self.expect(0, "grasp", "--wait")
        self.expect(0, "rotate", "--angle", 90, "--wait")
        shape = self.json("shape")
        self.assertEqual(shape["object"], "egg")
        self.assertGreater(shape["touched_fraction"], 0.05)
        self.assertLess(shape["truth"]["rms_error_m"], 0.0003)
        self.assertLess(shape["truth"]["normal_error_rad"], math.radians(5))
        self.assertIn("bias", self.expect(0, "shape").stdout)

        ply, stl = self.dir / "felt.ply", self.dir / "felt.stl"
        self.expect(0, "shape", "-o", ply)
        self.expect(0, "shape", "-o", stl)
        names, vertices, triangles = self.ply(ply)
        known = [v for v in vertices if v[names.index("unknown_rad")] < 0.1]
        self.assertGreater(len(known), 20)
        for vertex in known:
            self.assertLess(abs(vertex[names.index("error_m")]), 0.002)
        self.assertTrue(all(0 <= i < len(vertices) for t in triangles for i in t))
        raw = stl.read_bytes()
        (count,) = struct.unpack_from("<I", raw, 80)
        self.assertEqual((count, len(raw)), (len(triangles), 84 + 50 * len(triangles)))
        first = struct.unpack_from("<12f", raw, 84)
        for got, wanted in zip(first[3:6], vertices[triangles[0][0]][:3]):
            self.assertAlmostEqual(got, wanted, 6)

        self.expect(0, "plot", "contacts", "-o", self.dir / "contacts.svg")
        self.assertIn("surface as felt", (self.dir / "contacts.svg").read_text())
        # The same picture from the daemon and from the run's file.
        self.expect(0, "plot", "shape", "-o", self.dir / "shape.svg")
        self.expect(0, "record", "stop")
        self.expect(0, "plot", "shape", self.dir / "out" / "egg.mcap", "-o", self.dir / "again.svg")
        cause, _ = self.refused(74, "plot", "shape", self.dir / "out" / "egg.mcap", "-o", self.dir / "no" / "again.svg")
        self.assertIn(f"{self.dir / 'no'} is not a directory", cause)
        picture = (self.dir / "shape.svg").read_text()
        self.assertIn(f"touched, {100 * shape['touched_fraction']:.0f} % of it", picture)
        self.assertIn(f"rms error  {1e3 * shape['truth']['rms_error_m']:.2f} mm", picture)
        self.assertEqual(picture, (self.dir / "again.svg").read_text())
        self.expect(0, "reset")
        self.assertEqual(self.json("shape")["touched_cells"], 0)
        self.refused(5, "plot", "shape")

    def test_a_directory_that_is_missing_is_not_made(self):
        for words in (["shape", "-o", "FILE.ply"], ["plot", "scene", "-o", "FILE.png"], ["object", "show", "egg", "-o", "FILE.png"], ["param", "save", "FILE.toml"]):
            with self.subTest(words):
                cause, _ = self.refused(74, *(word.replace("FILE", str(self.dir / "no" / "x" / "felt")) for word in words))
                self.assertIn(f"{self.dir / 'no' / 'x'} is not a directory", cause)
                self.assertFalse((self.dir / "no").exists())
                self.assertEqual(list((self.dir / "out").glob("*.png")), [], "drawn in vain")

    def test_another_suffix_is_refused(self):
        said = self.refused(2, "shape", "-o", self.dir / "felt.obj")
        self.assertIn(".ply or .stl", said[0])
        self.assertFalse((self.dir / "felt.obj").exists())


if __name__ == "__main__":
    unittest.main()
