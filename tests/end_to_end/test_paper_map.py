"""The paper map does not lie: every file it names is there, every name is in the file, folder or table it is said to be in."""

import pathlib
import re
import unittest

from harness import SOURCE

MAP = SOURCE / "docs" / "paper_map.md"
IDENTIFIER = re.compile(r"^[A-Za-z_]\w*(::~?\w+)*$")
FILE = re.compile(r"^[\w/]*\w+\.(\{[\w,]+\}|\w+)$")
PARAMETER = re.compile(r"^(object|start|control|exploration|gait|shape)\.\w+")
# What is typed, not what is in the source: other tests run it.
TYPED = re.compile(r"^(regrasp|claims|plot|build/|--|checkpoint) ?")
SUFFIXES = {"h", "cc", "py", "urdf", "md"}


def expand(word):
    """`a.{h,cc}` as its files."""
    braces = re.match(r"(.*)\.\{(.*)\}$", word)
    return [f"{braces[1]}.{suffix}" for suffix in braces[2].split(",")] if braces else [word]


def sources(folder):
    return [path for path in sorted(folder.rglob("*")) if path.suffix in (".h", ".cc")]


def locate(word, folders):
    """The files that `word` names: from the root, or by its name alone, in a folder of the section first."""
    found = []
    for name in expand(word):
        if (SOURCE / name).exists():
            found.append(SOURCE / name)
            continue
        paths = [path for folder in folders for path in folder.rglob(name)] or [
            path for top in ("core", "snapshots", "daemon", "cli") for path in (SOURCE / top).rglob(name)]
        if len(paths) != 1:
            raise AssertionError(f"`{word}` names {len(paths)} files")
        found.append(paths[0])
    return found


def holds(path, name):
    """Whether a file declares or defines `name`; of Class::Member both, the member in the class's own file."""
    text = path.read_text()
    return all(re.search(rf"\b{part}\b", text) for part in name.split("::"))


def rows():
    """(place, code cell, files and folders of the section) for every row of every table."""
    section = []
    for number, line in enumerate(MAP.read_text().splitlines(), 1):
        if line.startswith("## "):
            section = []
        if line.startswith(("## ", "Code:")):
            section += [word for word in re.findall(r"`([^`]*)`", line)]
        if line.startswith("|") and not re.match(r"^\|[-|]+\|$", line):
            cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
            if "code" in cells or "where" in cells or "made by" in cells:
                column = next(i for i, cell in enumerate(cells) if cell in ("code", "where", "made by"))
                continue
            yield f"{MAP.name}:{number}", cells[column], list(section)


class PaperMap(unittest.TestCase):
    def test_every_name_is_where_the_map_says(self):
        parameters = set(re.findall(r'Row\("([\w.]+)"', (SOURCE / "core/session/parameters.cc").read_text()))
        self.assertGreater(len(parameters), 50)
        checked = 0
        for place, cell, section in rows():
            folders = [SOURCE / word for word in section if (SOURCE / word).is_dir()]
            named = []
            words = re.findall(r"`([^`]*)`", cell)
            for word in words:
                if FILE.match(word) and word.rsplit(".", 1)[1].strip("{}").split(",")[0] in SUFFIXES and not PARAMETER.match(word):
                    named += locate(word, folders)
                elif (SOURCE / word).is_dir() and "/" in word:
                    named += sources(SOURCE / word)
            where = named or [path for word in section for path in (sources(SOURCE / word) if (SOURCE / word).is_dir() else locate(word, folders))]
            for word in words:
                with self.subTest(place, word=word):
                    checked += self.check(place, word, where, parameters)
        self.assertGreater(checked, 30, "the map is read at all")

    def check(self, place, word, where, parameters):
        """Checks one name; 0 for what is no name."""
        name = word.split(" ")[0]
        if PARAMETER.match(name):
            self.assertIn(name, parameters)
            return 1
        if not IDENTIFIER.match(word) or TYPED.match(word):
            return 0
        candidates = where + [path.with_suffix(other) for path in where for other in (".h", ".cc") if path.with_suffix(other).exists()]
        self.assertTrue(candidates, f"{place}: no file or folder for `{word}`")
        self.assertTrue(any(holds(path, word) for path in candidates),
                        f"{place}: `{word}` is not in {sorted({str(path.relative_to(SOURCE)) for path in candidates})[:6]}")
        return 1

    def test_every_name_in_the_text_between_the_tables_is_somewhere_in_core(self):
        everything = "\n".join(path.read_text() for path in sources(SOURCE / "core"))
        for number, line in enumerate(MAP.read_text().splitlines(), 1):
            if line.startswith("|"):
                continue
            for word in re.findall(r"`([^`]*)`", line):
                if IDENTIFIER.match(word) and not TYPED.match(word):
                    for part in word.split("::"):
                        self.assertRegex(everything, rf"\b{part}\b", f"{MAP.name}:{number}")

    def test_contributing_says_where_things_are(self):
        text = (SOURCE / "CONTRIBUTING.md").read_text()
        rows = re.findall(r"^\| (.*?) \| `([^`]*)`.*? \| (`.*`) \|$", text.split("### Where is")[1].split("\n## ")[0], re.M)
        self.assertGreater(len(rows), 8)
        for what, path, words in rows:
            for word in re.findall(r"`([^`]*)`", words):
                with self.subTest(what):
                    self.assertIn(word, (SOURCE / path).read_text())

    def test_links_lead_somewhere(self):
        for target in re.findall(r"\]\(([^)#]+)\)", MAP.read_text()):
            if "://" not in target:
                self.assertTrue((MAP.parent / pathlib.Path(target)).exists(), target)


if __name__ == "__main__":
    unittest.main()
