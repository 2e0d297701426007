"""Fails unless formats/scene.schema.json and rt-import agree on what a scene file may say.

check_scene_schema.py ROOT RT_IMPORT

The scene files of the repository and the examples of tools/rt-import/README.md follow the schema; rt-import takes each
document of GOOD, and neither takes one of BAD, which are GOOD with one thing changed. Every key of the schema is in GOOD.
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

import jsonschema

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent / "support"))
from changed_document import REMOVE, changed_document  # noqa: E402

TURNED = {"translate": [1, 2, 3], "rotate": {"axis": [0, 1, 0], "degrees": 30}, "scale": 2}
GOOD = {
    "$schema": "scene.schema.json",
    "units": "cm",
    "upAxis": "x",
    "models": [
        {"file": "t.obj", "transform": TURNED, "units": 0.1, "upAxis": "y",
         "instances": [{"rotate": [1, 2, 3]}, {"scale": [1, 2, 3], "materials": [{"match": "*", "ior": 2}]}],
         "lights": False, "cameras": True, "materials": [{"match": "*", "roughness": 1}]},
        {"file": "t.obj", "transform": {"matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1]}},
    ],
    "materials": [
        {"match": "stone", "baseColor": [0, 0.5, 1], "opacity": 0.5, "opacityCutoff": 0.25, "metallic": 0, "roughness": 0,
         "specular": 1, "mirror": 0, "transmission": 1, "ior": 1.5, "attenuationColor": 0.5, "attenuationDistance": 3,
         "emission": [0, 2, 30], "normalScale": -1, "thin": False, "unlit": False, "baseColorTexture": "i.ppm",
         "roughnessTexture": None, "normalTexture": None, "emissionTexture": "i.ppm", "transmissionTexture": None}
    ],
    "lights": [
        {"kind": "point", "position": [0, 1, 2], "intensity": 3},
        {"kind": "directional", "direction": [0, -1, 0], "intensity": [1, 2, 3]},
        {"kind": "spot", "position": [0, 1, 2], "lookAt": [0, 0, 0], "outerAngle": 30, "innerAngle": 20, "intensity": 0},
        {"kind": "rectangle", "position": [0, 1, 2], "direction": [0, 0, -1], "up": [0, 1, 0], "width": 1, "height": 2,
         "intensity": 1},
        {"kind": "sphere", "position": [0, 1, 2], "radius": 0.5, "intensity": 1},
    ],
    "cameras": [
        {"name": "a", "kind": "perspective", "eye": [0, 1, 9], "lookAt": [0, 1, 0], "up": [0, 1, 0], "fov": 30,
         "lensRadius": 0.1, "focus": 8},
        {"name": "b", "kind": "orthographic", "eye": [0, 1, 9], "lookAt": [0, 1, 0], "height": 2},
        {"name": "c", "kind": "panorama", "eye": [0, 1, 9], "lookAt": [0, 1, 0]},
        {"name": "d", "path": [{"frame": 1, "eye": [0, 1, 9], "lookAt": [0, 1, 0], "up": [0, 1, 0], "fov": 20}]},
    ],
    "environment": {"file": "e.hdr", "strength": 2, "turn": -30},
    "background": [0, 0, 0],
}  # fmt: skip
ALSO_GOOD = {"models": [{"file": "t.obj"}], "environment": {"color": 1}}
# Where GOOD is changed, and to what.
BAD = [
    (("model",), []),
    (("units",), "yard"),
    (("units",), 0),
    (("upAxis",), "w"),
    (("models", 0, "file"), REMOVE),
    (("models", 0, "file"), ""),
    (("models", 0, "name"), "x"),
    (("models", 0, "instances"), []),
    (("models", 0, "instances", 0, "lights"), False),
    (("models", 0, "instances", 1, "materials", 0, "match"), REMOVE),
    (("models", 0, "instances", 1, "matrix"), [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1]),
    (("models", 0, "transform", "materials"), []),
    (("models", 0, "lights"), 1),
    (("models", 0, "transform", "matrix"), [1] * 16),
    (("models", 1, "transform", "matrix", 0), "1"),
    (("models", 1, "transform", "matrix"), [1, 0, 0]),
    (("models", 0, "transform", "rotate"), 30),
    (("models", 0, "transform", "rotate", "angle"), 30),
    (("materials", 0, "match"), REMOVE),
    (("materials", 0, "ior"), 0.5),
    (("materials", 0, "metallic"), 2),
    (("materials", 0, "emission"), -1),
    (("materials", 0, "baseColor"), [0, 0]),
    (("materials", 0, "thin"), "yes"),
    (("materials", 0, "normalTexture"), 3),
    (("lights", 0, "radius"), 1),
    (("lights", 0, "kind"), "lamp"),
    (("lights", 0, "intensity"), REMOVE),
    (("lights", 2, "lookAt"), REMOVE),
    (("lights", 2, "direction"), [0, 0, 1]),
    (("lights", 3, "width"), 0),
    (("lights", 4, "radius"), REMOVE),
    (("cameras", 0, "name"), "x" * 64),
    (("cameras", 0, "fov"), 180),
    (("cameras", 0, "height"), 1),
    (("cameras", 0, "lookAt"), REMOVE),
    (("cameras", 1, "height"), REMOVE),
    (("cameras", 2, "fov"), 30),
    (("cameras", 3, "path"), []),
    (("cameras", 3, "path", 0, "frame"), REMOVE),
    (("cameras", 3, "path", 0, "lens"), 1),
    (("cameras", 3, "path", 0, "frame"), 1.5),
    (("cameras", 3, "path", 0, "frame"), -1),
    (("cameras", 3, "path", 0, "frame"), 1e18),
    (("environment", "color"), 1),
    (("environment", "file"), REMOVE),
    (("environment", "strength"), -1),
    (("background",), [1, 2]),
]


def objects_in(value):
    if isinstance(value, dict):
        yield value
    for part in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        yield from objects_in(part)


def keys_of(document):
    return {key for found in objects_in(document) for key in found}


def properties_of(schema):
    return {key for found in objects_in(schema) for key in found.get("properties", ())}


def documents(root):
    """(name, content) of the scene files of the repository and of the README's examples."""
    for path in sorted((root / "pipelines").rglob("*.scene.json")):
        yield path.name, json.loads(path.read_text())
    readme = (root / "tools/rt-import/README.md").read_text()
    for number, text in enumerate(re.findall(r"```json\n(.*?)```", readme, re.DOTALL)):
        yield f"README example {number}", json.loads(text)


