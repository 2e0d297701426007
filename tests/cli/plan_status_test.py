"""How far a run is, and reports of it: plan_status_test.py ROOT BIN_DIR"""
import json
import os
import re
import shutil
import struct
import subprocess
import time
import unittest
import unittest.mock
import xml.etree.ElementTree as ET
import zlib

import numpy

from plan_support import GOOD, LOOK, PlanTest, main
from planner import freshness, graph, run_here, run_step, status, thumbnail


class StatusTest(PlanTest):
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

    def test_a_failure_costs_what_slurm_ties_to_it(self):
        """The comparisons of one frame each, which wait for all steps of two; but no merge of another frame."""
        self.describe(GOOD | {
            "renders": {"around": GOOD["renders"]["around"], "pairs": GOOD["renders"]["whole"] | {"frames": [1, 4]}},
            "comparisons": {"gate": {"render": "pairs", "golden": "%d.exr"}, "same": {"render": "around", "golden": "%d.exr"}},
        })  # fmt: skip
        self.call_here("tent.plan.json", "--ninja", "n")
        folder, made = self.folder / "tent", graph.load_graph(self.folder / "tent")
        ended = {"start": 1.0, "end": 2.0, "host": "a", "slot": "", "exitCode": 4, "why": "no luck"}
        (folder / "around").mkdir()
        (folder / "pairs").mkdir()
        for step in made.steps:
            if step.stage in ("import", "grid", "trace"):
                for output in step.outputs:
                    (folder / output).touch()
                run_step.save_record(folder, step, "failed" if step.id in ("trace-around-0002-1of2", "trace-pairs-0003") else "done", [ended],
                                     {"files": freshness.signatures(folder, [*step.inputs, *step.outputs])})  # fmt: skip
        statuses = {s.step.id: s for s in status.run_status(made, folder, {"compare-same-0001": ("7_1", "PENDING", "Dependency")})}
        found = {id: s.why for id, s in statuses.items() if s.step.stage in ("merge", "compare")}
        self.assertEqual(found, {
            "merge-around-0001": status.LOST,
            "merge-around-0002": "trace-around-0002-1of2 failed",
            "compare-gate-0001": "trace-pairs-0003 failed, and Slurm starts compare-gate after all of trace-pairs only",
            "compare-gate-0002": "trace-pairs-0003 failed, and Slurm starts compare-gate after all of trace-pairs only",
            "compare-gate-0003": "trace-pairs-0003 failed",
            "compare-gate-0004": "trace-pairs-0003 failed",
            "compare-same-0001": "Slurm job 7_1 PENDING (Dependency)",
            "compare-same-0002": "merge-around-0002 blocked",
        })  # fmt: skip
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
        self.stand_in("make\n")
        self.call_here("run", "tent.plan.json")
        self.write("tent/slurm-jobs.tsv", "")
        os.utime(self.folder / "tent/slurm-jobs.tsv", (1, 1))
        self.write("squeue", "#!/bin/sh\necho 'no controller' >&2; exit 1\n", 0o755)
        self.environment["PATH"] = f"{self.folder}:{self.environment['PATH']}"
        warning = r'plan: warning: Slurm does not say what is queued: squeue: "no controller"; try again\n'
        self.assertRegex(self.call_here("status", "tent"), rf"^tent: 3 steps: 3 done\n{warning}$")
        self.assertRegex(self.call_here("report", "tent", "--junit", "junit.xml"), f"^{warning}$")
        record = self.folder / "tent/steps/trace-still.json"
        record.write_text(record.read_text().replace('"done"', '"running"'))  # cut off, and perhaps in the queue again
        said = self.call_here("status", "tent", expect=10)
        self.assertRegex(said, r"^waiting +trace-still +Slurm does not say whether .*\n.*: 2 done, 1 waiting\nnext: ask again where Slurm answers\n")

    def test_what_reads_what_was_made_anew_is_not_done(self):
        self.describe_still()
        self.stand_in("echo x >>$out; make\n")  # other files each time
        self.call_here("run", "tent.plan.json")
        self.call_here("step", "tent", "import-tent")
        said = self.call_here("status", "tent", expect=10)
        self.assertRegex(said, r"^waiting +grid-tent +what it reads or made has changed since\nwaiting +trace-still +for grid-tent\ntent: 3 steps: 1 done, 2 waiting\n")
        self.call_here("report", "tent", "-o", "page.html", "--junit", "junit.xml")
        self.assertIn("<figcaption>still: waiting</figcaption>", (self.folder / "page.html").read_text())
        self.assertEqual(ET.parse(self.folder / "junit.xml").getroot().get("skipped"), "2")
        self.call_here("step", "tent", "grid-tent")
        self.assertRegex(self.call_here("status", "tent", expect=10), r"^waiting +trace-still +what it reads or made has changed since\n")
        self.call_here("step", "tent", "trace-still")
        self.call_here("status", "tent")
        self.write("tent/still/still.exr", "of another description, made in the same folder")
        self.assertRegex(self.call_here("status", "tent", expect=10), r"^waiting +trace-still +what it reads or made has changed since\n")

    def test_what_slurm_has_to_run_again_is_not_done_by_an_earlier_record(self):
        """And Slurm's log is named, if there is one of that time. Its lists of tasks are needed no more than it has tasks."""
        self.describe(GOOD | {"renders": {"s": LOOK | {"cameraPath": "path.json", "frames": [1, 2]}}, "comparisons": {}})
        self.stand_in("[ -e $(printf $out ${frames%-*}) ] || make\n")
        self.call_here("run", "tent.plan.json")
        self.call_here("tent.plan.json", "--slurm", "s")
        self.write("tent/logs/slurm-tent.trace-s-1.log", "of an earlier run")
        self.write("sbatch", "#!/bin/sh\necho x >>n; wc -l <n\n", 0o755)
        self.write("squeue", "#!/bin/sh\n", 0o755)
        self.environment["PATH"] = f"{self.folder}:{self.environment['PATH']}"
        self.assertEqual(subprocess.run(["sh", "s/submit.sh"], cwd=self.folder, env=self.environment, stdout=subprocess.DEVNULL).returncode, 0)
        shutil.rmtree(self.folder / "s")
        self.assertRegex(self.call_here("status", "tent", expect=1), rf"^blocked +import-tent +{status.LOST}\n(blocked .*\n)+tent: 4 steps: 4 blocked\n")
        for step in ("import-tent", "grid-tent"):
            self.call_here("step", "tent", step)
        self.write("tent/logs/slurm-tent.trace-s-2.log", "plan: No such file")
        self.assertRegex(self.call_here("status", "tent", expect=1),
                         rf"^blocked +trace-s-0001 +{status.LOST}\n"
                         r"blocked +trace-s-0002 +ended before it could say why; see tent/logs/slurm-tent.trace-s-2.log\ntent: 4 steps: 2 skipped, 2 blocked\n")  # fmt: skip
        self.write("squeue", "#!/bin/sh\nexit 1\n", 0o755)
        self.assertRegex(self.call_here("status", "tent", expect=10), r"^waiting +trace-s-0001 +Slurm does not say whether")
        self.write("squeue", "#!/bin/sh\n", 0o755)
        for step in ("trace-s-0001", "trace-s-0002"):
            self.call_here("step", "tent", step)
        self.assertEqual(self.call_here("status", "tent"), "tent: 4 steps: 4 skipped\n")

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

    def test_records_that_are_none_do_not_count(self):
        self.describe_still()
        self.stand_in("make\n")
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
        self.stand_in("make\n")
        self.call_here("tent.plan.json", "--ninja", "n")
        ninja = (self.folder / "n").read_text()
        altered = (self.folder / "tent/plan.json").read_bytes().replace(b"trace-still", b"trace-stilt", 1)
        begin = time.time()
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
        self.assertGreater(json.loads((self.folder / "tent/run.json").read_text())["start"], begin)

    def test_what_waits_for_a_step_that_fails_is_not_done(self):
        self.describe_still()
        self.stand_in("[ ! -e fails ] || exit 4; make\n")
        self.call_here("run", "tent.plan.json")
        (self.folder / "tent/fails").touch()
        said = self.call_here("run", "tent.plan.json", expect=1)
        self.assertRegex(said, r"blocked +grid-tent +import-tent failed; its outputs are of an earlier run\n")
        self.assertIn("3 steps: 1 failed, 2 blocked\n", said)


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


class ReportTest(PlanTest):
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

    def test_reports_replace_no_file_of_the_run(self):
        self.describe_still()
        self.stand_in("make\n")
        self.call_here("run", "tent.plan.json")
        (self.folder / "link").symlink_to("tent")
        before = {path: path.read_bytes() for path in self.folder.rglob("*.*") if path.is_file()}
        for name in ("tent/plan.json", "link/run.json", "tent/steps/import-tent.json", "tent/still/still.png", "tent.obj"):
            for option in ("-o", "--junit"):
                self.assertRegex(self.call_here("report", "tent", option, name, expect=2), rf"^plan: error: {name}: belongs to the run; .*\n$")
        self.assertEqual(before, {path: path.read_bytes() for path in before})

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
    main()
