"""A job template of Open Job Description, version jobtemplate-2023-09."""
import json

from planner.errors import INVALID_CONTENT, PlanError
from planner.graph import RETRIES

NAME_LIMIT = 64


def openjd_text(graph, plan, folder):
    template = {
        "specificationVersion": "jobtemplate-2023-09",
        "name": graph.name,
        "parameterDefinitions": [
            {"name": "Folder", "type": "PATH", "objectType": "DIRECTORY", "dataFlow": "INOUT", "default": str(folder),
             "description": "The run's folder, which holds plan.json; all workers see it"},
        ],
        "steps": steps_of(graph, plan),
    }  # fmt: skip
    return json.dumps(template, indent=1) + "\n"


def steps_of(graph, plan):
    chunks = graph.chunks()
    dependencies = graph.group_dependencies()
    steps = []
    for group, parts in chunks.items():
        awaited = [step_name(other, i) for other in dependencies[group] for i in range(len(chunks[other]))]
        steps += [step_template(step_name(group, i), part, awaited, plan) for i, part in enumerate(parts)]
    return steps


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
