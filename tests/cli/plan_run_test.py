"""Steps that run here: devices, retries, signals, records: plan_run_test.py ROOT BIN_DIR"""
import json
import os
import pathlib
import signal
import subprocess
import sys
import time
import unittest.mock

from plan_support import GOOD, LOOK, PLAN, TOOLS, PlanTest, main
from planner import errors, files, graph, run_here, slurm_queue, versions


class RunTest(PlanTest):
    def test_steps_overlap_on_two_devices_and_never_on_one(self):
        self.describe()
        # The first of rt-trace waits until there is a second, or for 20 s.
        self.stand_in('echo "$RT_DEVICE" >"$(printf "${out:-x}" 1).device"\n'
                      'case $0 in *trace) echo >>starts; n=0; while [ $(wc -l <starts) = 1 ] && [ $n -lt 200 ]; do sleep 0.1; n=$((n + 1)); done ;; esac\nmake\n')
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

    def test_a_file_system_with_another_clock_makes_no_input_changed(self):
        self.describe_still()
        self.stand_in("[ -e $out ] || make\n")
        now = time.time
        with unittest.mock.patch.object(time, "time", lambda: now() - 100):
            self.call_here("run", "tent.plan.json")
        self.assertEqual(self.run_again(), "import-tent")

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

    def test_a_step_is_not_run_after_one_that_failed(self):
        """An engine may forget what it waited for. All is there from an earlier run, whose records say that it is done."""
        self.describe_still()
        self.stand_in("[ ! -e fails ] || exit 4\ncase $0 in *rt-trace) set -- still/still.exr still/still.png ;; *) set -- $out ;; esac\nfor f; do echo x >>$f; done\n")
        self.call("run", "tent.plan.json")
        (self.folder / "tent/fails").touch()
        self.call("step", "tent", "import-tent", expect=4)
        (self.folder / "tent/fails").unlink()
        pictures = (self.folder / "tent/still/still.exr").read_text()
        self.environment["SLURM_ARRAY_TASK_ID"] = "1"
        said = self.call("step", "tent", "trace-still", "--retries", "2", expect=3)
        self.assertRegex(said, r"^plan: error: trace-still: is not run, since import-tent failed; see \S*/tent/logs/import-tent.log\n$")
        self.assertEqual((self.folder / "tent/still/still.exr").read_text(), pictures)
        self.assertEqual(self.states(expect=1)["trace-still"]["state"], "blocked")
        for step in ("import-tent", "grid-tent", "trace-still"):
            self.call("step", "tent", step)
        self.assertEqual((self.folder / "tent/still/still.exr").read_text(), pictures + "x\n")

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

    def test_programs_that_do_not_answer_are_named(self):
        self.stand_in("")
        self.write("tools/squeue", "#!/bin/sh\nexec sleep 60\n", 0o755)
        here = unittest.mock.patch.dict(os.environ, {"PATH": f"{self.folder}/tools:{os.environ['PATH']}"})
        for module, ask in ((slurm_queue, slurm_queue.ask_squeue), (versions, lambda: versions.version_of("squeue"))):
            with here, unittest.mock.patch.object(module, "TIMEOUT_SECONDS", 0.1), self.assertRaisesRegex(errors.PlanError, "squeue.*0.1 s"):
                ask()

    def test_tools_beside_an_installed_plan_are_found(self):
        self.describe_still()
        self.stand_in("make\n")
        (self.folder / "tools/rt-plan").symlink_to(PLAN)
        environment = self.environment | {"PATH": f"{os.path.dirname(sys.executable)}:/usr/bin:/bin"}
        del environment["RT_TOOLS_DIR"]
        said = subprocess.run(["tools/rt-plan", "run", "tent.plan.json"], cwd=self.folder, env=environment, capture_output=True, text=True)
        self.assertIn("3 steps: 3 done", said.stdout, said.stderr)

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
        for step in ("grid-tent", "import-tent"):  # as an engine would; none is run after one that failed
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

    def wait_for_lock(self, process):
        """Until it has come so far that it waits for the first step's end."""
        lock = os.path.realpath(self.folder / "tent/steps/import-tent.lock")
        opened = lambda: map(os.path.realpath, pathlib.Path(f"/proc/{process.pid}/fd").iterdir())  # noqa: E731 - some are closed meanwhile
        self.wait_for(lambda: lock in opened())

    def test_a_step_that_was_cut_off_goes_on_and_is_not_run_twice_at_a_time(self):
        self.export_with("echo x >>starts; while [ -e starts ] && [ ! -e go ]; do sleep 0.02; done; : >tent.rtmesh\n")
        words = [sys.executable, PLAN, "step", "tent", "import-tent"]
        first = subprocess.Popen(words, cwd=self.folder, env=self.environment)
        starts = self.folder / "tent/starts"
        self.wait_for(starts.exists)
        first.kill()  # the tool goes on, and holds the lock
        first.wait()
        second = subprocess.Popen(words, cwd=self.folder, env=self.environment)
        self.wait_for_lock(second)
        self.assertEqual(starts.read_text(), "x\n")
        self.assertEqual(self.states(expect=10)["import-tent"]["state"], "running")
        (self.folder / "tent/go").touch()
        self.assertEqual(second.wait(timeout=60), 0)
        state = self.states(expect=10)["import-tent"]
        self.assertEqual([attempt["why"] for attempt in state["attempts"]], ["cut off", ""])

    def test_a_run_that_was_killed_goes_on_and_a_second_one_beside_it_is_refused(self):
        self.describe_still()
        self.stand_in("echo >>starts; while [ ! -e go ]; do sleep 0.02; done; make\n")
        words = [sys.executable, PLAN, "run", "tent.plan.json"]
        first = subprocess.Popen(words, cwd=self.folder, env=self.environment, stdout=subprocess.DEVNULL)
        self.wait_for((self.folder / "tent/starts").exists)
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
        self.wait_for_lock(second)
        (self.folder / "tent/go").touch()
        self.assertEqual(second.wait(timeout=60), 0)
        states = self.states()
        self.assertEqual({step["state"] for step in states.values()}, {"done"})
        self.assertEqual([attempt["why"] for attempt in states["import-tent"]["attempts"]], ["cut off", ""])

    def test_a_run_that_cannot_write_its_records_says_so(self):
        self.export_with("")
        self.write("tent/steps", "no folder")
        for words in (("run", "tent.plan.json"), ("status", "tent"), ("step", "tent", "import-tent")):
            self.assertRegex(self.call(*words, expect=3), r"^plan: error: \S*tent/steps\S*: .*\n$")

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
            out, said = run.communicate(timeout=60)
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


if __name__ == "__main__":
    main()
