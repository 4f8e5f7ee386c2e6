"""Run files in programs of others: every channel's schema keeps the rules that viewers of MCAP files have for JSON
(written here from their public documentation), every message is what its schema says, and the 3-D scene can be built
from one file alone and is the true one."""

import csv
import json
import math
import struct
import sys
import unittest

from harness import DaemonCase, SOURCE
from read_exports import read_npz

sys.path.insert(0, str(SOURCE / "cli" / "python"))
from regrasp.runs import messages  # pylint: disable=wrong-import-position

FINGERS = ["thumb", "first", "middle", "ring", "little"]


class Viewers(DaemonCase):
    ARGUMENTS = ["--speed", "max", "--seed", "1", "--paused"]

    def record(self):
        """A grasp, an exploration and a noise change on a mesh and on a sphere. Returns path and the truth at the end."""
        path = self.json("record", "start", "run.mcap", "--rate", 100)["path"]
        self.expect(0, "reset", "--object", "egg")
        self.expect(0, "step", 100, "--wait")
        self.expect(0, "reset", "--object", "sphere")
        self.expect(0, "noise", "set", "--position", "0.5mm")
        self.expect(0, "grasp")
        self.expect(0, "step", 2600, "--wait")
        self.expect(0, "explore", "ring", "--max-cycles", 400)
        self.expect(0, "step", 300, "--wait")
        truth = self.json("truth")
        self.expect(0, "record", "stop")
        return path, truth

    def test_schemas_keep_the_rules_and_messages_their_schemas(self):
        path, _ = self.record()
        channels = read_channels(path)
        self.assertGreaterEqual(set(channels), {"run", "commands", "state", "events", "joints", "contacts", "forces", "object", "quality", "gait",
                                                "transforms", "scene", "contact_scene", "saved_states"})
        for topic, (_, encoding, schema) in channels.items():
            self.assertEqual(encoding, "jsonschema", topic)
            check_schema(json.loads(schema), topic)
        self.assertEqual({topic: channels[topic][0] for topic in ("transforms", "scene", "contact_scene", "events")},
                         {"transforms": "foxglove.FrameTransforms", "scene": "foxglove.SceneUpdate", "contact_scene": "foxglove.SceneUpdate",
                          "events": "foxglove.Log"})
        seen = set()
        for topic, _, message in messages(path):
            check_value(message, json.loads(channels[topic][2]), topic)
            seen.add(topic)
        self.assertEqual(seen, set(channels) - {"gait"})

    def test_what_is_not_known_is_null(self):
        path, _ = self.record()
        quality = [m for topic, _, m in messages(path, "quality")]
        contacts = [m for topic, _, m in messages(path, "contacts")]
        self.assertEqual(list(contacts[-1]["p_WC_m"]), [f for f in contacts[-1]["role"]])
        self.assertEqual(sorted(contacts[-1]["p_WC_m"]), sorted(FINGERS))
        grasps = 0
        for q, c in zip(quality, contacts):
            holds = any(c["in_contact"][f] and c["role"][f] != "free" for f in FINGERS)
            grasps += holds
            self.assertEqual(q["stability"] is not None, holds, q["t_s"])
            for f in FINGERS:
                self.assertEqual(c["p_WC_m"][f] == [None, None, None], not c["in_contact"][f])
        self.assertGreater(grasps, 10)
        self.assertLess(grasps, len(quality))
        self.assertIsNone(quality[0]["exploring"])
        self.assertIsNone(quality[0]["phi"])
        self.assertEqual(quality[-1]["exploring"], "ring")

    def test_phi_is_null_until_the_finger_slides(self):
        self.expect(0, "grasp")
        self.expect(0, "step", 2600, "--wait")
        path = self.json("record", "start", "run.mcap", "--rate", 100)["path"]
        self.expect(0, "explore", "ring", "--max-cycles", 400)
        self.expect(0, "step", 100, "--wait")
        live = self.json("quality")["exploration"]
        self.assertEqual((live["finger"], live["cycle"], live["phi"], live["gradient_norm_1_m"]), ("ring", 0, None, None))
        self.expect(0, "step", 600, "--wait")
        live = self.json("quality")["exploration"]
        self.assertGreater(min(live["phi"], live["gradient_norm_1_m"]), 0)
        self.expect(0, "record", "stop")
        for name in ("phi", "gradient_norm_1_m"):
            values = [m[name] for _, _, m in messages(path, "quality") if m["exploring"]]
            began = next(i for i, value in enumerate(values) if value is not None)
            self.assertGreater(began, 10)
            self.assertNotIn(None, values[began:])
            self.assertGreater(min(values[began:]), 0)
            for form in ("csv", "npz"):
                self.expect(0, "export", path, "--format", form, "-o", self.dir / name / form)
            with open(self.dir / name / "csv" / "quality.csv", encoding="utf-8") as file:
                cells = [row[name + " [1/m]" * (name != "phi")] for row in csv.DictReader(file) if row["exploring"]]
            self.assertEqual([float(cell) if cell else None for cell in cells], values)
            self.assertEqual(sum(math.isnan(x) for x in read_npz(self.dir / name / "npz")["quality." + name][1][-len(values):]), began)

    def test_the_scene_is_rebuilt_from_the_file_alone(self):
        path, truth = self.record()
        last = {topic: message for topic, _, message in messages(path)}
        transforms = {t["child_frame_id"]: t for t in last["transforms"]["transforms"]}
        self.assertEqual({t["parent_frame_id"] for t in transforms.values()}, {"W"})
        # The object where it is.
        near(self, xyz(transforms["O"]["translation"]), truth["object"]["p_WO_m"], 1e-9)
        q = transforms["O"]["rotation"]
        near(self, [q["w"], q["x"], q["y"], q["z"]], truth["object"]["q_WO_wxyz"], 1e-9)
        # Every contact with its force.
        [contacts] = last["contact_scene"]["entities"]
        self.assertEqual(len(contacts["spheres"]), len(truth["contacts"]))
        self.assertGreaterEqual(len(truth["contacts"]), 4)
        scale = float(contacts["metadata"][0]["value"])
        arrows = {tuple(xyz(a["pose"]["position"])): a for a in contacts["arrows"]}
        shapes = {e["frame_id"]: e for e in last["scene"]["entities"]}
        [ball] = shapes["O"]["spheres"]
        for sphere, contact in zip(contacts["spheres"], truth["contacts"]):
            point = xyz(sphere["pose"]["position"])
            near(self, point, contact["p_WC_m"], 1e-9)
            arrow = arrows[tuple(point)]
            length = (arrow["shaft_length"] + arrow["head_length"]) / scale
            near(self, [length * c for c in rotate(arrow["pose"]["orientation"], [1, 0, 0])], contact["force_W_n"], 1e-6)
            # It lies on the object and on the link, as drawn.
            self.assertLess(abs(math.dist(point, xyz(transforms["O"]["translation"])) - ball["size"]["x"] / 2), 2e-4)
            self.assertLess(abs(distance(point, shapes[contact["link"]], transforms[contact["link"]])), 2e-4, contact["link"])


