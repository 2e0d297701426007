"""The arrays of a run's jobs in Slurm, and which of them wait for which."""
import collections
import dataclasses

from planner.graph import CHUNK


def slurm_log(folder, name):
    """Slurm's own log of a job, less "-TASK.log": of what happens before and after `plan step`."""
    return f"{folder}/logs/slurm-{name}"


@dataclasses.dataclass
class Array:
    name: str
    steps: list
    after_all: list  # numbers of arrays that have to end well as a whole
    after_each: list  # of arrays of which each task awaits the one in its own place only


def arrays_of(graph):
    """In order. Of the shards of several frames, an array has one of each, so that a merge waits for those of its own frame only."""
    groups = graph.groups()
    group_of = {step.id: step.group for step in graph.steps}
    merges = [steps for steps in groups.values() if steps[0].stage == "merge" and len(steps) > 1]
    shard_counts = {group_of[steps[0].depends_on[0]]: len(steps[0].depends_on) for steps in merges}  # by the group of the shards
    arrays, positions = [], {}  # of a step: (number of its array, place there)
    for group, steps in groups.items():
        count = shard_counts.get(group, 1)
        for start in range(0, len(steps), count * CHUNK):
            for shard in range(count):
                part = steps[start + shard : start + count * CHUNK : count]
                name = group + (f".{shard + 1}of{count}" if count > 1 else "") + (f".{start // (count * CHUNK) + 1}" if start else "")
                positions |= {step.id: (len(arrays), place) for place, step in enumerate(part)}
                arrays.append(Array(name, part, *awaited_by(part, positions, arrays)))
    return arrays


def awaited_by(steps, positions, arrays):
    """(after_all, after_each)."""
    shifts = collections.defaultdict(set)  # number of an array: how far its tasks are from those that await them
    for i, step in enumerate(steps):
        for id in step.depends_on:
            number, place = positions[id]
            shifts[number].add(i - place)
    each = [number for number in shifts if shifts[number] == {0} and len(arrays[number].steps) > 1]
    return [number for number in shifts if number not in each], each