def imported(rt_import, folder, document):
    (folder / "s.scene.json").write_text(json.dumps(document))
    command = [rt_import, folder / "s.scene.json", "-q", "-o", folder / "s.rtmesh"]
    result = subprocess.run(command, capture_output=True, text=True)
    if result.returncode not in (0, 3, 4):
        raise RuntimeError(f"rt-import ended with {result.returncode}: {result.stderr}")
    return result.returncode == 0, result.stderr.strip()


def write_models(folder):
    (folder / "t.obj").write_text("mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl stone\nf 1 2 3\n")
    (folder / "t.mtl").write_text("newmtl stone\n")
    (folder / "i.ppm").write_bytes(b"P6\n1 1\n255\n\x80\x80\x80")
    (folder / "e.hdr").write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x80\x80\x81")


def main(root, rt_import):
    schema = json.loads((root / "formats/scene.schema.json").read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    faults = [f"no document of this test has '{key}'" for key in properties_of(schema) - keys_of([GOOD, ALSO_GOOD])]
    shown = list(documents(root))
    if len(shown) < 2:
        faults.append("there are no examples to look at")
    faults += [f"{name}: {e.json_path}: {e.message}" for name, content in shown for e in validator.iter_errors(content)]
    cases = [("good", GOOD, True), ("also good", ALSO_GOOD, True)]
    cases += [(f"{place} = {'nothing' if value is REMOVE else value}", changed_document(GOOD, place, value), False) for place, value in BAD]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_models(folder)
        for what, document, wanted in cases:
            taken, said = imported(rt_import, folder, document)
            if validator.is_valid(document) != wanted:
                faults.append(f"{what}: the schema says {not wanted}")
            if taken != wanted:
                faults.append(f"{what}: rt-import {'takes it' if taken else 'says ' + said}")
    for fault in faults:
        print(fault)
    print(f"{len(shown)} examples, {len(cases)} documents, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1]), sys.argv[2]))
