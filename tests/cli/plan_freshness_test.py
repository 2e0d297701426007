"""Exactly the steps do something that have to, in a chain of real tools: plan_freshness_test.py ROOT BIN_DIR"""
import json
import os
import re
import subprocess
import time

from plan_support import MODEL, PATH, TOOLS, PlanTest, main


class ChangesTest(PlanTest):
    TRACES = "trace-whole trace-parts-1of2 trace-parts-2of2"
    ALL = f"import-tent grid-tent {TRACES} trace-turn-0001 merge-parts compare-same"
    SHOWN = {"atlas": "tent", "camera": "front", "size": [8, 64]}

    def setUp(self):
        super().setUp()
        self.environment["RT_TOOLS_DIR"] = str(self.folder / "tools")
        (self.folder / "tools").mkdir()
        for tool in ("rt-import", "rt-grid", "rt-trace", "rt-compare"):
            (self.folder / "tools" / tool).symlink_to(TOOLS / tool)
        textured = re.sub(r"^f (\d) (\d) (\d)", r"f \1/1 \2/1 \3/1", MODEL, flags=re.MULTILINE)
        self.write("tent.obj", f"mtllib tent.mtl\nvt 0 0\nusemtl a\n{textured}")
        self.write("tent.mtl", "newmtl a\nKd 1 1 1\nmap_Kd t.ppm\n")
        self.write("t.ppm", "P6\n1 1\n255\nabc")
        self.write("tent.scene.json", json.dumps({
            "models": [{"file": "tent.obj"}], "lights": [{"kind": "point", "position": [2, 4, 1], "intensity": 10}],
            "cameras": [{"name": "front", "eye": [3, 2, 0], "lookAt": [0, 0.4, 0]}]}))  # fmt: skip
        self.document = {
            "scenes": {"tent": {"inputs": ["tent.scene.json"], "options": []}},
            "atlases": {"tent": {"scene": "tent", "structure": "cloud"}},
            "renders": {"whole": self.SHOWN | {"options": []}, "parts": self.SHOWN | {"shards": 2, "options": []},
                        "turn": {"atlas": "tent", "cameraPath": "path.json", "frames": [1, 1], "size": [8, 8]}},
            "comparisons": {"same": {"render": "parts", "against": "whole", "limits": {"max-rmse": 0}}},
        }  # fmt: skip
        self.describe(self.document)

    def edit(self, name, old, new):
        text = (self.folder / name).read_text()
        self.assertIn(old, text)
        self.write(name, text.replace(old, new))

    def option(self, kind, *names, words):
        for name in names:
            self.document[kind][name].setdefault("options", []).extend(words)
        self.describe(self.document)

    def upgrade(self, tool):
        version = subprocess.run([TOOLS / tool, "--version"], capture_output=True, text=True, check=True).stdout.split()[1]
        later = version[:-1] + ("8" if version.endswith("9") else "9")
        link = self.folder / "tools" / tool
        program = link.read_bytes().replace(version.encode(), later.encode())
        link.unlink()
        link.write_bytes(program)
        link.chmod(0o755)

    def touch_all(self):
        for i, path in enumerate(sorted(self.folder.rglob("*.*"))):
            if not path.is_dir() and "tools" not in path.parts:
                os.utime(path, (time.time() + 3600 * (i % 5 - 2),) * 2)

    def flip(self, name):
        """One bit, and the time stamp says nothing."""
        path = self.folder / "tent" / name
        status = path.stat()
        with open(path, "r+b") as file:
            file.seek(status.st_size // 2)
            byte = file.read(1)[0]
            file.seek(-1, os.SEEK_CUR)
            file.write(bytes([byte ^ 1]))
        os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))

    def cut(self, name):
        os.truncate(self.folder / "tent" / name, (self.folder / "tent" / name).stat().st_size - 1)

    def replace_by_older(self, name, content):
        self.write("older", content)
        os.utime(self.folder / "older", (1, 1))
        os.replace(self.folder / "older", self.folder / name)

    def rows(self):
        """(what changes, how, what works then). Two at a time where neither makes plan look at what the other does."""
        seen = f"{self.TRACES} merge-parts compare-same"
        yield "nothing", lambda: None, ""
        yield "time stamps", self.touch_all, ""
        yield "a texture, older", lambda: self.replace_by_older("t.ppm", "P6\n1 1\n255\naba"), self.ALL
        yield "a mesh", lambda: self.edit("tent.obj", "v 0 1 0", "v 0 1.5 0"), self.ALL
        yield "a comment, and a camera's path, older", lambda: (
            self.edit("tent.mtl", "newmtl a", "# A\nnewmtl a"), self.replace_by_older("path.json", json.dumps(PATH).replace("[3, 2, 0]", "[3, 2, 1]")),
        ), "import-tent trace-turn-0001"  # fmt: skip
        yield "an option of rt-import, and of rt-compare", lambda: (
            self.option("scenes", "tent", words=["--weld", "0"]), self.option("comparisons", "same", words=["--worst", "2"]),
        ), "import-tent compare-same"  # fmt: skip
        yield "an option of rt-grid", lambda: self.option("atlases", "tent", words=["--resolution", "7"]), self.ALL.removeprefix("import-tent ")
        yield "an option of rt-trace", lambda: self.option("renders", "whole", words=["--max-depth", "2"]), "trace-whole"
        yield "one that is seen", lambda: self.option("renders", "whole", "parts", words=["--ambient", "0.5"]), seen
        for tools, works in (("import", "trace"), f"import-tent {seen} trace-turn-0001"), (("grid", "compare"), "grid-tent compare-same"):
            yield tools, lambda: [self.upgrade(f"rt-{tool}") for tool in tools], works
        for outputs in ({"tent.rtmesh": "import-tent", "whole/whole.exr": "trace-whole", "parts/parts.part2of2.exr": "trace-parts-2of2"},
                        {"tent.rtatlas": "grid-tent", "same/same.html": "compare-same"},
                        {"whole/whole.png": "trace-whole", "parts/parts.exr": "merge-parts"}):  # fmt: skip
            works = " ".join(outputs.values())
            yield f"a bit of {outputs}", lambda: [self.flip(name) for name in outputs], works
            yield f"the end of {outputs}", lambda: [self.cut(name) for name in outputs], works
            yield f"{outputs}, older", lambda: [self.replace_by_older(f"tent/{name}", "what was here before") for name in outputs], works
            yield f"{outputs}, gone", lambda: [(self.folder / "tent" / name).unlink() for name in outputs], works
        yield "a stamp", (self.folder / "tent/same/same.passed").unlink, ""

    def run_working(self):
        said = self.call_here("run", "tent.plan.json")
        return set(re.findall(r"^\[\d+/\d+\] (\S+): (?!.*up to date)", said, re.MULTILINE))

    def test_exactly_the_steps_work_that_have_to(self):
        self.assertEqual(self.run_working(), set(self.ALL.split()))
        for change, make, works in self.rows():
            with self.subTest(change=change):
                make()
                self.assertEqual(self.run_working(), set(works.split()))
        self.assertEqual(self.run_again(), "import-tent")


if __name__ == "__main__":
    main()
