"""Goldens, made of the pictures of a run: plan_goldens_test.py ROOT BIN_DIR"""
import contextlib
import json
import os
import re
import signal
import unittest.mock

from plan_support import GOOD, LOOK, MODEL, PlanTest, main
from planner import errors, goldens, graph


class GoldensTest(PlanTest):
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

    def test_a_golden_that_is_gone_leaves_no_figures_of_before_and_is_not_waited_for(self):
        self.describe({key: GOOD[key] for key in ("scenes", "atlases")} | {
            "renders": {"still": LOOK}, "comparisons": {"gate": {"render": "still", "golden": "golden/still.exr"}}})  # fmt: skip
        self.call_here("run", "tent.plan.json", expect=1)
        self.call_here("update-goldens", "tent")
        self.call_here("run", "tent.plan.json")
        self.call_here("report", "tent", "-o", "tent/report.html")
        self.assertRegex((self.folder / "tent/report.html").read_text(), "RMSE 0.*href=\"gate/gate.html")
        (self.folder / "golden/still.exr").unlink()
        self.call_here("step", "tent", "compare-gate", "--retries", "2", expect=3)
        self.assertEqual(len(self.states(expect=1)["compare-gate"]["attempts"]), 1)
        self.call_here("report", "tent", "-o", "tent/report.html")
        self.assertNotRegex((self.folder / "tent/report.html").read_text(), "RMSE 0|href=\"gate/gate.html")
        self.call_here("run", "tent.plan.json", expect=1)

    def test_goldens_are_replaced_all_or_none(self):
        self.describe_goldens()
        self.stand_in_of_goldens()
        self.call("tent.plan.json", "--ninja", "n")
        self.assertIn("import-tent waiting (to be started); see plan status", self.call("update-goldens", "tent", expect=3))
        self.call("run", "tent.plan.json", expect=1)
        (self.folder / "golden").mkdir()
        self.write("golden/2", "where a folder should be")
        self.write("golden/still.exr", "old")
        self.assertRegex(self.call("update-goldens", "tent", expect=3), "^plan: error: .*golden/2.*\n$")
        self.assertEqual([path.name for path in (self.folder / "golden").rglob("*.*")], ["still.exr"])
        (self.folder / "golden/2").unlink()
        picture = self.folder / "tent/around/around.0002.exr"
        picture.write_bytes(picture.read_bytes()[:-1])
        self.assertIn("around.0002.exr: is not of a finished run: trace-around-0002 waiting (what it reads or made has changed since)", self.call("update-goldens", "tent", expect=3))
        self.assertEqual((self.folder / "golden/still.exr").read_text(), "old")
        self.call("run", "tent.plan.json", expect=1)
        self.call("update-goldens", "tent")
        self.call("run", "tent.plan.json")

    def test_goldens_are_of_a_run_in_which_all_went_well(self):
        self.describe_goldens()
        self.stand_in_of_goldens()
        self.call_here("run", "tent.plan.json", expect=1)
        program = (self.folder / "tools/rt-import").read_text()
        self.write("tools/rt-import", program.replace("case $0", "[ ! -e fails ] || exit 4; case $0"), 0o755)
        (self.folder / "tent/fails").touch()
        self.call_here("run", "tent.plan.json", expect=1)  # and has the pictures of the run before
        said = self.call_here("update-goldens", "tent", expect=3)
        self.assertRegex(said, r"^plan: error: .*/still.exr: is not of a finished run: import-tent failed \(exit code 4\); see plan status .*/tent\n$")
        (self.folder / "tent/fails").unlink()
        (self.folder / "tent/tent.rtmesh").unlink()
        self.call_here("step", "tent", "import-tent")  # as if the run had been interrupted then: another mesh, of which there are no pictures
        self.assertRegex(self.call_here("update-goldens", "tent", expect=3), r"^plan: error: .*/still.exr: is not of a finished run: grid-tent waiting \(what it reads or made has changed since\); see plan status .*\n$")
        self.assertFalse((self.folder / "golden").exists())
        self.call_here("run", "tent.plan.json", expect=1)
        self.call_here("update-goldens", "tent")
        self.write("tent.obj", MODEL + "# A picture is that of the run, whatever is edited after it.\n")
        self.call_here("update-goldens", "tent")

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


if __name__ == "__main__":
    main()
