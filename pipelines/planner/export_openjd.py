"""A job template of Open Job Description, version jobtemplate-2023-09."""
import json
import os

from planner.errors import INVALID_CONTENT, PlanError
from planner.graph import CHUNK, RETRIES

NAME_LIMIT, JOB_NAME_LIMIT, PATH_LIMIT = 64, 128, 1024


def openjd_text(graph, plan, folder, file):
    if len(graph.name) > JOB_NAME_LIMIT:
        raise PlanError(INVALID_CONTENT, f"{graph.name}: Open Job Description has job names of {JOB_NAME_LIMIT} characters at most; shorten it")
    if any("{{" in text for text in (graph.name, *plan)):
        raise PlanError(INVALID_CONTENT, f"{graph.name}, {plan[-1]}: Open Job Description takes {{{{ for its own in names; rename it")
    template = {
        "specificationVersion": "jobtemplate-2023-09",
        "name": graph.name,
        "parameterDefinitions": [folder_parameter(folder, file)],
        "steps": steps_of(graph, plan),
    }
    return json.dumps(template, indent=1) + "\n"


def folder_parameter(folder, file):
    """Its default counts from the template's folder, and may not lead out of it; elsewhere, who submits the job names it."""
    parameter = {
        "name": "Folder", "type": "PATH", "objectType": "DIRECTORY", "dataFlow": "INOUT",
        "description": f"The run's folder, which holds plan.json; all workers see it. It was written to {folder}"[:2048],
    }  # fmt: skip
    default = os.path.relpath(folder, os.path.realpath(file.parent))
    is_inside = not default.startswith("..") and len(default) <= PATH_LIMIT
    return parameter | ({"default": default} if is_inside else {})


def steps_of(graph, plan):
    group_of = {step.id: step.group for step in graph.steps}
    names, templates = {}, []  # of each group, in order
    for group, steps in graph.groups().items():
        awaited = {group_of[id] for step in steps for id in step.depends_on}
        awaited = [name for other in names if other in awaited for name in names[other]]
        parts = [steps[i : i + CHUNK] for i in range(0, len(steps), CHUNK)]
        names[group] = [step_name(group, i) for i in range(len(parts))]
        templates += [step_template(name, part, awaited, plan) for name, part in zip(names[group], parts)]
    return templates


def step_name(group, i):
    name = f"{group}-{i + 1}" if i else group
    if len(name) > NAME_LIMIT:
        raise PlanError(INVALID_CONTENT, f"{name}: Open Job Description has names of {NAME_LIMIT} characters at most; shorten it")
    return name


def step_template(name, steps, awaited, plan):
    needs = steps[0].resources
    amounts = {"amount.worker.vcpu": needs["cores"], "amount.worker.memory": needs["memory"], "amount.worker.gpu": needs["gpus"]}
    action = {
        "command": plan[0],
        "args": [*plan[1:], "step", "{{Param.Folder}}", "{{Task.Param.Step}}", "--retries", str(RETRIES)],
        "timeout": needs["minutes"] * 60,
        "cancelation": {"mode": "NOTIFY_THEN_TERMINATE", "notifyPeriodInSeconds": 10},
    }
    template = {
        "name": name,
        "hostRequirements": {"amounts": [{"name": key, "min": value} for key, value in amounts.items() if value]},
        "parameterSpace": {
            "taskParameterDefinitions": [{"name": "Step", "type": "STRING", "range": [step.token for step in steps]}]
        },
        "script": {"actions": {"onRun": action}},
    }
    return template | ({"dependencies": [{"dependsOn": other} for other in awaited]} if awaited else {})
