"""pipelines/plan through its executable: plan_test.py ROOT BIN_DIR"""
import contextlib
import copy
import io
import json
import os
import pathlib
import re
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unicodedata
import unittest
import unittest.mock
import xml.etree.ElementTree as ET
import zlib

import jsonschema
import numpy

ROOT, TOOLS = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
PLAN = ROOT / "pipelines" / "plan"
sys.dont_write_bytecode = True
sys.path[:0] = [str(ROOT / "pipelines"), str(ROOT / "tests" / "support")]
from changed_document import REMOVE, changed_document  # noqa: E402
from planner import command_line, description, errors, files, goldens, graph, run_here, run_step  # noqa: E402
from planner import slurm_queue, status, thumbnail, tool_options, versions  # noqa: E402

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
# Where GOOD is changed, to what, and the JSON path that the error names. The first are found by the schema.
BY_SCHEMA = [
    (("scenes",), REMOVE, "$"),
    (("scene",), {}, "$.scene"),
    (("scenes", "tent", "inputs"), [], "$.scenes.tent.inputs"),
    (("scenes", "tent", "inputs", 0), 3, "$.scenes.tent.inputs[0]"),
    (("scenes", "2nd"), {"inputs": ["tent.obj"]}, "$.scenes.2nd"),
    (("atlases", "tent", "structure"), "bvh", "$.atlases.tent.structure"),
    (("atlases", "tent", "options"), [{"files": "x"}], "$.atlases.tent.options[0]"),
    (("renders",), {}, "$.renders"),
    (("renders", "around", "frames"), [1], "$.renders.around.frames"),
    (("renders", "around", "frames", 1), "2", "$.renders.around.frames[1]"),
    (("renders", "around", "shards"), 0, "$.renders.around.shards"),
    (("renders", "around", "resources", "gpus"), 2, "$.renders.around.resources.gpus"),
    (("renders", "around", "passes", 0), "", "$.renders.around.passes[0]"),
    (("comparisons", "same", "limits"), {"rmse": 1}, "$.comparisons.same.limits.rmse"),
    (("comparisons", "same", "limits", "max-foo"), 1, "$.comparisons.same.limits.max-foo"),
    (("renders", "around", "frames", 1), 2**32, "$.renders.around.frames[1]"),
    (("comparisons", "same", "limits", "max-rmse"), None, "$.comparisons.same.limits.max-rmse"),
    (("resources", "import", "cores"), 1.5, "$.resources.import.cores"),
]
BY_PLAN = [
    (("atlases", "tent", "scene"), "tents", "$.atlases.tent.scene"),
    (("scenes", "tent", "inputs", 0), "none.obj", "$.scenes.tent.inputs[0]"),
    (("renders", "around", "frames"), [2, 1], "$.renders.around.frames"),
    (("renders", "around", "framesPerStep"), 2, "$.renders.around.framesPerStep"),
    (("renders", "whole", "shardBy"), "samples", "$.renders.whole.shardBy"),
    (("renders", "whole", "frames"), REMOVE, "$.renders.whole"),
    (("renders", "whole", "cameraPath"), REMOVE, "$.renders.whole.frames"),
    (("comparisons", "same", "against"), "still", "$.comparisons.same.against"),
    (("comparisons", "same", "golden"), "g.%04d.exr", "$.comparisons.same"),
    (("comparisons", "same", "render"), "none", "$.comparisons.same.render"),
    (("comparisons", "same", "against"), "around", "$.comparisons.same.against"),
    (("renders", "around", "frames"), [1, 999999999], "$.renders.around"),
    (("renders", "whole"), LOOK | {"cameraPath": "path.json", "frames": [1, 999999999], "framesPerStep": 999999999}, "$.renders.whole"),
    (("renders", "still", "shards"), 999999999, "$.renders.still"),
    (("renders", "still", "shards"), 3, "$.renders.still.shards"),
    (("renders", "still"), LOOK | {"shards": 2, "options": ["--crop", "0,31,4,32"]}, "$.renders.still.shards"),
    (("renders", "around", "shardBy"), "samples", "$.renders.around.shards"),
    (("renders", "still"), LOOK | {"shards": 5, "shardBy": "samples", "options": ["--spp=4"]}, "$.renders.still.shards"),
    (("renders", "still"), LOOK | {"shards": 2, "shardBy": "samples", "options": ["--spp=4", "--target-error", "1"]},
     "$.renders.still.shardBy"),
]
REFUSED = {
    ("scenes", "tent"): ["-o", "-o../x.rtmesh", "-vo../x.rtmesh", "--output=../x.rtmesh", "--json", "--depfile", "--if-changed", "-j2",
                         "--threads", "--list-formats", "--"],
    ("atlases", "tent"): ["--quality", "--structure=cloud", "--vdb", "--dry-run", "--output"],
    ("renders", "still"): ["--shard", "--shard=1/2", "--frames", "--size", "--device", "--aov", "--checkpoint", "--tonemap", "-o"],
    ("comparisons", "same"): ["-o", "--html", "--junit", "--json"],
}  # fmt: skip


CACHE = tempfile.TemporaryDirectory()  # of all tests here, so that rt-trace compiles its shaders once


def changed(place, value):
    return changed_document(GOOD, place, value)


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
        end = time.monotonic() + 20
        while not condition():
            self.assertLess(time.monotonic(), end)
            time.sleep(0.02)

    def stand_in(self, script):
        """All tools do this instead; $out is what follows the first -o."""
        head = "#!/bin/sh\n[ \"$1\" != --version ] || exit 0\nout=; previous=; for word; do [ \"$previous\" != -o ] || out=${out:-$word}; previous=$word; done\n"
        (self.folder / "tools").mkdir()
        for tool in ("rt-import", "rt-grid", "rt-trace", "rt-compare"):
            self.write(f"tools/{tool}", head + script, 0o755)
        self.environment["RT_TOOLS_DIR"] = str(self.folder / "tools")


