"""Checks a document against the part of JSON Schema (2020-12) that plan.schema.json uses; errors name the JSON path."""
import re

TYPES = {"object": dict, "array": list, "string": str, "number": (int, float), "integer": int}
KNOWN = {
    "$schema", "$defs", "$ref", "title", "description", "default", "type", "enum", "anyOf", "pattern", "minLength", "maxLength",
    "minimum", "maximum", "items", "minItems", "maxItems", "properties", "required", "additionalProperties", "propertyNames",
    "minProperties",
}  # fmt: skip


def is_type(value, name):
    return isinstance(value, TYPES[name]) and not isinstance(value, bool)


def first_fault(value, schema, root, path="$"):
    """(JSON path, what is wrong there), or None."""
    unknown = schema.keys() - KNOWN
    assert not unknown, f"{path}: the schema uses {unknown}, which is not checked"
    faults = (check(value, schema, root, path) for check in (reference, plain, text, number, array, members))
    return next((fault for fault in faults if fault), None)


def reference(value, schema, root, path):
    if "$ref" not in schema:
        return None
    target = root
    for part in schema["$ref"].removeprefix("#/").split("/"):
        target = target[part]
    return first_fault(value, target, root, path)


def plain(value, schema, root, path):
    wanted = schema.get("type")
    if wanted and not is_type(value, wanted):
        return path, f"{shown(value)} is not {'an' if wanted[0] in 'aio' else 'a'} {wanted}"
    if "enum" in schema and value not in schema["enum"]:
        return path, f"{shown(value)} is none of {', '.join(schema['enum'])}"
    if "anyOf" in schema:
        faults = [first_fault(value, option, root, path) for option in schema["anyOf"]]
        # The alternative that came farthest is the one that was meant.
        return max(faults, key=lambda fault: len(fault[0])) if all(faults) else None
    return None


def text(value, schema, _, path):
    if not isinstance(value, str):
        return None
    if len(value) < schema.get("minLength", 0):
        return path, "is empty"
    if len(value) > schema.get("maxLength", len(value)):
        return path, f"{shown(value)} has more than {schema['maxLength']} characters"
    if "pattern" in schema and not re.search(schema["pattern"], value):
        return path, f"{shown(value)} does not match {schema['pattern']}"
    return None


def number(value, schema, _, path):
    if not is_type(value, "number"):
        return None
    if value < schema.get("minimum", value):
        return path, f"{value} is less than {schema['minimum']}"
    if value > schema.get("maximum", value):
        return path, f"{value} is more than {schema['maximum']}"
    return None


def array(value, schema, root, path):
    if not isinstance(value, list):
        return None
    if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
        return path, f"has {len(value)} items, wanted are {schema.get('minItems', 0)} to {schema.get('maxItems', 'any number')}"
    faults = (first_fault(item, schema.get("items", {}), root, f"{path}[{i}]") for i, item in enumerate(value))
    return next((fault for fault in faults if fault), None)


def members(value, schema, root, path):
    if not isinstance(value, dict):
        return None
    missing = [key for key in schema.get("required", ()) if key not in value]
    if missing:
        return path, f"'{missing[0]}' is missing"
    if len(value) < schema.get("minProperties", 0):
        return path, "is empty"
    properties, others = schema.get("properties", {}), schema.get("additionalProperties", {})
    for key, member in value.items():
        place = f"{path}.{key}"
        if key not in properties and others is False:
            return place, f"is not known here; known are {', '.join(properties)}"
        fault = first_fault(key, schema.get("propertyNames", {}), root, place)
        fault = fault or first_fault(member, properties.get(key, others), root, place)
        if fault:
            return fault
    return None


def shown(value):
    return repr(value) if isinstance(value, str) else type(value).__name__ if isinstance(value, (dict, list)) else str(value)
