"""A makefile for GNU Make 4.3, run as: make -C FOLDER -f FILE."""
import re
import shlex

from planner.errors import INVALID_CONTENT, PlanError

HEAD = """# Written by pipelines/plan; run with: make -C {folder} -f {file} -j 4
# Make knows time stamps only, so a step that finds its outputs up to date makes them look new (--touch).
.PHONY: all
all: {outputs}
"""


def make_text(graph, plan, folder, file):
    outputs = [path(output) for step in graph.steps for output in step.outputs]
    parts = [HEAD.format(folder=folder, file=file, outputs=" ".join(outputs))]
    parts += [f"{path(source)}:\n" for source in graph.sources()]
    command = shlex.join(plan).replace("$", "$$")
    for step in graph.steps:
        outputs = " ".join(map(path, step.outputs))
        inputs = " ".join(map(path, [*step.inputs, "plan.json"]))
        parts.append(f"{outputs} &: {inputs}\n\t{command} step . {step.token} --touch\n")
    parts += [f"-include {path(step.depfile)}\n" for step in graph.steps if step.depfile]
    return "\n".join(parts)


def path(text):
    """A name as Make reads it. Throws PlanError for one that Make cannot hold."""
    if re.search(r"[\s:;|&=]", text):
        raise PlanError(INVALID_CONTENT, f"{text}: Make cannot have such a name in a rule; rename it, or use Ninja")
    return re.sub(r"([#%*?\[\]~\\])", r"\\\1", text).replace("$", "$$")
