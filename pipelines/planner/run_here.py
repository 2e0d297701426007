"""Runs the steps of a graph on this machine: each after those that it depends on, and only if it is not up to date."""
import collections
import concurrent.futures
import contextlib
import os

from planner.devices import device_slots
from planner.errors import FILE_ACCESS, PlanError
from planner.files import open_lock, try_lock
from planner.freshness import is_current
from planner.run_step import read_record, run_step

RUN_LOCK = "run.lock"


@contextlib.contextmanager
def run_lock(folder):
    """Throws PlanError if `plan run` is at work there."""
    lock = open_lock(folder / RUN_LOCK)
    try:
        if not try_lock(lock):
            raise PlanError(FILE_ACCESS, f"{folder}: another run of it is at work; wait for its end, or name another folder with -o")
        yield
    finally:
        os.close(lock)


class Scheduler:
    """Steps with a GPU take a device each. The others share the cores where the description says how many each has; else a tool uses
    all of them, one at a time. Memory is not counted."""

    def __init__(self, graph, folder, versions, running, jobs):
        self.folder, self.versions, self.running = folder, versions, running
        self.slots = device_slots(os.environ)
        self.cores, devices = len(os.sched_getaffinity(0)), max(1, len(self.slots))
        self.free = collections.Counter(jobs=jobs or devices + self.cores, devices=devices, cores=self.cores)
        self.count, self.ended, self.error = len(graph.steps), 0, None
        self.awaited = {step.id: len(step.depends_on) for step in graph.steps}
        self.followers = collections.defaultdict(list)
        self.ready = {True: collections.deque(), False: collections.deque()}  # by whether a device is needed
        for step in graph.steps:
            for id in step.depends_on:
                self.followers[id].append(step)
            if not step.depends_on:
                self.ready[step.resources["gpus"] > 0].append(step)

    def run(self):
        """Steps that fail say so in their records. Throws PlanError if these cannot be written, after what was started has ended."""
        started = {}
        with concurrent.futures.ThreadPoolExecutor(self.free["jobs"]) as pool:
            while True:
                while step := self.start_next():
                    started[pool.submit(run_step, self.folder, step, self.running, self.versions[step.argv[0]])] = step
                if not started:
                    break
                for future in concurrent.futures.wait(started, return_when="FIRST_COMPLETED").done:
                    step = started.pop(future)
                    self.free.update(self.needs(step))
                    self.error = self.error or future.exception()
                    if not future.exception():
                        self.end(step, future.result()[-1])
        if self.error and not self.running.signals:
            raise self.error

    def start_next(self):
        """Takes what a step needs that can be started now and has to be, and returns it; or None."""
        while not self.error and not self.running.signals:
            queue = next((queue for queue in self.ready.values() if queue and self.needs(queue[0]) <= self.free), None)
            if not queue:
                return None
            step = queue.popleft()
            if not is_current(self.folder, step, read_record(self.folder, step), self.versions[step.argv[0]], self.slots):
                self.free.subtract(self.needs(step))
                return step
            self.release(step)
        return None

    def needs(self, step):
        cores = min(step.resources["cores"], self.cores) if "-j" in step.argv else self.cores
        return collections.Counter(jobs=1, **({"devices": 1} if step.resources["gpus"] else {"cores": cores}))

    def end(self, step, attempt):
        said = "failed: " if attempt["exitCode"] else ""
        log = f"  [{self.folder / step.log}]" if attempt["exitCode"] else ""
        why = attempt["why"] or f"{attempt['end'] - attempt['start']:.1f} s"
        if attempt["exitCode"] == 0:
            self.release(step)
        print(f"[{self.ended}/{self.count}] {step.id}: {said}{why}{log}", flush=True)

    def release(self, step):
        """Those that waited for it may start."""
        self.ended += 1
        for follower in self.followers[step.id]:
            self.awaited[follower.id] -= 1
            if self.awaited[follower.id] == 0:
                self.ready[follower.resources["gpus"] > 0].append(follower)
