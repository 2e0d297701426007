"""Steps, printed and exported to other engines: plan_export_test.py ROOT BIN_DIR"""
import copy
import json
import os
import re
import signal
import subprocess
import sys
import unicodedata

from plan_support import GOOD, LOOK, PLAN, TOOLS, PlanTest, main
from planner import graph, slurm_arrays


class ExportTest(PlanTest):
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
                re.findall(r"^(job_\d+)=\$\(sbatch .*--parsable (?:--dependency=(\S+) )?\S*/(\S+)\.sbatch\)$", text, re.MULTILINE)}  # fmt: skip
        self.assertEqual(len({job for job, _ in jobs.values()}), 1 + 3 + 6 + 1 + 1)
        for name in ("a-b", "a_b"):
            self.assertEqual(jobs[f"trace-{name}"][1], f"afterok:${{{jobs[f'grid-{name}'][0]}}}")
        shards, whole, merge = ([f"${{{jobs[name][0]}}}" for name in names] for names in
                                (("trace-around.1of2", "trace-around.2of2"), ["trace-whole"], ["merge-around"]))  # fmt: skip
        self.assertEqual(jobs["merge-around"][1], ":".join(["aftercorr", *shards]))
        self.assertEqual(jobs["compare-same"][1], f"afterok:{whole[0]},aftercorr:{merge[0]}")
        document["renders"]["around-0002"] = LOOK | {"shards": 2}
        self.describe(document)
        self.assertRegex(self.call("tent.plan.json", expect=4), r"^plan: error: tent\.plan\.json: two steps .* trace-around-0002-1of2")

    def test_slurms_arrays_wait_for_no_other_frames_where_they_can(self):
        around = GOOD["renders"]["around"]
        renders = {"many": around | {"frames": [1, 1001]}, "one": around | {"frames": [1, 1]}, "pairs": GOOD["renders"]["whole"] | {"frames": [1, 4]}}
        comparisons = {name: {"render": name, "golden": "g/%d.exr"} for name in renders}
        made = graph.build_graph(GOOD | {"renders": renders, "comparisons": comparisons}, "t", self.folder, self.folder / "t")
        arrays = slurm_arrays.arrays_of(made)
        names = lambda numbers: [arrays[number].name for number in numbers]  # noqa: E731
        found = {array.name: (len(array.steps), names(array.after_all), names(array.after_each)) for array in arrays}
        shards = ["trace-many.1of2", "trace-many.2of2", "trace-many.1of2.2", "trace-many.2of2.2"]
        self.assertEqual([found[name] for name in shards], [(count, ["grid-tent"], []) for count in (1000, 1000, 1, 1)])
        self.assertEqual(found["merge-many"], (1000, [], shards[:2]))
        self.assertEqual(found["merge-many.2"], (1, shards[2:], []))
        self.assertEqual(found["compare-many"], (1000, [], ["merge-many"]))
        self.assertEqual((found["trace-one"][0], found["merge-one"]), (2, (1, ["trace-one"], [])))
        self.assertEqual(found["compare-pairs"], (4, ["trace-pairs"], []))
        places = {step.id: i for array in arrays for i, step in enumerate(array.steps)}
        for array in arrays:
            for step in array.steps if array.after_each else ():
                self.assertEqual({places[id] for id in step.depends_on}, {places[step.id]})

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
            self.assertEqual(submit.wait(timeout=60), 128 + number)
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

    def test_a_run_that_is_queued_is_left_alone(self):
        """By all that would write what its tasks read, and by submit.sh where that was written."""
        self.describe()
        self.call_here("tent.plan.json", "--slurm", "s")
        self.write("sbatch", "#!/bin/sh\ntouch handed; n=0; while [ ! -e go ] && [ $n -lt 400 ]; do sleep 0.02; n=$((n + 1)); done; echo 7\n", 0o755)
        self.write("squeue", "#!/bin/sh\n", 0o755)
        self.environment["PATH"] = f"{self.folder}:{self.environment['PATH']}"
        submit = lambda: subprocess.Popen(["sh", "s/submit.sh"], cwd=self.folder, env=self.environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)  # noqa: E731
        first = submit()
        self.wait_for((self.folder / "tent/handed").exists)
        second = submit()
        self.assertRegex(second.communicate()[1].decode(), r"^s/submit.sh: error: \S*/tent is at work already: .*\n$")
        self.assertEqual(second.returncode, 3)
        (self.folder / "tent/go").touch()
        self.assertEqual(first.communicate(), (None, b""))
        for said, why in (("echo '7_1|PENDING|None'", "Slurm still has 1 steps of this run; .*: scancel 7"), ("exit 1", ".* or remove .*/slurm-jobs.tsv if .*")):
            self.write("squeue", f"#!/bin/sh\n{said}\n", 0o755)
            before = {path: path.read_bytes() for path in (self.folder / "tent/plan.json", self.folder / "tent/slurm-jobs.tsv", *(self.folder / "s").iterdir())}
            self.describe(GOOD | {"comparisons": {}})
            for words in (("tent.plan.json", "--slurm", "s"), ("tent.plan.json", "--ninja", "n"), ("run", "tent.plan.json")):
                self.assertRegex(self.call_here(*words, expect=3), rf"^plan: error: .*{why}\n$")
            self.assertEqual(before, {path: path.read_bytes() for path in before})
        self.write("squeue", "#!/bin/sh\n", 0o755)
        self.call_here("tent.plan.json", "--ninja", "n")
        self.assertFalse((self.folder / "tent/slurm-jobs.tsv").exists())
        self.assertRegex(submit().communicate()[1].decode(), r"^s/submit.sh: error: \S*/tent/plan.json changed since this was exported; export again\n$")


if __name__ == "__main__":
    main()