class DescriptionTest(PlanTest):
    def test_errors_name_the_json_path(self):
        for place, value, path in BY_SCHEMA + BY_PLAN:
            with self.subTest(path=path, value=value):
                self.describe(changed(place, value))
                with self.assertRaisesRegex(errors.PlanError, rf"^\S+/tent\.plan\.json: {re.escape(path)}: .+$"):
                    description.read_description(self.folder / "tent.plan.json")
        self.assertRegex(self.call("run", "tent.plan.json", expect=4), rf"^plan: error: tent\.plan\.json: {re.escape(path)}: .+\n$")
        self.assertFalse((self.folder / "tent").exists())

    def test_what_plan_decides_is_no_option(self):
        for place, words in REFUSED.items():
            for word in words:
                with self.subTest(place=place, word=word):
                    self.describe(changed((*place, "options"), ["--stats", word, "../x"]))
                    with self.assertRaisesRegex(errors.PlanError, rf": \$\.{'.'.join(place)}\.options\[1\]: -"):
                        description.read_description(self.folder / "tent.plan.json")
        self.describe(changed(("renders", "around", "pngOptions"), ["--exposure", "-1", "--output=../x.png"]))
        self.assertIn("$.renders.around.pngOptions[2]: --output", self.call("tent.plan.json", expect=4))
        self.describe(changed(("renders", "still", "options"), ["-v", "--eye", "-1,2,3", "--look-at", "-.5,0,0"]))
        self.call("tent.plan.json")

    def test_options_that_are_refused_are_those_of_the_tools(self):
        tools = {"scenes": "rt-import", "atlases": "rt-grid", "renders": "rt-trace", "comparisons": "rt-compare"}
        for kind, tool in tools.items():
            said = subprocess.run([TOOLS / tool, "--help"], capture_output=True, text=True, check=True).stdout
            known = set(re.findall(r"(?<![\w-])--?[a-z][a-z-]*", " ".join(re.findall(r"^  (-\S+)", said, re.MULTILINE)).replace(",", " ")))
            self.assertLessEqual((tool_options.OF_ALL | tool_options.DECIDED[kind]).keys() - {"--"}, known)

    def test_schema_is_checked_as_jsonschema_does(self):
        schema = json.loads((ROOT / "pipelines/plan.schema.json").read_text())
        jsonschema.Draft202012Validator.check_schema(schema)
        validator = jsonschema.Draft202012Validator(schema)
        self.assertTrue(validator.is_valid(GOOD), list(validator.iter_errors(GOOD)))
        for place, value, _ in BY_SCHEMA:
            self.assertFalse(validator.is_valid(changed(place, value)), place)
        for place, value, _ in BY_PLAN:
            self.assertTrue(validator.is_valid(changed(place, value)), place)

    def test_limits_are_those_of_rt_compare(self):
        said = subprocess.run([TOOLS / "rt-compare", "--help"], capture_output=True, text=True, check=True).stdout
        known = re.findall(r"^  --(\S+) \[NAME=\]X", said, re.MULTILINE)
        comparisons = json.loads((ROOT / "pipelines/plan.schema.json").read_text())["$defs"]["comparisons"]
        limits = comparisons["additionalProperties"]["properties"]["limits"]
        self.assertEqual(limits["propertyNames"]["enum"], known)

    def test_shards_that_rt_trace_takes_are_good(self):
        for render in ({"shards": 2}, {"shards": 2, "options": ["--crop=0,31,4,33"]},
                       {"shards": 4, "shardBy": "samples", "options": ["--spp", "4"]}):  # fmt: skip
            self.describe(changed(("renders", "still"), LOOK | render))
            self.call("tent.plan.json")

    def test_files_that_are_no_json(self):
        self.assertIn("cannot be read", self.call("tent.plan.json", expect=3))
        for text in ('{"scenes": {', '{"scenes": {}, "scenes": {}}', "[" * 100000, '{"a\\nb": 1}', '{"scenes": ["\\ud800"]}'):
            self.write("tent.plan.json", text)
            self.assertRegex(self.call("tent.plan.json", expect=4), r"^plan: error: tent\.plan\.json: .*\n$")
        self.write("a\nb.plan.json", json.dumps(GOOD))
        self.assertRegex(self.call("a\nb.plan.json", expect=4), r"^plan: error: '.*a\\nb': has a control character.*\n$")

    def test_the_example_is_good(self):
        example = ROOT / "pipelines/turntable/turntable.plan.json"
        self.assertIn("merge-around-0012", self.call(example, "--dry-run"))


