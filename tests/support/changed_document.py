"""A JSON document with one thing changed, for tests of what says no to it."""
import copy

REMOVE = object()


def changed_document(document, place, value):
    """`document` with `value`, or nothing for REMOVE, at `place`, a tuple of keys and indices."""
    document = copy.deepcopy(document)
    *way, last = place
    parent = document
    for step in way:
        parent = parent[step]
    if value is REMOVE:
        del parent[last]
    else:
        parent[last] = value
    return document
