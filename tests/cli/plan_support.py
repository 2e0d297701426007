"""What the tests of pipelines/plan share; each is called with ROOT BIN_DIR."""
import contextlib
import io
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock

ROOT, TOOLS = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
PLAN = ROOT / "pipelines" / "plan"
sys.dont_write_bytecode = True
sys.path[:0] = [str(ROOT / "pipelines"), str(ROOT / "tests" / "support")]
from planner import command_line  # noqa: E402

MODEL = "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 1 0\nf 1 3 2\nf 1 4 3\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n"
PATH = [{"frame": 1, "eye": [3, 2, 0], "lookAt": [0, 0.4, 0]}, {"frame": 2, "eye": [0, 2, 3], "lookAt": [0, 0.4, 0]}]
LOOK = {"atlas": "tent", "size": [4, 64], "options": ["--light", "point:2,4,1"]}
GOOD = {
    "$schema": "plan.schema.json",
    "scenes": {"tent": {"inputs": ["tent.obj"], "options": ["--weld", "0"], "resources": {"memory": 100}}},
    "atlases": {"tent": {"scene": "tent", "structure": "cloud", "quality": "fast", "options": [], "resources": {"cores": 1}}},
    "renders": {
        "around": LOOK | {"cameraPath": "path.json", "frames": [1, 2], "shards": 2, "shardBy": "parts", "passes": ["Z", "id"],
                          "pngOptions": ["--tonemap", "aces"], "resources": {"gpus": 1, "minutes": 2}},
        "whole": LOOK | {"cameraPath": "path.json", "frames": [1, 2], "framesPerStep": 2, "passes": ["Z", "id"]},
        "still": LOOK,
    },
    "comparisons": {"same": {"render": "around", "against": "whole", "limits": {"max-rmse": 0, "max-abs": "Z=0"},
                             "options": ["--worst", "1"], "resources": {}}},
    "resources": {"import": {"cores": 1}, "grid": {}, "trace": {"cores": 1}, "merge": {}, "compare": {}},
}  # fmt: skip

CACHE = tempfile.TemporaryDirectory()  # of all tests of a file, so that rt-trace compiles its shaders once


class PlanTest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.write("tent.obj", MODEL)
        self.write("path.json", json.dumps(PATH))
        self.environment = os.environ | {"RT_TOOLS_DIR": str(TOOLS), "RT_DEVICES": "software,software",
                                         "RT_DEVICE_LOCKS": str(self.folder / "devices"), "XDG_CACHE_HOME": CACHE.name}  # fmt: skip
        self.environment.pop("RT_NO_SHADER_CACHE", None)

    def write(self, name, text, mode=0o644):
        (self.folder / name).write_text(text)
        (self.folder / name).chmod(mode)

    def describe(self, document=None):
        self.write("tent.plan.json", json.dumps(document or GOOD))

    def call(self, *words, expect=0):
        result = subprocess.run([sys.executable, PLAN, *words], cwd=self.folder, env=self.environment, capture_output=True, text=True)
        self.assertEqual(result.returncode, expect, f"{words}\n{result.stdout}{result.stderr}")
        return result.stdout if expect == 0 else result.stdout + result.stderr

    def call_here(self, *words, expect=0):
        """In this process: starting Python would cost more than most steps."""
        said, errors_said = io.StringIO(), io.StringIO()
        environment = unittest.mock.patch.dict(os.environ, self.environment, clear=True)
        name = unittest.mock.patch.object(command_line, "NAME", "plan")
        with environment, name, contextlib.chdir(self.folder), contextlib.redirect_stdout(said), contextlib.redirect_stderr(errors_said):
            code = command_line.main(["plan", *words])
        self.assertEqual(code, expect, f"{words}\n{said.getvalue()}{errors_said.getvalue()}")
        return said.getvalue() + errors_said.getvalue()

    def run_again(self, *words):
        """Names of the steps that `plan run` calls."""
        said = self.call("run", "tent.plan.json", *words)
        return " ".join(re.findall(r"^\[\d+/\d+\] (\S+):", said, re.MULTILINE))

    def describe_still(self):
        self.describe({key: GOOD[key] for key in ("scenes", "atlases")} | {"renders": {"still": LOOK}})

    def export_with(self, script):
        self.describe()
        self.stand_in(script)
        self.call("tent.plan.json", "--ninja", "n")

    def states(self, expect=0):
        steps = json.loads(self.call("status", "tent", "--json", expect=expect))["steps"]
        return {step["id"]: step for step in steps}

    def wait_for(self, condition):
        end = time.monotonic() + 60
        while not condition():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.02)

    def stand_in(self, script):
        """All tools do this instead; $out is what follows the first -o, `make` touches all outputs."""
        head = """#!/bin/sh
[ "$1" != --version ] || exit 0
outs=; frames=0-0; previous=
for word; do
    case $previous in -o|--html|--json) outs="$outs $word" ;; --frames) frames=$word ;; esac
    previous=$word
done
out=${outs# }; out=${out%% *}
make() { for out in $outs; do for n in $(seq ${frames%-*} ${frames#*-}); do touch "$(printf "$out" $n)"; done; done; }
"""
        (self.folder / "tools").mkdir()
        for tool in ("rt-import", "rt-grid", "rt-trace", "rt-compare"):
            self.write(f"tools/{tool}", head + script, 0o755)
        self.environment["RT_TOOLS_DIR"] = str(self.folder / "tools")


def main():
    signal.signal(signal.SIGINT, signal.default_int_handler)  # in the background it is ignored, and would be by what is started here
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