class StepsTest(PlanTest):
    def test_dry_run_prints_the_graph_and_writes_nothing(self):
        self.describe()
        graph = json.loads(self.call("tent.plan.json", "--dry-run", "--json"))
        steps = {step["id"]: step for step in graph["steps"]}
        shard = steps["trace-around-0002-1of2"]
        self.assertEqual(shard["dependsOn"], ["grid-tent"])
        self.assertEqual(shard["outputs"], ["around/around.0002.part1of2.exr"])
        self.assertIn("--frames 2-2 -o around/around.%04d.part1of2.exr --shard 1/2", " ".join(shard["argv"]))
        self.assertEqual(shard["resources"], {"gpus": 1, "cores": 1, "memory": 4096, "minutes": 2})
        self.assertEqual(steps["merge-around-0001"]["dependsOn"], ["trace-around-0001-1of2", "trace-around-0001-2of2"])
        self.assertEqual(steps["compare-same-0002"]["dependsOn"], ["merge-around-0002", "trace-whole-0001"])
        self.assertIn("trace-whole-0001: 1 gpu, 1 cores", self.call("tent.plan.json"))
        self.assertFalse((self.folder / "tent").exists())

    def test_version_and_help_are_those_of_the_tools(self):
        version = subprocess.run([TOOLS / "rt-grid", "--version"], capture_output=True, text=True, check=True).stdout.split()[1]
        self.assertEqual(self.call("--version"), f"plan {version}\n")
        for command in ("run", "step", "status", "report", "update-goldens"):
            self.assertRegex(self.call(command, "--help"), rf"^[A-Z].*\nUsage: plan {command} \[OPTIONS\] (FILE|DIR)")
        self.assertRegex(self.call("run", expect=2), r"^plan: error: .* required: FILE; see plan run --help\n$")

    def test_runs_without_a_name_or_a_folder_are_refused(self):
        self.describe()
        for name, said in ((".plan.json", "rename it"), ("tent", "is no folder; name one")):
            self.write(name, json.dumps(GOOD))
            self.assertIn(said, self.call("run", name, expect=2 if name.startswith(".") else 3))

    def test_printing_and_exporting_do_not_go_together(self):
        self.describe()
        for printing, target in (("--json", "--ninja"), ("--dry-run", "--make"), ("--json", "--slurm"), ("--dry-run", "--openjd")):
            self.assertIn(f"plan: error: {printing} prints", self.call("tent.plan.json", printing, target, "x", expect=2))
            self.assertFalse((self.folder / "x").exists())

    def test_a_reader_that_goes_away_is_named(self):
        self.describe()
        reading, writing = os.pipe()
        os.close(reading)
        result = subprocess.run([sys.executable, PLAN, "tent.plan.json"], cwd=self.folder, env=self.environment, stdout=writing, stderr=subprocess.PIPE)
        os.close(writing)
        self.assertEqual((result.returncode, result.stderr), (3, b"plan: error: standard output: its reader has closed it\n"))

    def test_exports_are_the_same_bytes_again(self):
        self.describe()
        words = ["tent.plan.json", "--ninja", "n", "--make", "m", "--openjd", "o", "--slurm", "s"]
        self.call(*words)
        files = ["n", "m", "o", "tent/plan.json", *(f"s/{path.name}" for path in (self.folder / "s").iterdir())]
        before = {name: (self.folder / name).read_bytes() for name in files}
        times = {name: (self.folder / name).stat().st_mtime_ns for name in files}
        self.call(*words)
        self.assertEqual(before, {name: (self.folder / name).read_bytes() for name in files})
        self.assertEqual(times, {name: (self.folder / name).stat().st_mtime_ns for name in files})
        self.assertEqual(subprocess.run(["sh", "-n", self.folder / "s/submit.sh"]).returncode, 0)

    def template(self, file="o.json"):
        self.describe()
        self.call("tent.plan.json", "--openjd", file)
        return json.loads((self.folder / file).read_text())

    def test_openjd_template_is_what_the_specification_says(self):
        """Of the template schemas 2023-09, all that applies: keys, types, lengths, counts, names that must lead somewhere."""
        template = self.template()
        self.assertEqual(template["specificationVersion"], "jobtemplate-2023-09")
        self.assertEqual(set(template), {"specificationVersion", "name", "parameterDefinitions", "steps"})
        self.assertTrue(0 < len(template["name"]) <= 128)
        (parameter,) = template["parameterDefinitions"]
        self.assertEqual(set(parameter), {"name", "type", "objectType", "dataFlow", "default", "description"})
        self.assertEqual((parameter["type"], parameter["objectType"], parameter["dataFlow"]), ("PATH", "DIRECTORY", "INOUT"))
        self.assertTrue(0 < len(parameter["description"]) <= 2048)
        names = [step["name"] for step in template["steps"]]
        self.assertEqual(len(names), len(set(names)))
        for i, step in enumerate(template["steps"]):
            self.assertLessEqual(len(step["name"]), 64)
            self.assertLessEqual(set(step), {"name", "dependencies", "hostRequirements", "parameterSpace", "script"})
            self.check_dependencies(step.get("dependencies"), names[:i])
            self.assertEqual(set(step["hostRequirements"]), {"amounts"})
            amounts = {amount["name"]: amount["min"] for amount in step["hostRequirements"]["amounts"]}
            self.assertEqual(len(amounts), len(step["hostRequirements"]["amounts"]))
            self.assertLessEqual(set(amounts), {"amount.worker.vcpu", "amount.worker.memory", "amount.worker.gpu"})
            self.assertGreaterEqual(min(amounts.values()), 1)
            self.assertEqual((set(step["parameterSpace"]), set(step["script"]), set(step["script"]["actions"])),
                             ({"taskParameterDefinitions"}, {"actions"}, {"onRun"}))  # fmt: skip
            (parameter,) = step["parameterSpace"]["taskParameterDefinitions"]
            self.assertEqual((set(parameter), parameter["name"], parameter["type"]), ({"name", "type", "range"}, "Step", "STRING"))
            self.assertTrue(0 < len(parameter["range"]) <= 1024)
            self.assertTrue(all(0 < len(value) <= 1024 and "{{" not in value for value in parameter["range"]))
            self.check_action(step["script"]["actions"]["onRun"])

    def check_dependencies(self, dependencies, before):
        if dependencies is None:
            return
        names = [dependency["dependsOn"] for dependency in dependencies]
        self.assertTrue(names and all(set(dependency) == {"dependsOn"} for dependency in dependencies))
        self.assertEqual(len(names), len(set(names)))
        self.assertLessEqual(set(names), set(before))

    def check_action(self, action):
        self.assertEqual(set(action), {"command", "args", "timeout", "cancelation"})
        self.assertIsInstance(action["timeout"], int)
        self.assertGreater(action["timeout"], 0)
        self.assertEqual(set(action["cancelation"]), {"mode", "notifyPeriodInSeconds"})
        self.assertEqual(action["cancelation"]["mode"], "NOTIFY_THEN_TERMINATE")
        self.assertTrue(0 < action["cancelation"]["notifyPeriodInSeconds"] <= 600)
        used = re.findall(r"{{(.*?)}}", " ".join([action["command"], *action["args"]]))
        self.assertEqual(used, ["Param.Folder", "Task.Param.Step"])
        self.assertFalse(any(unicodedata.category(c) == "Cc" for word in (action["command"], *action["args"]) for c in word))

    def test_openjd_default_folder_counts_from_the_template_and_stays_in_its_folder(self):
        self.assertEqual(self.template()["parameterDefinitions"][0]["default"], "tent")
        (self.folder / "jobs").mkdir()
        parameter = self.template("jobs/o.json")["parameterDefinitions"][0]
        self.assertNotIn("default", parameter)
        self.assertIn(str(self.folder / "tent"), parameter["description"])

    def test_openjd_names_that_it_cannot_hold_are_refused(self):
        for name in ("a{{b", "n" * 129):
            self.write(f"{name}.plan.json", json.dumps(GOOD))
            self.assertIn("Open Job Description", self.call(f"{name}.plan.json", "-o", "x", "--openjd", "o.json", expect=4))

    def test_names_that_differ_little_stay_apart(self):
        """In shell variables, and in steps: turn-0001 is frame 1 of turn, or a still."""
        document = copy.deepcopy(GOOD)
        document["atlases"] |= {"a-b": {"scene": "tent"}, "a_b": {"scene": "tent"}}
        document["renders"] |= {name: LOOK | {"atlas": name} for name in ("a-b", "a_b")}
        self.describe(document)
        self.call("tent.plan.json", "--slurm", "s")
        text = (self.folder / "s/submit.sh").read_text()
        jobs = {name: (job, after) for job, after, name in
                re.findall(r"^(job_\d+)=\$\(sbatch .*--parsable (?:--dependency=afterok:(\S+) )?\S*/(\S+)\.sbatch\)$", text, re.MULTILINE)}  # fmt: skip
        self.assertEqual(len({job for job, _ in jobs.values()}), 1 + 3 + 5 + 1 + 1)
        for name in ("a-b", "a_b"):
            self.assertEqual(jobs[f"trace-{name}"][1], f"${{{jobs[f'grid-{name}'][0]}}}")
        document["renders"]["around-0002"] = LOOK | {"shards": 2}
        self.describe(document)
        self.assertRegex(self.call("tent.plan.json", expect=4), r"^plan: error: tent\.plan\.json: two steps .* trace-around-0002-1of2")

    def test_a_step_of_a_plan_that_changed_is_refused(self):
        self.describe()
        self.call("tent.plan.json", "--ninja", "n")
        self.assertIn("export again", self.call("step", "tent", "grid-tent@00000000", expect=2))
        self.assertIn("export again", self.call("step", "tent", "none", expect=2))
        self.assertIn("--retries: '-1' is no whole number from 0 on", self.call("step", "tent", "grid-tent", "--retries=-1", expect=2))

    def test_submitting_that_is_ended_takes_all_back(self):
        self.describe()
        self.call("tent.plan.json", "--slurm", "s")
        self.write("sbatch", "#!/bin/sh\nif [ -e one ]; then touch two; exec sleep 60; fi\ntouch one; echo 7\n", 0o755)
        self.write("scancel", "#!/bin/sh\necho $* >>cancelled\n", 0o755)
        environment = self.environment | {"PATH": f"{self.folder}:{self.environment['PATH']}"}
        for number in (signal.SIGINT, signal.SIGTERM):
            submit = subprocess.Popen(["sh", "s/submit.sh"], cwd=self.folder, env=environment, start_new_session=True, stderr=subprocess.DEVNULL)
            self.wait_for((self.folder / "tent/two").exists)
            os.killpg(submit.pid, number)
            self.assertEqual(submit.wait(timeout=20), 128 + number)
            self.assertEqual((self.folder / "tent/cancelled").read_text(), "7\n")
            self.assertEqual(list((self.folder / "tent").glob("slurm-jobs*")), [])
            for name in ("one", "two", "cancelled"):
                (self.folder / "tent" / name).unlink()


    def test_jobs_are_not_handed_in_beside_those_of_the_same_run(self):
        self.describe()
        self.call_here("tent.plan.json", "--slurm", "s")
        self.write("sbatch", "#!/bin/sh\necho 12\n", 0o755)
        self.write("tent/slurm-jobs.tsv", "6\tx.tasks\n7\ty.tasks\n")
        environment = self.environment | {"PATH": f"{self.folder}:{self.environment['PATH']}"}
        for queued, code, said in (("7", 3, "s/submit.sh: error: .* of this run; .*: scancel 6 7\n"), ("77", 0, "")):
            self.write("squeue", f"#!/bin/sh\necho 5; echo {queued}\n", 0o755)
            submit = subprocess.run(["sh", "s/submit.sh"], cwd=self.folder, env=environment, capture_output=True, text=True)
            self.assertEqual(submit.returncode, code, submit.stderr)
            self.assertRegex(submit.stderr, f"^{said}$")
            self.assertEqual((self.folder / "tent/slurm-jobs.tsv").read_text().startswith("12\t"), code == 0)


