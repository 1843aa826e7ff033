#!/usr/bin/env python3
"""Writes a small model person as glTF, or a motion as BVH, for rows of the table of causes.

    make_model.py FILE.gltf|FILE.bvh [names=mixamo|unknown] [units_per_m=1] [up=y|z] [skin=1] [animation=1] [mesh=1] [colour=0.5]
                  [picture=NAME]
"""

import base64
import json
import struct
import sys

# name of Mixamo, parent, place (+Y up, facing +Z)
JOINTS = [("mixamorig:Hips", -1, (0, 0.95, 0)), ("mixamorig:Spine", 0, (0, 1.1, 0)), ("mixamorig:Neck", 1, (0, 1.5, 0)),
          ("mixamorig:Head", 2, (0, 1.6, 0)), ("mixamorig:LeftArm", 1, (0.2, 1.45, 0)), ("mixamorig:LeftForeArm", 4, (0.5, 1.45, 0)),
          ("mixamorig:RightArm", 1, (-0.2, 1.45, 0)), ("mixamorig:RightForeArm", 6, (-0.5, 1.45, 0)),
          ("mixamorig:LeftUpLeg", 0, (0.1, 0.9, 0)), ("mixamorig:LeftLeg", 8, (0.1, 0.5, 0)), ("mixamorig:LeftFoot", 9, (0.1, 0.08, 0)),
          ("mixamorig:RightUpLeg", 0, (-0.1, 0.9, 0)), ("mixamorig:RightLeg", 11, (-0.1, 0.5, 0)),
          ("mixamorig:RightFoot", 12, (-0.1, 0.08, 0))]
# joint and box of each part of the body
PARTS = [(0, (-0.15, 0.85, -0.1), (0.15, 1.1, 0.1)), (1, (-0.18, 1.1, -0.1), (0.18, 1.5, 0.1)), (3, (-0.09, 1.5, -0.1), (0.09, 1.8, 0.1)),
         (4, (0.18, 1.4, -0.05), (0.5, 1.5, 0.05)), (5, (0.5, 1.4, -0.05), (0.85, 1.5, 0.05)), (6, (-0.5, 1.4, -0.05), (-0.18, 1.5, 0.05)),
         (7, (-0.85, 1.4, -0.05), (-0.5, 1.5, 0.05)), (8, (0.02, 0.5, -0.08), (0.18, 0.85, 0.08)), (9, (0.02, 0.0, -0.08), (0.18, 0.5, 0.08)),
         (11, (-0.18, 0.5, -0.08), (-0.02, 0.85, 0.08)), (12, (-0.18, 0.0, -0.08), (-0.02, 0.5, 0.08))]
FACES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


class Gltf:
    def __init__(self):
        self.buffer = b""
        self.views = []
        self.accessors = []

    def add(self, values, code, component, kind, width, **extra):
        data = struct.pack(f"<{len(values)}{code}", *values)
        self.views.append({"buffer": 0, "byteOffset": len(self.buffer), "byteLength": len(data)})
        self.accessors.append({"bufferView": len(self.views) - 1, "componentType": component, "count": len(values) // width,
                               "type": kind, **extra})
        self.buffer += data + b"\0" * (-len(data) % 4)
        return len(self.accessors) - 1


def turned(p, options):
    scale = float(options["units_per_m"])
    p = [scale * x for x in p]
    return [p[0], -p[2], p[1]] if options["up"] == "z" else p


def names(options):
    return [f"node_{i}" if options["names"] == "unknown" else joint[0] for i, joint in enumerate(JOINTS)]


