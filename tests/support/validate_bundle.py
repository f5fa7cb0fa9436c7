#!/usr/bin/python3
"""validate_bundle.py SCHEMA BUNDLE...: holds what bundles say against the schema of the extension.

Readers ignore properties that they do not know, and so does the schema. What this program writes must all be in it,
though: here objects with properties that the schema does not name are errors. Exit status: 0 no errors, 1 errors
(printed), 77 skipped, since there is no jsonschema (Debian: python3-jsonschema).
"""
import json
import struct
import sys

try:
    import jsonschema
except ImportError:
    print("skipped: python3 has no jsonschema (Debian: python3-jsonschema)")
    sys.exit(77)

NAME = "LAMBENT_radiance_transfer"


def close(schema):
    """Makes every object of the schema refuse properties that it does not name."""
    if isinstance(schema, dict):
        if schema.get("type") == "object" and "properties" in schema:
            schema.setdefault("additionalProperties", False)
        for value in schema.values():
            close(value)
    elif isinstance(schema, list):
        for value in schema:
            close(value)


def document(path):
    with open(path, "rb") as file:
        magic, _, _, length, kind = struct.unpack("<4s4I", file.read(20))
        assert magic == b"glTF" and kind == 0x4E4F534A, f"{path} is no GLB"
        return json.loads(file.read(length))


def main(schema_path, *bundles):
    with open(schema_path) as file:
        schema = json.load(file)
    jsonschema.Draft202012Validator.check_schema(schema)
    close(schema)
    whole = jsonschema.Draft202012Validator(schema)
    primitive = jsonschema.Draft202012Validator({**schema["$defs"]["primitive"], "$defs": schema["$defs"]})
    failed = False
    for bundle in bundles:
        gltf = document(bundle)
        errors = list(whole.iter_errors(gltf["extensions"][NAME]))
        for mesh in gltf.get("meshes", []):
            for part in mesh["primitives"]:
                errors += primitive.iter_errors(part["extensions"][NAME])
        print(f"{bundle}: {len(errors)} errors")
        for error in errors[:20]:
            print(f"  /{'/'.join(map(str, error.absolute_path))}: {error.message[:300]}")
        failed = failed or bool(errors)
    sys.exit(1 if failed else 0)


main(*sys.argv[1:])
