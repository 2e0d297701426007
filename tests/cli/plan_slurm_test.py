"""An animation in shards on a real Slurm of one node, while its parts fail: plan_slurm_test.py PLAN BIN_DIR

A shard fails once, the node dies in the middle of a shard, the controller is killed and comes back. In the end every
frame is there once, whole, and the same to the bit as those of a run without Slurm and shards. In a second run a shard and a scene fail
for good, which costs what depends on them and nothing else. Exit code 77 (skipped) where Slurm is not installed.
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

from slurm_cluster import SlurmCluster, why_not

FRAMES = range(1, 13)
SHARDS = 2
RUN = "in Slurm %d"  # a name that Slurm reads otherwise if it is not quoted
MODEL = "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 1 0\nf 1 3 2\nf 1 4 3\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n"
PATH = [{"frame": 1, "eye": [3, 2, 0], "lookAt": [0, 0.4, 0]}, {"frame": 12, "eye": [0, 2, 3], "lookAt": [0, 0.4, 0]}]
NEEDS = {"cores": 1, "memory": 200, "minutes": 5}
SHOWN = {"atlas": "tent", "cameraPath": "path.json", "frames": [1, 12], "size": [64, 64], "options": ["--light", "point:2,4,1"]}
DESCRIPTION = {
    "scenes": {"tent": {"inputs": ["tent.obj"]}},
    "atlases": {"tent": {"scene": "tent", "structure": "cloud"}},
    "renders": {
        "around": SHOWN | {"shards": SHARDS},
        "whole": SHOWN | {"framesPerStep": 12},
    },
    "comparisons": {"same": {"render": "around", "against": "whole"}},
    "resources": {stage: NEEDS for stage in ("import", "grid", "trace", "merge", "compare")},
}
LOCAL = {key: DESCRIPTION[key] for key in ("scenes", "atlases", "resources")} | {"renders": {"around": DESCRIPTION["renders"]["whole"]}}
# rt-trace, but: a shard of frame 2 fails the first time, one of frame 4 and those of frames 8 and 9 wait while hold.* is there.
FAULTY = """#!/bin/sh
case "$*" in
*--frames\\ 2-2\\ *--shard\\ 1/*) [ -e {0}/failed ] || {{ : >{0}/failed; echo 'rt-trace: error: the GPU went away' >&2; exit 6; }} ;;
*--frames\\ 4-4\\ *--shard\\ 1/*) : >{0}/at.4; while [ -e {0}/hold.4 ]; do sleep 0.05; done ;;
*--frames\\ [89]-*--shard\\ 1/*) echo >>{0}/at.8; while [ -e {0}/hold.8 ]; do sleep 0.05; done ;;
esac
exec {1}/rt-trace "$@"
"""
FAILING = """#!/bin/sh
case "$*" in
*--frames\\ 12-12\\ *--shard\\ 1/*) echo 'rt-trace: error: for good' >&2; exit 4 ;;
*--frames\\ [12]-*--shard\\ 2/*) while [ -e {0}/hold.1 ]; do sleep 0.05; done ;;
esac
exec {1}/rt-trace "$@"
"""


class Trial:
    def __init__(self, plan, tools, folder):
        self.plan, self.tools, self.folder = plan, tools, folder
        (folder / "tent.obj").write_text(MODEL)
        (folder / "path.json").write_text(json.dumps(PATH))
        (folder / "tent.plan.json").write_text(json.dumps(DESCRIPTION))
        self.faulty = folder / "faulty"
        self.faulty.mkdir()
        for name in ("rt-import", "rt-grid", "rt-compare"):
            (self.faulty / name).symlink_to(tools / name)
        (self.faulty / "rt-trace").write_text(FAULTY.format(folder, tools))
        (self.faulty / "rt-trace").chmod(0o755)
        for frame in (4, 8):
            (folder / f"hold.{frame}").touch()
        self.environment = os.environ | {
            "RT_DEVICES": "software,software", "RT_DEVICE_LOCKS": str(folder / "devices"), "XDG_CACHE_HOME": str(folder / "cache"),
            "LP_NUM_THREADS": "1",
        }  # fmt: skip
        self.environment.pop("RT_NO_SHADER_CACHE", None)  # in this test's own folder it does no harm

    def run(self, *words, environment=None, expect=0):
        result = subprocess.run(words, cwd=self.folder, env=environment or self.environment, capture_output=True, text=True)
        assert result.returncode == expect, f"{words} ended with {result.returncode}\n{result.stdout}{result.stderr}"
        return result.stdout

    def status(self, cluster, folder):
        words = [sys.executable, self.plan, "status", folder, "--json"]
        result = subprocess.run(words, env=self.environment | cluster.environment, capture_output=True, text=True)
        return (result.returncode, json.loads(result.stdout)["steps"]) if result.stdout else (None, [])


def is_over(trial, cluster):
    """A task that Slurm is about to put back into the queue is in none, and seems to have failed."""
    code, _ = trial.status(cluster, trial.folder / RUN)
    return code == 0 or (code == 1 and not cluster.ask("squeue", "-h"))


def run_with_faults(trial, cluster):
    """The steps as `plan status` has them in the end."""
    environment = trial.environment | cluster.environment
    trial.run(sys.executable, trial.plan, "tent.plan.json", "-o", RUN, "--slurm", "the jobs", "--tools", trial.faulty)
    trial.run("sh", "the jobs/submit.sh", environment=environment)
    trial.run("sh", "the jobs/submit.sh", environment=environment, expect=3)
    begin = time.monotonic()
    cluster.wait_for(lambda: (trial.folder / "at.4").exists(), "the shard of frame 4 does not start", 60)
    cluster.kill("slurmd")
    print(f"{time.monotonic() - begin:5.1f} s: node killed in the middle of a shard")
    cluster.wait_for(lambda: "down" in cluster.ask("sinfo", "-h", "-o", "%t"), "Slurm does not see that the node is dead", 60)
    (trial.folder / "hold.4").unlink()
    cluster.start_node()
    shards_run = lambda: (trial.folder / "at.8").exists() and len((trial.folder / "at.8").read_text()) == 2
    cluster.wait_for(shards_run, "the shards of frames 8 and 9 do not start", 60)
    cluster.wait_for_save()  # see pipelines/README.md for what the controller had no time to save
    cluster.kill("slurmctld")
    print(f"{time.monotonic() - begin:5.1f} s: controller killed")
    (trial.folder / "hold.8").unlink()  # so that shards end while nobody listens
    records = [trial.folder / RUN / "steps" / f"trace-around-{frame:04d}-1of2.json" for frame in (8, 9)]
    cluster.wait_for(lambda: all('"done"' in record.read_text() for record in records), "the shards of frames 8 and 9 do not end", 60)
    cluster.start_controller()
    try:
        cluster.wait_for(lambda: is_over(trial, cluster), "not all steps end", 120)
    finally:
        code, steps = trial.status(cluster, trial.folder / RUN)
        print("\n".join(f"{step['id']} {step['state']} {step['why']}" for step in steps if step["state"] not in ("done", "skipped")))
    print(f"{time.monotonic() - begin:5.1f} s: all steps ended")
    assert code == 0, f"plan status ended with {code}\n{cluster.logs()}"
    cluster.wait_for(lambda: (trial.folder / RUN / "junit.xml").exists(), "the summary is not written", 60)
    return {step["id"]: step for step in steps}


def check(trial, steps):
    expected = 1 + 1 + len(FRAMES) * (SHARDS + 1) + 1 + len(FRAMES)  # import, grid, shards and merges, whole, comparisons
    assert len(steps) == expected, f"{len(steps)} steps instead of {expected}"
    codes = [attempt["exitCode"] for attempt in steps["trace-around-0002-1of2"]["attempts"]]
    assert codes == [6, 0], f"the shard that fails once ended with {codes}"
    cut_off = steps["trace-around-0004-1of2"]["attempts"]
    assert [a["why"] for a in cut_off] == ["cut off", ""], f"the shard on the dead node: {cut_off}"
    pictures = sorted(path.name for path in (trial.folder / RUN / "around").glob("*.exr") if ".part" not in path.name)
    assert pictures == [f"around.{frame:04d}.exr" for frame in FRAMES], pictures
    for frame in FRAMES:
        for name in (f"around.{frame:04d}.exr", f"around.{frame:04d}.png"):
            ours, local = ((trial.folder / run / "around" / name).read_bytes() for run in (RUN, "local"))
            assert without_recipe(ours) == without_recipe(local), f"{name} is not that of the local run"
    left = [path for path in (trial.folder / RUN).rglob("*.tmp*")]
    assert not left, f"left over: {left}"
    summary = (trial.folder / RUN / "summary.txt").read_text()
    # One that died after its tool had ended, or that Slurm started twice, was up to date the next time.
    counts = re.search(rf"^tent: {expected} steps: (\d+) done(?:, (\d+) skipped)?$", summary, re.MULTILINE)
    assert counts and sum(int(count or 0) for count in counts.groups()) == expected, summary


def without_recipe(picture):
    """PNGs also say of what they were made: a text of 43 characters and its check sum."""
    return re.sub(rb"rt-recipe:[0-9a-f]{16}:[0-9a-f]{16}.{4}", b"", picture, flags=re.DOTALL) if picture.startswith(b"\x89PNG") else picture


def check_failures(trial, cluster):
    """What waits for a step that fails is cancelled by Slurm, or refused where Slurm forgot that failure, and status says why; what does not is
    done. No merge starts before it forgot; the last one is none of the 10 tasks that it split off the array before."""
    cluster.configure("MinJobAge=2")
    (trial.folder / "hold.1").touch()
    (trial.folder / "broken.obj").write_text("v nonsense\n")
    (trial.faulty / "rt-trace").write_text(FAILING.format(trial.folder, trial.tools))
    broken = {
        "scenes": DESCRIPTION["scenes"] | {"broken": {"inputs": ["broken.obj"]}},
        "atlases": DESCRIPTION["atlases"] | {"broken": {"scene": "broken"}},
        "renders": DESCRIPTION["renders"] | {"lost": SHOWN | {"atlas": "broken", "shards": SHARDS, "frames": [1, 3]}},
    }  # fmt: skip
    (trial.folder / "broken.plan.json").write_text(json.dumps(DESCRIPTION | broken))
    trial.run(sys.executable, trial.plan, "broken.plan.json", "--slurm", "broken-jobs", "--tools", trial.faulty)
    trial.run("sh", "broken-jobs/submit.sh", environment=trial.environment | cluster.environment)
    record = trial.folder / "broken" / "steps" / "trace-around-0012-1of2.json"
    cluster.wait_for(lambda: record.exists() and '"failed"' in record.read_text(), "the shard does not fail", 60)
    cluster.wait_for(lambda: not cluster.ask("squeue", "-h", "-t", "FAILED"), "Slurm does not forget the shard", 60)
    (trial.folder / "hold.1").unlink()
    cluster.wait_for(lambda: not cluster.ask("squeue", "-h"), "the queue is not emptied", 120)
    code, steps = trial.status(cluster, trial.folder / "broken")
    bad = {step["id"]: f"{step['state']}: {step['why']}" for step in steps if step["state"] not in ("done", "skipped")}
    lost = {"grid-broken": "import-broken failed"} | {f"trace-lost-{frame:04d}-{shard}of2": "grid-broken blocked" for frame in (1, 2, 3) for shard in (1, 2)}
    lost |= {f"merge-lost-{frame:04d}": f"trace-lost-{frame:04d}-1of2 blocked" for frame in (1, 2, 3)}
    lost |= {"merge-around-0012": "trace-around-0012-1of2 failed", "compare-same-0012": "merge-around-0012 blocked"}
    failed = [bad.pop(id, "not") for id in ("import-broken", "trace-around-0012-1of2")]
    assert code == 1 and all(why.startswith("failed: rt-") for why in failed), failed
    # Frame 11 is not split off either when Slurm looks at frame 12, and is sometimes cancelled with it.
    beside = [bad.pop(id, "blocked") for id in ("merge-around-0011", "compare-same-0011")]
    assert all(why.startswith("blocked") for why in beside), beside
    assert bad == {id: f"blocked: {why}" for id, why in lost.items()}, f"{bad}\n{cluster.logs()}"
    ran = [id for id in lost if (trial.folder / "broken" / "logs" / f"{id}.log").exists()]
    assert not ran, f"ran in spite of what failed: {ran}"


def check_cancelled(trial, cluster):
    """A finished run that is handed in again and cancelled is not finished, and is left alone as long as it is queued."""
    environment = trial.environment | cluster.environment
    export = (sys.executable, trial.plan, "local.plan.json", "--slurm", "local-jobs", "--tools", trial.tools)
    trial.run(*export)
    submits = [subprocess.Popen(["sh", "local-jobs/submit.sh", "--hold"], cwd=trial.folder, env=environment) for _ in range(2)]
    codes = sorted(submit.wait() for submit in submits)
    assert codes == [0, 3], f"two submit.sh at once ended with {codes}"
    code, steps = trial.status(cluster, trial.folder / "local")
    assert code == 10 and all("(JobHeldUser)" in step["why"] or "(Dependency)" in step["why"] for step in steps), steps
    trial.run(*export, environment=environment, expect=3)
    trial.run(sys.executable, trial.plan, "run", "local.plan.json", "--tools", trial.tools, environment=environment, expect=3)
    trial.run("scancel", "--me", environment=environment)
    cluster.wait_for(lambda: not cluster.ask("squeue", "-h"), "the queue is not emptied", 60)
    code, steps = trial.status(cluster, trial.folder / "local")
    assert code == 1 and {step["state"] for step in steps} == {"blocked"}, steps
    script = trial.folder / "local-jobs" / "import-tent.sbatch"
    script.write_text(script.read_text().replace(sys.executable, "/no/python3"))
    trial.run("sh", "local-jobs/submit.sh", environment=environment)
    cluster.wait_for(lambda: not cluster.ask("squeue", "-h"), "the queue is not emptied", 60)
    code, steps = trial.status(cluster, trial.folder / "local")
    log = trial.folder / "local" / "logs" / "slurm-local.import-tent-1.log"
    assert code == 1 and steps[0]["why"] == f"ended before it could say why; see {log}" and "/no/python3" in log.read_text(), steps
    assert [step["why"] for step in steps[1:]] == ["import-tent blocked; its outputs are of an earlier run", "grid-tent blocked; its outputs are of an earlier run"], steps


def main():
    reason = why_not()
    if reason:
        print(f"skipped: {reason}; see pipelines/packages.txt")
        return 77
    plan, tools = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        trial = Trial(plan, tools, folder)
        (folder / "cluster").mkdir()
        begin = time.monotonic()
        (folder / "local.plan.json").write_text(json.dumps(LOCAL))
        trial.run(sys.executable, plan, "run", "local.plan.json", "--tools", tools)
        print(f"local run: {time.monotonic() - begin:.1f} s")
        folder.chmod(0o755)
        with SlurmCluster(folder / "cluster") as cluster:
            check(trial, run_with_faults(trial, cluster))
            check_failures(trial, cluster)
            check_cancelled(trial, cluster)
        code, steps = trial.status(cluster, folder / RUN)
        assert code == 0, f"without Slurm the finished run's status ends with {code}: {steps}"
    return 0


if __name__ == "__main__":
    sys.exit(main())
