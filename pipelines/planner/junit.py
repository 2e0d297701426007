"""Steps as JUnit test cases."""
import xml.etree.ElementTree as ET

from planner.files import printable, tail


def suite(graph, folder, statuses):
    root = ET.Element("testsuite", name=graph.name, tests=str(len(statuses)), failures=str(sum(s.state == "failed" for s in statuses)),
                      skipped=str(sum(s.state not in ("done", "skipped", "failed") for s in statuses)))  # fmt: skip
    for status in statuses:
        case = ET.SubElement(root, "testcase", classname=f"{graph.name}.{status.step.group}", name=status.step.id,
                             time=f"{seconds(status):.3f}")  # fmt: skip
        if status.state == "failed":
            ET.SubElement(case, "failure", message=printable(status.why)).text = printable(tail(folder / status.step.log))
        elif status.state == "skipped":  # a gate whose inputs are those that it passed with
            ET.SubElement(case, "system-out").text = status.why
        elif status.state != "done":
            ET.SubElement(case, "skipped", message=printable(f"{status.state}: {status.why}"))
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def seconds(status):
    """Of all attempts together."""
    return sum(attempt["end"] - attempt["start"] for attempt in status.attempts if attempt.get("end"))
