"""A build file for Ninja, run as: ninja -C FOLDER -f FILE."""
import re
import shlex

HEAD = """# Written by pipelines/plan; run with: ninja -C {folder} -f {file}
ninja_required_version = 1.10

# A tool without a device of its own uses all cores: one at a time. The others wait for a device each.
pool cores
  depth = 1

rule step
  command = {plan} step . $step
  description = $step
  restat = 1
"""


def ninja_text(graph, plan, folder, file):
    parts = [HEAD.format(folder=folder, file=file, plan=escaped(shlex.join(plan)))]
    parts += [f"build {path(source)}: phony\n" for source in graph.sources()]
    parts += [edge(step) for step in graph.steps]
    return "\n".join(parts)


def edge(step):
    outputs = " ".join(map(path, step.outputs))
    program = [step.argv[0]] if "/" in step.argv[0] else []
    lines = [f"build {outputs}: step {' '.join(map(path, step.inputs))} | {' '.join(map(path, program))}".rstrip(" |")]
    lines.append(f"  step = {step.token}")
    if step.depfile:
        lines.append(f"  depfile = {path(step.depfile)}")
    if step.resources["gpus"] == 0:
        lines.append("  pool = cores")
    return "\n".join(lines) + "\n"


def escaped(text):
    return text.replace("$", "$$")


def path(text):
    return re.sub(r"([$ :])", r"$\1", text)