class RunTest(PlanTest):
    def test_steps_overlap_on_two_devices_and_never_on_one(self):
        self.describe()
        self.stand_in('echo "$RT_DEVICE" >"$(printf "${out:-x}" 1).device"; sleep 0.2; mkdir -p around whole still same\n'
                      'for f in tent.rtmesh tent.rtatlas still/still.exr still/still.png; do : >$f; done\n'
                      'for n in 0001 0002; do for e in html json; do : >same/same.$n.$e; done; done\n'
                      'for n in 0001 0002; do for k in around whole; do for e in exr png part1of2.exr part2of2.exr; do '
                      ': >$k/$k.$n.$e; done; done; done\n')  # fmt: skip
        self.call("run", "tent.plan.json", "-j", "6")
        spans = {}
        for step in self.states().values():
            for attempt in step["attempts"]:
                if step["id"].startswith("trace"):
                    spans.setdefault(attempt["slot"], []).append((attempt["start"], attempt["end"]))
        self.assertEqual(set(spans), {"software#1", "software#2"})
        for slot in spans.values():
            slot.sort()
            self.assertTrue(all(a[1] <= b[0] for a, b in zip(slot, slot[1:])), slot)
        one, two = spans["software#1"], spans["software#2"]
        self.assertTrue(any(a[0] < b[1] and b[0] < a[1] for a in one for b in two), spans)
        devices = {path.read_text() for path in (self.folder / "tent").rglob("*part*.device")}
        self.assertEqual(devices, {"software\n"})

    def test_software_and_hardware_make_different_pictures(self):
        """As rt-trace has it: auto may be any device but the one that is asked for as software."""
        self.describe_still()
        self.stand_in("case $0 in *import) [ -e tent.rtmesh ] || : >tent.rtmesh ;; *grid) : >tent.rtatlas ;; "
                      "*trace) echo $RT_DEVICE >still/still.exr; : >still/still.png ;; esac\n")  # fmt: skip
        rows = (("RT_DEVICES", "software"), ("RT_DEVICES", "cuda:0,software"), ("RT_DEVICES", "cuda:0"), ("RT_DEVICES", "cuda:1"), ("RT_DEVICE", "0"),
                ("RT_DEVICE", "software"))  # fmt: skip
        for (variable, devices), made in zip(rows, ("software", "software", "cuda:0", "cuda:0", "cuda:0", "software")):
            for name in ("RT_DEVICE", "RT_DEVICES"):
                self.environment.pop(name, None)
            self.environment[variable] = devices
            self.call("run", "tent.plan.json")
            self.assertEqual((self.folder / "tent/still/still.exr").read_text(), made + "\n", devices)

    def test_tools_that_use_all_cores_run_one_at_a_time(self):
        """Those of frames wait for a device each, and not for cores."""
        scenes = {name: {"inputs": ["tent.obj"], "resources": {"cores": 2}} for name in "abc"} | {name: {"inputs": ["tent.obj"]} for name in "de"}
        document = GOOD | {"scenes": scenes, "atlases": {"tent": {"scene": "a"}}, "renders": {"s1": LOOK, "s2": LOOK}, "comparisons": {}}
        made = graph.build_graph(document | {"resources": {}}, "t", self.folder, self.folder)
        with unittest.mock.patch.object(os, "sched_getaffinity", lambda _: range(4)), unittest.mock.patch.dict(os.environ, self.environment):
            scheduler = run_here.Scheduler(made, self.folder, {step.argv[0]: "" for step in made.steps}, files.Running(), None)
        batches = []
        while scheduler.ended < len(made.steps):
            batch = list(iter(scheduler.start_next, None))
            batches.append(" ".join(sorted(step.id for step in batch)))
            for step in batch:
                scheduler.free.update(scheduler.needs(step))
                scheduler.release(step)
        self.assertEqual(batches, ["import-a import-b", "import-c", "import-d", "import-e", "grid-tent", "trace-s1 trace-s2"])

    def test_failures_are_retried_so_often_and_no_more(self):
        self.export_with("")
        for code, attempts in ((6, 3), (4, 1)):
            with self.subTest(code=code):
                self.write("tools/rt-import", f"#!/bin/sh\necho 'rt-import: error: no \33luck' >&2\nexit {code}\n", 0o755)
                said = self.call("step", "tent", "import-tent", "--retries", "2", expect=code)
                states = self.states(expect=1)
                self.assertRegex(said, r"^plan: error: import-tent: rt-import: error: no \ufffdluck  \[\S*tent/logs/import-tent.log\]\n$")
                self.assertEqual(len(states["import-tent"]["attempts"]), attempts)
                self.assertEqual((states["import-tent"]["state"], states["import-tent"]["why"]), ("failed", "rt-import: error: no \ufffdluck"))
                self.assertEqual((states["grid-tent"]["state"], states["grid-tent"]["why"]), ("blocked", "import-tent failed"))
                self.assertEqual((self.folder / "tent/logs/import-tent.log").read_text().count("no \33luck"), attempts)

    def test_a_tool_that_writes_nothing_has_failed_and_one_that_is_up_to_date_is_skipped(self):
        self.export_with("")
        (self.folder / "tent/steps").mkdir()
        self.write("tent/steps/import-tent.json.tmp", "of a run that was killed")
        self.call("step", "tent", "import-tent", expect=70)
        self.assertEqual(list((self.folder / "tent").rglob("*.tmp*")), [])
        self.assertIn("did not write tent.rtmesh", self.states(expect=1)["import-tent"]["why"])
        self.write("tools/rt-import", "#!/bin/sh\n[ -e tent.rtmesh ] || : >tent.rtmesh\n", 0o755)
        for state in (("done", ""), ("skipped", "up to date")):
            self.call("step", "tent", "import-tent")
            found = self.states(expect=10)["import-tent"]
            self.assertEqual((found["state"], found["why"]), state)

    def test_a_step_that_ends_while_status_reads_was_not_cut_off(self):
        self.export_with(": >tent.rtmesh\n")
        self.call("step", "tent", "import-tent")
        record = self.folder / "tent/steps/import-tent.json"
        done = record.read_text()
        record.write_text(done.replace('"state": "done"', '"state": "running"'))

        def ends(*_):
            record.write_text(done)
            return False

        with unittest.mock.patch.object(status, "is_running", ends):
            found = status.run_status(graph.load_graph(self.folder / "tent"), self.folder / "tent")[0]
        self.assertEqual((found.state, found.why), ("done", ""))

    def test_a_step_whose_output_is_gone_is_not_done(self):
        self.export_with(": >tent.rtmesh\n")
        self.call("step", "tent", "import-tent")
        (self.folder / "tent/tent.rtmesh").unlink()
        state = self.states(expect=10)["import-tent"]
        self.assertEqual((state["state"], state["why"]), ("waiting", "tent.rtmesh is gone"))
        self.write("tent/slurm-jobs.tsv", "")
        self.write("squeue", "#!/bin/sh\n", 0o755)
        self.environment["PATH"] = f"{self.folder}:{self.environment['PATH']}"
        state = self.states(expect=1)["import-tent"]
        self.assertEqual(state["state"], "blocked")
        self.assertRegex(self.call("status", "tent", expect=1), r"\nnext: run the pipeline again: .*\n$")
        self.write("tent/slurm-jobs.tsv", "7\ttasks\n")
        self.write("tent/tasks", "import-tent@12345678\n")
        for reason in ("launch failed requeued held", "JobHeldUser"):
            self.write("squeue", f"#!/bin/sh\necho '7_1|PENDING|{reason}'\n", 0o755)
            said = self.call("status", "tent", expect=1)
            self.assertRegex(said, rf"waiting +import-tent +Slurm job 7_1 PENDING \({reason}\)\n")
            self.assertRegex(said, r"\nnext: Slurm holds 1 steps: scontrol update .*, then scontrol release 7_1\n$")
        self.write("tent/slurm-jobs.tsv", "7 tasks\n")
        self.assertRegex(self.call("status", "tent", expect=4), r"^plan: error: tent/slurm-jobs.tsv: \"7 tasks\" is none .*\n$")
        self.assertIn("is not the folder of a run", self.call("status", "devices", expect=3))

    def test_a_failure_costs_all_arrays_that_waited_for_its_group(self):
        self.describe()
        self.call_here("tent.plan.json", "--ninja", "n")
        folder, made = self.folder / "tent", graph.load_graph(self.folder / "tent")
        ended = {"start": 1.0, "end": 2.0, "host": "a", "slot": "", "exitCode": 4, "why": "no luck"}
        (folder / "around").mkdir()
        for step in made.steps:
            if step.stage in ("import", "grid") or step.group == "trace-around":
                (folder / step.outputs[0]).touch()
                run_step.save_record(folder, step, "failed" if step.id == "trace-around-0002-1of2" else "done", [ended])
        statuses = {s.step.id: s for s in status.run_status(made, folder, {"trace-whole-0001": ("7_1", "PENDING", "Resources")})}
        self.assertEqual(statuses["merge-around-0001"].why, "trace-around-0002-1of2 failed, and Slurm starts merge-around after all of trace-around only")
        self.assertEqual(statuses["merge-around-0002"].why, "trace-around-0002-1of2 failed")
        self.assertEqual(statuses["compare-same-0001"].why, "merge-around-0001 blocked")
        self.assertEqual(statuses["trace-still"].why, status.LOST)
        merge = next(step for step in made.steps if step.id == "merge-around-0001")
        (folder / merge.outputs[0]).touch()
        (folder / merge.outputs[1]).touch()
        run_step.save_record(folder, merge, "done", [ended])  # by an earlier run
        why = status.run_status(made, folder, {"trace-whole-0001": ("7_1", "PENDING", "Resources")})[-2].why
        self.assertEqual(why, "merge-around-0002 blocked, and Slurm starts compare-same after all of merge-around only")
        text = status.as_text(made, folder, statuses.values())
        self.assertRegex(text, r"\nnext: see the logs of what failed, mend it, and when the rest has ended, run the pipeline again")

    def test_what_to_do_depends_on_what_is_at_work(self):
        self.describe_still()
        self.call_here("tent.plan.json", "--ninja", "n")
        folder, made = self.folder / "tent", graph.load_graph(self.folder / "tent")
        said = lambda queue: status.as_text(made, folder, status.run_status(made, folder, queue)).splitlines()[-1]  # noqa: E731
        all_of = lambda *said_of_all: {step.id: said_of_all for step in made.steps}  # noqa: E731
        self.assertRegex(said(None), "next: if no engine is at work, run the pipeline again")
        with run_here.run_lock(folder):
            self.assertEqual(said(None), "tent: 3 steps: 3 waiting")
        self.assertEqual(said(all_of("7_1", "PENDING", "Dependency")), "next: wait for Slurm, which has 3 steps in its queue")
        self.assertEqual(said(all_of("7_1", "PENDING", "PartitionConfig")), "next: wait for Slurm, which has 3 steps in its queue (PartitionConfig)")
        self.assertRegex(said({}), "next: run the pipeline again")

    def test_records_tell_the_status_where_slurm_is_silent(self):
        self.describe_still()
        self.stand_in("mkdir -p still; touch tent.rtmesh tent.rtatlas still/still.exr still/still.png\n")
        self.call_here("run", "tent.plan.json")
        self.write("tent/slurm-jobs.tsv", "")
        self.write("squeue", "#!/bin/sh\necho 'no controller' >&2; exit 1\n", 0o755)
        self.environment["PATH"] = f"{self.folder}:{self.environment['PATH']}"
        warning = r'plan: warning: Slurm does not say what is queued: squeue: "no controller"; try again\n'
        self.assertRegex(self.call_here("status", "tent"), rf"^tent: 3 steps: 3 done\n{warning}$")
        self.assertRegex(self.call_here("report", "tent", "--junit", "junit.xml"), f"^{warning}$")
        record = self.folder / "tent/steps/trace-still.json"
        record.write_text(record.read_text().replace('"done"', '"running"'))  # cut off, and perhaps in the queue again
        said = self.call_here("status", "tent", expect=10)
        self.assertRegex(said, r"^waiting +trace-still +Slurm does not say whether .*\n.*: 2 done, 1 waiting\nnext: ask again where Slurm answers\n")

    def test_slurms_time_limit_is_thought_of(self):
        made = graph.build_graph(GOOD, "t", self.folder, self.folder)
        for job, why in ({}, "ended by SIGTERM"), ({"SLURM_JOB_ID": "7"}, "ended by SIGTERM (Slurm's time limit of 30 min, or scancel?)"):
            with unittest.mock.patch.dict(os.environ, job):
                self.assertEqual(run_step.why_failed(self.folder, made.steps[0], 143, ""), why)

    def test_only_slurm_holds_steps(self):
        """Not what is called so."""
        self.describe(json.loads(json.dumps(GOOD).replace('"tent"', '"held"')))
        self.stand_in("")
        self.call("tent.plan.json", "--ninja", "n")
        self.assertRegex(self.call("status", "tent", expect=10), r"waiting +trace-still +for grid-held\n[^:]+: 12 steps: 12 waiting\nnext: if no engine is at work, run the")

    def test_programs_that_do_not_answer_are_named(self):
        self.stand_in("")
        self.write("tools/squeue", "#!/bin/sh\nexec sleep 60\n", 0o755)
        here = unittest.mock.patch.dict(os.environ, {"PATH": f"{self.folder}/tools:{os.environ['PATH']}"})
        for module, ask in ((slurm_queue, slurm_queue.ask_squeue), (versions, lambda: versions.version_of("squeue"))):
            with here, unittest.mock.patch.object(module, "TIMEOUT_SECONDS", 0.1), self.assertRaisesRegex(errors.PlanError, "squeue.*0.1 s"):
                ask()

    def test_tools_beside_an_installed_plan_are_found(self):
        self.describe_still()
        self.stand_in("mkdir -p still; touch tent.rtmesh tent.rtatlas still/still.exr still/still.png\n")
        (self.folder / "tools/rt-plan").symlink_to(PLAN)
        environment = self.environment | {"PATH": f"{os.path.dirname(sys.executable)}:/usr/bin:/bin"}
        del environment["RT_TOOLS_DIR"]
        said = subprocess.run(["tools/rt-plan", "run", "tent.plan.json"], cwd=self.folder, env=environment, capture_output=True, text=True)
        self.assertIn("3 steps: 3 done", said.stdout, said.stderr)

    def describe_goldens(self):
        comparison = {"gate": {"render": "still", "golden": "golden/still.exr"},
                      "path": {"render": "around", "golden": "golden/%d/around.%04d.exr"}}  # fmt: skip
        renders = {"still": LOOK, "around": LOOK | {"cameraPath": "path.json", "frames": [1, 2]}}
        self.describe({"scenes": GOOD["scenes"], "atlases": GOOD["atlases"], "renders": renders, "comparisons": comparison})

    def stand_in_of_goldens(self):
        """Pictures of their own names, compared to the bit."""
        self.stand_in("""case $0 in
            *rt-import) [ -e tent.rtmesh ] || : >tent.rtmesh ;;
            *rt-grid) : >tent.rtatlas ;;
            *rt-trace) frame=${*#*--frames }; out=$(printf "${out%.exr}" ${frame%%-*}); echo $out >$out.exr; : >$out.png ;;
            *rt-compare) cmp $1 $2 || exit 1; for word; do case $word in *.html|*.json) : >$word ;; esac; done ;;
            esac\n""")

    def test_goldens_are_made_of_a_finished_run(self):
        self.describe_goldens()
        said = self.call("run", "tent.plan.json", expect=1)
        self.assertRegex(said, "failed +compare-gate +there is no golden ../golden/still.exr: look at still/still.exr, .* update-goldens")
        said = self.call("update-goldens", "tent")
        self.assertEqual(re.findall(r": (.*)$", said, re.MULTILINE), ["new"] * 3)
        self.assertEqual((self.folder / "golden/2/around.0002.exr").read_bytes(), (self.folder / "tent/around/around.0002.exr").read_bytes())
        self.assertEqual(self.run_again(), "import-tent compare-gate compare-path-0001 compare-path-0002")
        (self.folder / "golden/still.exr").write_bytes(b"no picture")
        self.assertIn("compare-gate", self.call("run", "tent.plan.json", expect=1))
        self.assertFalse((self.folder / "tent/gate/gate.passed").exists())
        said = self.call("update-goldens", "tent")
        self.assertEqual(re.findall(r": (.*)$", said, re.MULTILINE), ["replaced", "the same", "the same"])
        self.call("run", "tent.plan.json")

    def test_goldens_are_replaced_all_or_none(self):
        self.describe_goldens()
        self.stand_in_of_goldens()
        self.call("tent.plan.json", "--ninja", "n")
        self.assertIn("trace-still has not made it", self.call("update-goldens", "tent", expect=3))
        self.call("run", "tent.plan.json", expect=1)
        (self.folder / "golden").mkdir()
        self.write("golden/2", "where a folder should be")
        self.write("golden/still.exr", "old")
        self.assertRegex(self.call("update-goldens", "tent", expect=3), "^plan: error: .*golden/2.*\n$")
        self.assertEqual([path.name for path in (self.folder / "golden").rglob("*.*")], ["still.exr"])
        (self.folder / "golden/2").unlink()
        picture = self.folder / "tent/around/around.0002.exr"
        picture.write_bytes(picture.read_bytes()[:-1])
        self.assertIn("around.0002.exr: trace-around-0002 has not made it, or it changed", self.call("update-goldens", "tent", expect=3))
        self.assertEqual((self.folder / "golden/still.exr").read_text(), "old")
        self.call("run", "tent.plan.json", expect=1)
        self.call("update-goldens", "tent")
        self.call("run", "tent.plan.json")

    def test_goldens_are_replaced_all_or_none_when_interrupted(self):
        """A signal before the first is replaced, and one after."""
        pairs = [(self.folder / f"picture{i}.exr", self.folder / f"golden/{i}.exr") for i in (1, 2)]
        (self.folder / "golden").mkdir()
        for picture, golden in pairs:
            picture.write_text("new")
            golden.write_text("old")
        for function, content in (("fsync", "old"), ("replace", "new")):
            whole = getattr(os, function)
            with unittest.mock.patch.object(os, function, lambda *words: (os.kill(os.getpid(), signal.SIGINT), whole(*words))):
                with contextlib.suppress(errors.PlanError):
                    goldens.replace_all(pairs)
            self.assertEqual([path.read_text() for path in (self.folder / "golden").iterdir()], [content, content])

    def test_goldens_that_a_render_makes_itself_are_refused(self):
        (self.folder / "link").symlink_to("tent")
        parts = {"around": GOOD["renders"]["around"], "still": LOOK, "other": LOOK}
        for render, golden in (("still", "tent/still/still.exr"), ("still", "link/still/still.exr"), ("around", "tent/around/around.%04d.exr"),
                               ("around", "tent/around/around.%04d.part1of2.exr")):  # fmt: skip
            self.describe(GOOD | {"renders": parts, "comparisons": {"gate": {"render": render, "golden": golden}}})
            said = self.call_here("tent.plan.json", expect=4)
            self.assertRegex(said, rf"^plan: error: tent.plan.json: \$\.comparisons\.gate\.golden: .* is made by '{render}' itself; name another file\n$")
        comparison = {"gate": {"render": "still", "golden": "tent/other/other.exr"}}  # which depends on that render
        made = graph.build_graph(GOOD | {"renders": parts, "comparisons": comparison}, "t", self.folder, self.folder / "tent")
        self.assertEqual(made.steps[-1].depends_on, ["trace-still", "trace-other"])
        self.assertEqual(made.comparisons["gate"][0]["golden"], "")

    def test_goldens_that_cannot_be_made_of_renders_are_refused(self):
        self.describe_goldens()
        self.stand_in_of_goldens()
        for golden, said in (("golden/still.png", "end in .exr"), ("path.json/x.exr", "path.json"), ("golden/1/around.0001.exr", "too; rename one")):
            document = json.loads((self.folder / "tent.plan.json").read_text())
            document["comparisons"]["gate"]["golden"] = golden
            self.write("more.plan.json", json.dumps(document))
            self.call("run", "more.plan.json", "-o", "tent", expect=1)
            self.assertIn(said, self.call("update-goldens", "tent", expect=3 if "path" in golden else 4))
            self.assertFalse((self.folder / "golden").exists())

    def test_tools_elsewhere_are_the_same_tools(self):
        self.describe_still()
        self.call("run", "tent.plan.json")
        (self.folder / "moved").mkdir()
        for tool in ("rt-import", "rt-grid", "rt-trace"):
            (self.folder / "moved" / tool).symlink_to(TOOLS / tool)
        here = self.environment.pop("RT_TOOLS_DIR")
        said = self.call("run", "tent.plan.json", expect=3)
        self.assertRegex(said, r"^plan: error: PATH: there is no rt-grid, rt-import, rt-trace in it; name .* --tools DIR or \$RT_TOOLS_DIR")
        self.call("tent.plan.json", "--ninja", "n")
        for step in ("import-tent", "grid-tent"):  # as an engine would
            self.call("step", "tent", step, expect=127)
        said = self.call("status", "tent", expect=1)
        self.assertRegex(said, r"failed +import-tent +rt-import: error: cannot be run: .*; name the folder of the tools with --tools DIR")
        self.assertIn("next: see the logs", said)
        for folder, again in ((self.folder / "moved", "import-tent grid-tent"), (here, "import-tent")):  # those that failed above
            self.environment["RT_TOOLS_DIR"] = str(folder)
            self.assertEqual(self.run_again(), again)
            self.assertLessEqual({step["state"] for step in self.states().values()}, {"done", "skipped"})
        (self.folder / "moved/rt-grid").unlink()
        self.environment["RT_TOOLS_DIR"] = str(self.folder / "moved")
        self.assertIn("moved: there is no rt-grid in it", self.call("run", "tent.plan.json", expect=3))

    def test_a_step_that_was_cut_off_goes_on_and_is_not_run_twice_at_a_time(self):
        self.export_with("echo x >>starts; while [ -e starts ] && [ ! -e go ]; do sleep 0.02; done; : >tent.rtmesh\n")
        words = [sys.executable, PLAN, "step", "tent", "import-tent"]
        first = subprocess.Popen(words, cwd=self.folder, env=self.environment)
        starts = self.folder / "tent/starts"
        self.wait_for(starts.exists)
        first.kill()  # the tool goes on, and holds the lock
        first.wait()
        second = subprocess.Popen(words, cwd=self.folder, env=self.environment)
        time.sleep(0.3)
        self.assertEqual(starts.read_text(), "x\n")
        self.assertEqual(self.states(expect=10)["import-tent"]["state"], "running")
        (self.folder / "tent/go").touch()
        self.assertEqual(second.wait(timeout=20), 0)
        state = self.states(expect=10)["import-tent"]
        self.assertEqual([attempt["why"] for attempt in state["attempts"]], ["cut off", ""])

    def test_a_run_that_was_killed_goes_on_and_a_second_one_beside_it_is_refused(self):
        self.describe_still()
        self.stand_in("while [ ! -e go ]; do sleep 0.02; done; mkdir -p still; touch tent.rtmesh tent.rtatlas still/still.exr still/still.png\n")
        words = [sys.executable, PLAN, "run", "tent.plan.json"]
        first = subprocess.Popen(words, cwd=self.folder, env=self.environment, stdout=subprocess.DEVNULL)
        self.wait_for((self.folder / "tent/logs/import-tent.log").exists)
        self.write("tent/slurm-jobs.tsv", "")
        self.write("other.plan.json", json.dumps(GOOD))
        before = [(self.folder / "tent" / name).read_text() for name in ("plan.json", "run.json", "slurm-jobs.tsv")]
        for other in (("run", "other.plan.json", "-o", "tent"), ("other.plan.json", "-o", "tent", "--ninja", "n"), ("update-goldens", "tent")):
            self.assertRegex(self.call(*other, expect=3), r"^plan: error: .*/tent: another run of it is at work; wait .*\n$")
        self.assertEqual(before, [(self.folder / "tent" / name).read_text() for name in ("plan.json", "run.json", "slurm-jobs.tsv")])
        (self.folder / "tent/slurm-jobs.tsv").unlink()
        first.kill()  # its tool goes on
        first.wait()
        self.assertEqual(self.states(expect=10)["import-tent"]["state"], "running")
        second = subprocess.Popen(words, cwd=self.folder, env=self.environment, stdout=subprocess.DEVNULL)
        time.sleep(0.3)
        (self.folder / "tent/go").touch()
        self.assertEqual(second.wait(timeout=20), 0)
        states = self.states()
        self.assertEqual({step["state"] for step in states.values()}, {"done"})
        self.assertEqual([attempt["why"] for attempt in states["import-tent"]["attempts"]], ["cut off", ""])

    def test_a_run_that_cannot_write_its_records_says_so(self):
        self.export_with("")
        self.write("tent/steps", "no folder")
        for words in (("run", "tent.plan.json"), ("status", "tent"), ("step", "tent", "import-tent")):
            self.assertRegex(self.call(*words, expect=3), r"^plan: error: \S*tent/steps\S*: .*\n$")

    def test_records_that_are_none_do_not_count(self):
        self.describe_still()
        self.stand_in("mkdir -p still; touch tent.rtmesh tent.rtatlas still/still.exr still/still.png\n")
        self.call("run", "tent.plan.json")
        path = self.folder / "tent/steps/import-tent.json"
        content = json.loads(path.read_text())
        made = graph.load_graph(self.folder / "tent")
        self.assertEqual(status.run_status(made, self.folder / "tent")[0].state, "done")
        wrongs = [{"attempts": 1}, {"attempts": []}, {"attempts": [1]}, {"attempts": [{}]}, {"files": []}, {"state": "?"}]
        values = {"start": ("x", None, -1, 1e999), "end": ("x", None, []), "exitCode": (None, "0"), "host": (1,), "slot": (None,), "why": ([],)}
        wrongs += [{"attempts": [content["attempts"][0] | {key: value}]} for key in values for value in values[key]]
        wrongs += [{"attempts": [content["attempts"][0] | {"end": "x"}, content["attempts"][0]]}]
        wrongs += [{"attempts": [{key: value for key, value in content["attempts"][0].items() if key != left_out}]} for left_out in values]
        for wrong in (b"", b"[]", b"{", b"[" * 100000, b'{"\xff": 1}', *(json.dumps(content | wrong).encode() for wrong in wrongs)):
            path.write_bytes(wrong)
            self.assertEqual(status.run_status(made, self.folder / "tent")[0].state, "waiting", wrong[:99])
        self.assertIn("import-tent", self.run_again())

    def test_own_files_that_are_damaged_are_written_again(self):
        self.describe_still()
        self.stand_in("mkdir -p still; touch tent.rtmesh tent.rtatlas still/still.exr still/still.png\n")
        self.call_here("tent.plan.json", "--ninja", "n")
        ninja = (self.folder / "n").read_text()
        altered = (self.folder / "tent/plan.json").read_bytes().replace(b"trace-still", b"trace-stilt", 1)
        for wrong in (b"\xff", b"[" * 100000, b"[]", b'{"start": "x"}', b'{"start": NaN}', altered):
            (self.folder / "n").write_bytes(wrong)
            self.call_here("tent.plan.json", "--ninja", "n")
            self.assertEqual((self.folder / "n").read_text(), ninja)
            for name in ("plan.json", "run.json"):
                (self.folder / "tent" / name).write_bytes(wrong)
                if name == "plan.json":
                    self.assertRegex(self.call_here("status", "tent", expect=3 if wrong == b"\xff" else 4), r"^plan: error: tent/plan.json: .*\n$")
                    self.assertRegex(self.call_here("step", "tent", "import-tent", expect=3 if wrong == b"\xff" else 4), r"^plan: error: .*\n$")
                else:
                    self.call_here("report", "tent", "-o", "page.html")
                self.call_here("run", "tent.plan.json")
        graph.load_graph(self.folder / "tent")
        self.assertGreater(json.loads((self.folder / "tent/run.json").read_text())["start"], time.time() - 60)

    def test_what_waits_for_a_step_that_fails_is_not_done(self):
        self.describe_still()
        self.stand_in("[ ! -e fails ] || exit 4; mkdir -p still; touch tent.rtmesh tent.rtatlas still/still.exr still/still.png\n")
        self.call_here("run", "tent.plan.json")
        (self.folder / "tent/fails").touch()
        said = self.call_here("run", "tent.plan.json", expect=1)
        self.assertRegex(said, r"blocked +grid-tent +import-tent failed; its outputs are of an earlier run\n")
        self.assertIn("3 steps: 1 failed, 2 blocked\n", said)

    def test_names_and_folders_may_be_odd(self):
        """Spaces, letters, shell's and printf's signs, and a run's folder that is a link to another place."""
        odd = self.folder / "söme ' $x #1 %d b"
        (self.folder / "disk").mkdir()
        odd.mkdir()
        for name in ("tent.obj", "path.json"):
            (self.folder / name).rename(odd / name)
        (odd / "run ü").symlink_to(self.folder / "disk")
        self.folder = odd
        golden = {"gate": {"render": "around", "golden": "gold %d/t %04d.exr"}}
        renders = {"around": GOOD["renders"]["around"]}
        self.describe({key: GOOD[key] for key in ("scenes", "atlases", "resources")} | {"renders": renders, "comparisons": golden})
        said = self.call("run", "tent.plan.json", "-o", "run ü", expect=1)
        self.assertIn("8 done, 2 failed", said)
        self.assertIn("gold 2/t 0002.exr: new", self.call("update-goldens", "run ü"))
        self.call("run", "tent.plan.json", "-o", "run ü")
        self.call("tent.plan.json", "-o", "ni n", "--ninja", "n", "--slurm", "s s")
        for said in ("[10/10]", "no work to do"):
            ninja = subprocess.run(["ninja", "-C", "ni n", "-f", odd / "n"], cwd=odd, env=self.environment, capture_output=True, text=True)
            self.assertEqual(ninja.returncode, 0, ninja.stdout)
            self.assertIn(said, ninja.stdout)
        self.assertEqual((odd / "ni n/around/around.0002.exr").read_bytes(), (odd / "run ü/around/around.0002.exr").read_bytes())
        self.assertIn(f'#SBATCH --output="{odd}/ni n/logs/slurm-tent.merge-around-%a.log"'.replace("%d", "%%d"),
                      (odd / "s s/merge-around.sbatch").read_text())  # fmt: skip
        self.assertEqual(subprocess.run(["sh", "-n", odd / "s s/submit.sh"]).returncode, 0)

    def test_an_interrupted_run_ends_with_one_line_and_leaves_nothing_running(self):
        self.describe()
        self.stand_in("echo $$ >>pids; exec sleep 60\n")
        for number in (signal.SIGINT, signal.SIGTERM):
            pids = self.folder / "tent/pids"
            pids.unlink(missing_ok=True)
            run = subprocess.Popen([sys.executable, PLAN, "run", "tent.plan.json"], cwd=self.folder, env=self.environment,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)  # fmt: skip
            self.wait_for(lambda: pids.exists() and pids.read_text().endswith("\n"))
            run.send_signal(number)
            out, said = run.communicate(timeout=20)
            self.assertEqual(run.returncode, 128 + number, out + said)
            self.assertRegex(said, r"^plan: error: interrupted.*\n$")
            self.assertNotIn("Traceback", out)
            self.assertFalse(any(pathlib.Path("/proc", pid).exists() for pid in pids.read_text().split()))
            self.assertEqual(self.states(expect=1)["import-tent"]["why"], "ended by SIGTERM")

    def test_a_tool_that_does_not_listen_is_killed(self):
        with unittest.mock.patch.object(files, "GRACE_SECONDS", 0.1), files.passed_on() as running:
            process = subprocess.Popen(["sh", "-c", "trap '' TERM; echo; exec sleep 20"], stdout=subprocess.PIPE)
            with process.stdout:
                process.stdout.readline()
                os.kill(os.getpid(), signal.SIGTERM)
                self.assertEqual(running.wait(process), -signal.SIGKILL)