def gltf(options):
    out = Gltf()
    positions, places, joints, indices = [], [], [], []
    for joint, low, high in PARTS:
        first = len(positions) // 3
        for i in range(8):
            corner = [(high if i >> axis & 1 else low)[axis] for axis in range(3)]
            positions += turned(corner, options)
            places += [i & 1, i >> 1 & 1]
            joints += [joint, 0, 0, 0]
        for a, b, c, d in FACES:
            indices += [first + k for k in (a, b, c, a, c, d)]
    attributes = {"POSITION": out.add(positions, "f", 5126, "VEC3", 3), "TEXCOORD_0": out.add(places, "f", 5126, "VEC2", 2)}
    nodes = []
    for i, (_, parent, at) in enumerate(JOINTS):
        node = {"name": names(options)[i], "translation": turned(minus(at, JOINTS[parent][2]) if parent >= 0 else at, options)}
        children = [c for c, other in enumerate(JOINTS) if other[1] == i]
        if children:
            node["children"] = children
        nodes.append(node)
    model = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": nodes}
    body = {"name": "body", "mesh": 0}
    if options["skin"] == "1":
        attributes["JOINTS_0"] = out.add(joints, "B", 5121, "VEC4", 4)
        attributes["WEIGHTS_0"] = out.add([1.0, 0.0, 0.0, 0.0] * (len(joints) // 4), "f", 5126, "VEC4", 4)
        inverses = []
        for _, _, at in JOINTS:
            inverses += [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0] + [-x for x in turned(at, options)] + [1]
        model["skins"] = [{"joints": list(range(len(JOINTS))), "inverseBindMatrices": out.add(inverses, "f", 5126, "MAT4", 16)}]
        body["skin"] = 0
    if options["mesh"] == "1":
        nodes.append(body)
        model["scenes"][0]["nodes"].append(len(nodes) - 1)
        model["meshes"] = [{"primitives": [{"attributes": attributes, "indices": out.add(indices, "I", 5125, "SCALAR", 1), "material": 0}]}]
        look = {"baseColorFactor": [float(options["colour"])] * 3 + [1]}
        if options["picture"]:
            look["baseColorTexture"] = {"index": 0}
            model["textures"] = [{"source": 0}]
            model["images"] = [{"uri": options["picture"]}]
        model["materials"] = [{"pbrMetallicRoughness": look}]
    if options["animation"] == "1":
        times = out.add([0.0, 1.0], "f", 5126, "SCALAR", 1, min=[0.0], max=[1.0])
        turns = out.add([0, 0, 0, 1, 0, 0, 0.7071068, 0.7071068], "f", 5126, "VEC4", 4)
        model["animations"] = [{"name": "raise", "samplers": [{"input": times, "output": turns}],
                                "channels": [{"sampler": 0, "target": {"node": 4, "path": "rotation"}}]}]
    model["accessors"], model["bufferViews"] = out.accessors, out.views
    model["buffers"] = [{"byteLength": len(out.buffer),
                         "uri": "data:application/octet-stream;base64," + base64.b64encode(out.buffer).decode()}]
    return json.dumps(model)


def bvh(options):
    lines, order = [], []

    def add(joint):
        order.append(joint)
        _, parent, at = JOINTS[joint]
        offset = minus(at, JOINTS[parent][2]) if parent >= 0 else (0, 0, 0)
        name = names(options)[joint].replace("mixamorig:", "")
        channels = "6 Xposition Yposition Zposition" if parent < 0 else "3"
        lines.extend([("ROOT " if parent < 0 else "JOINT ") + name, "{", "OFFSET " + " ".join(str(100 * x) for x in offset),
                      f"CHANNELS {channels} Zrotation Yrotation Xrotation"])
        children = [c for c, other in enumerate(JOINTS) if other[1] == joint]
        for child in children:
            add(child)
        if not children:
            lines.extend(["End Site", "{", "OFFSET 0 10 0", "}"])
        lines.append("}")

    add(0)
    lines.extend(["MOTION", "Frames: 2", "Frame Time: 0.5"])
    for frame in range(2):
        lines.append(" ".join(("0 95 0 " if joint == 0 else "") + f"{60 * frame if joint == 4 else 0} 0 0" for joint in order))
    return "HIERARCHY\n" + "\n".join(lines) + "\n"


def main():
    options = {"names": "mixamo", "units_per_m": "1", "up": "y", "skin": "1", "animation": "1", "mesh": "1", "colour": "0.5", "picture": ""}
    for argument in sys.argv[2:]:
        key, _, value = argument.partition("=")
        if key not in options:
            sys.exit(f"make_model.py: unknown option {key}")
        options[key] = value
    with open(sys.argv[1], "w", encoding="utf-8") as stream:
        stream.write(bvh(options) if sys.argv[1].endswith(".bvh") else gltf(options))


main()
