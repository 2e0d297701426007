"""What descriptions may say, and what plan says of their faults: plan_description_test.py ROOT BIN_DIR"""
import json
import re
import subprocess

import jsonschema

from plan_support import GOOD, LOOK, ROOT, TOOLS, PlanTest, main
from changed_document import REMOVE, changed_document
from planner import description, errors, tool_options

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


def changed(place, value):
    return changed_document(GOOD, place, value)


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


if __name__ == "__main__":
    main()