class ChangesTest(PlanTest):
    """Exactly the steps do something that have to, in a chain of real tools."""

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


class ThumbnailTest(unittest.TestCase):
    def test_all_filters_are_undone_and_pixels_averaged(self):
        height, width, channels = 10, 12, 3
        pixels = numpy.random.default_rng(1).integers(0, 256, (height, width, channels))
        rows, above = b"", numpy.zeros((width, channels), int)
        for y, row in enumerate(pixels):
            left, corner = (numpy.vstack([numpy.zeros((1, channels), int), line[:-1]]) for line in (row, above))
            wanted = left + above - corner
            gaps = numpy.stack([abs(wanted - candidate) for candidate in (left, above, corner)])
            nearest = numpy.choose(gaps.argmin(axis=0), [left, above, corner])
            guess = [0 * row, left, above, (left + above) // 2, nearest][y % 5]
            rows += bytes([y % 5]) + ((row - guess) % 256).astype(numpy.uint8).tobytes()
            above = row
        header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
        chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows)[:20]), (b"IDAT", zlib.compress(rows)[20:]), (b"IEND", b""))
        small = thumbnail.thumbnail(thumbnail.SIGNATURE + b"".join(thumbnail.chunk(*chunk) for chunk in chunks), 6)
        parts = dict(thumbnail.chunks_of(small))
        self.assertEqual(struct.unpack(">II", parts[b"IHDR"][:8]), (6, 5))
        values = numpy.frombuffer(zlib.decompress(parts[b"IDAT"]), numpy.uint8).reshape(5, 19)[:, 1:].reshape(5, 6, channels)
        expected = pixels.reshape(5, 2, 6, 2, channels).sum(axis=(1, 3)) // 4
        self.assertTrue((values == expected).all())
        self.assertIsNone(thumbnail.thumbnail(b"no picture", 6))


