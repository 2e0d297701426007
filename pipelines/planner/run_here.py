"""Runs the steps of a graph on this machine: each after those that it depends on, and only if it is not up to date."""
import collections
import concurrent.futures
import os

from planner.devices import device_slots
from planner.errors import FILE_ACCESS, PlanError
from planner.files import open_lock, try_lock
from planner.freshness import is_current
from planner.run_step import read_record, run_step


def run_graph(graph, folder, versions, running, jobs):
    """Steps that fail say so in their records. Throws PlanError if these cannot be written, after what was started has ended."""
    lock = open_lock(folder / "run.lock")
    try:
        if not try_lock(lock):
            raise PlanError(FILE_ACCESS, f"{folder}: another run of it is at work; wait for its end, or name another folder with -o")
        Scheduler(graph, folder, versions, running, jobs).run()
    finally:
        os.close(lock)


class Scheduler:
    """Steps with a GPU take a device each; the others share the cores, as their resources say."""

    def __init__(self, graph, folder, versions, running, jobs):
        self.folder, self.versions, self.running = folder, versions, running
        self.slots = device_slots(os.environ)
        self.free_devices = max(1, len(self.slots))
        self.cores = self.free_cores = len(os.sched_getaffinity(0))
        self.free_jobs = jobs or self.free_devices + self.cores
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
        started = {}
        with concurrent.futures.ThreadPoolExecutor(self.free_jobs) as pool:
            while True:
                while step := self.next_step():
                    self.take(step, 1)
                    started[pool.submit(run_step, self.folder, step, self.running, self.versions[step.argv[0]])] = step
                if not started:
                    break
                for future in concurrent.futures.wait(started, return_when="FIRST_COMPLETED").done:
                    step = started.pop(future)
                    self.take(step, -1)
                    self.error = self.error or future.exception()
                    if not future.exception():
                        self.end(step, future.result()[-1])
        if self.error and not self.running.signals:
            raise self.error

    def next_step(self):
        """One that can be started now and has to be, or None."""
        while not self.error and not self.running.signals:
            queue = next((queue for queue in self.ready.values() if queue and self.fits(queue[0])), None)
            if not queue:
                return None
            step = queue.popleft()
            if not is_current(self.folder, step, read_record(self.folder, step), self.versions[step.argv[0]], self.slots):
                return step
            self.release(step)
        return None

    def fits(self, step):
        return self.free_jobs > 0 and (self.free_devices if step.resources["gpus"] else self.free_cores) >= self.cost(step)

    def take(self, step, times):
        self.free_jobs -= times
        if step.resources["gpus"]:
            self.free_devices -= times * self.cost(step)
        else:
            self.free_cores -= times * self.cost(step)

    def cost(self, step):
        return 1 if step.resources["gpus"] else min(step.resources["cores"], self.cores)

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