def read_channels(path):
    """{topic: (name, encoding and text of the schema)}; the records before the first chunk."""
    data = open(path, "rb").read()
    schemas, channels, at = {}, {}, 8
    while data[at] != 6:
        opcode, length = data[at], struct.unpack_from("<Q", data, at + 1)[0]
        content, place = data[at + 9:at + 9 + length], 2

        def text():
            nonlocal place
            size = struct.unpack_from("<I", content, place)[0]
            place += 4 + size
            return content[place - size:place].decode()
        if opcode == 3:
            schemas[struct.unpack_from("<H", content)[0]] = (text(), text(), text())
        if opcode == 4:
            schema = struct.unpack_from("<H", content, 2)[0]
            place = 4
            channels[text()] = schemas[schema]
        at += 9 + length
    return channels


def check_schema(schema, where):
    """The root and every structure is an object with properties; a list has items of one kind, that are no lists; there
    are no references, no several types, no null; text may be base64."""
    assert schema.get("type") == "object", where
    assert isinstance(schema.get("properties"), dict), where
    for name, field in schema["properties"].items():
        place = f"{where}.{name}"
        assert "$ref" not in field, place
        if field.get("type") == "array":
            assert isinstance(field.get("items"), dict), place
            field, place = field["items"], place + "[]"
            assert field.get("type") != "array", place + ": a list in a list"
        assert field.get("type") in ("boolean", "string", "number", "integer", "object"), f"{place}: {field.get('type')}"
        assert field.get("contentEncoding", "base64") == "base64", place
        if field["type"] == "object":
            check_schema(field, place)


def check_value(value, schema, where):
    """The value is null or of its type; an object has no member that the schema does not know."""
    kinds = {"boolean": bool, "string": str, "number": (int, float), "integer": int, "object": dict, "array": list}
    if value is None:
        return
    assert isinstance(value, kinds[schema["type"]]), f"{where}: {value!r} is no {schema['type']}"
    assert schema["type"] == "boolean" or not isinstance(value, bool), where
    if schema["type"] == "object":
        for name in schema.get("required", []):
            assert name in value, f"{where}.{name} is missing"
        for name, member in value.items():
            if name != "changed_parameters":  # another after a reset
                assert name in schema["properties"], f"{where}.{name} is not in the schema"
                check_value(member, schema["properties"][name], f"{where}.{name}")
    if schema["type"] == "array":
        for item in value[:50]:
            check_value(item, schema["items"], where + "[]")


def xyz(v):
    return [v["x"], v["y"], v["z"]]


def near(case, found, expected, tolerance):
    case.assertLess(max(abs(a - b) for a, b in zip(found, expected, strict=True)), tolerance, (found, expected))


def rotate(q, v):
    """v turned by the unit quaternion q."""
    u, w = xyz(q), q["w"]
    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    t = [2 * c for c in cross(u, v)]
    return [v[i] + w * t[i] + cross(u, t)[i] for i in range(3)]


def into(pose_p, pose_q, point):
    """A point of the parent frame in the frame of the pose."""
    back = {"x": -pose_q["x"], "y": -pose_q["y"], "z": -pose_q["z"], "w": pose_q["w"]}
    return rotate(back, [a - b for a, b in zip(point, xyz(pose_p))])


def distance(point_W, entity, transform):
    """From a point to the surface of the nearest primitive of a link [m]; negative inside."""
    point = into(transform["translation"], transform["rotation"], point_W)
    found = [math.dist(point, xyz(s["pose"]["position"])) - s["size"]["x"] / 2 for s in entity["spheres"]]
    for c in entity["cylinders"]:
        x, y, z = into(c["pose"]["position"], c["pose"]["orientation"], point)
        if abs(z) <= c["size"]["z"] / 2:
            found.append(math.hypot(x, y) - c["size"]["x"] / 2)
    for c in entity["cubes"]:
        local = into(c["pose"]["position"], c["pose"]["orientation"], point)
        over = [abs(p) - s / 2 for p, s in zip(local, xyz(c["size"]))]
        found.append(max(over) if max(over) < 0 else math.hypot(*[max(0, o) for o in over]))
    return min(found, key=abs)


if __name__ == "__main__":
    unittest.main()