class WholeTest(PlanTest):
    def test_ninja_make_and_reports(self):
        self.describe()
        self.assertIn("12 steps: 12 done", self.call("run", "tent.plan.json"))
        self.assertEqual(self.run_again(), "import-tent")
        self.call("tent.plan.json", "-o", "made", "--make", "Makefile")
        make = ["make", "-C", self.folder / "made", "-f", self.folder / "Makefile"]
        self.assertEqual(subprocess.run([*make, "-j2"], env=self.environment, capture_output=True).returncode, 0)
        self.assertEqual(subprocess.run([*make, "-q"], env=self.environment, capture_output=True).returncode, 0)
        self.assertEqual(self.run_again("-o", "made"), "import-tent")
        for name in ("around/around.0002.exr", "whole/whole.0001.png", "still/still.exr"):
            self.assertEqual((self.folder / "made" / name).read_bytes(), (self.folder / "tent" / name).read_bytes(), name)
        self.check_reports()

    def check_reports(self):
        self.call("report", "tent", "-o", "report.html", "--junit", "junit.xml")
        page = (self.folder / "report.html").read_text()
        self.assertEqual(page.count("data:image/png;base64,"), 5)
        count = len(self.states())
        self.assertEqual(len(re.findall(r"<rect ", page)), 1)  # the last run called rt-import only
        self.assertNotIn("http", page)
        self.assertIn('href="tent/same/same.0002.html"', page)
        self.assertTrue((self.folder / "tent/same/same.0002.html").exists())
        self.assertIn("nothing that it depends on has changed", page)
        self.call("tent.plan.json", "--ninja", "n")  # and nobody knows when Ninja begins
        self.call("report", "tent", "-o", "again.html")
        page = (self.folder / "again.html").read_text()
        self.assertNotIn("nothing that it depends on has changed", page)
        self.assertEqual(len(re.findall(r"<rect ", page)), count)
        suite = ET.parse(self.folder / "junit.xml").getroot()
        self.assertEqual([suite.get(key) for key in ("tests", "failures", "skipped")], [str(count), "0", "0"])
        self.assertEqual([case.findtext("system-out") for case in suite], ["up to date"] + [None] * (count - 1))
        self.assertEqual(suite.findall(".//skipped"), [])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
