"""Run by Blender (blender_check.sh): imports an exported file, renders one frame from a camera of the viewer, with the texture alone.

    blender --background --factory-startup --python blender_view.py -- FILE PICTURE WIDTH HEIGHT FOV_DEG PX PY PZ TX TY TZ
    blender --background --factory-startup --python blender_view.py -- FILE PICTURE WIDTH HEIGHT

FILE is a .glb or .obj; place and target are in the file's frame of reference, in metres with +Z up. Without them: the camera of the .glb.
The background is transparent.
"""
import math
import sys

import bpy
import numpy
from mathutils import Vector

if "bool" not in numpy.__dict__:
    numpy.bool = bool  # Debian's Blender 3.4 reads glTF with a name that Debian's NumPy 1.24 no longer has

argv = sys.argv[sys.argv.index("--") + 1:]
source, picture = argv[0], argv[1]
width, height = int(argv[2]), int(argv[3])
view = list(map(float, argv[4:11]))
RATE = 30

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.fps = RATE
if source.endswith(".glb"):
    bpy.ops.import_scene.gltf(filepath=source)
else:
    bpy.ops.wm.obj_import(filepath=source, forward_axis="Y", up_axis="Z")
scene.frame_set(0)

# The texture alone: what an unlit material shows.
for material in bpy.data.materials:
    images = [node.image for node in (material.node_tree.nodes if material.node_tree else []) if node.type == "TEX_IMAGE"]
    if not images:
        continue
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = images[0]
    emission = nodes.new("ShaderNodeEmission")
    output = nodes.new("ShaderNodeOutputMaterial")
    links.new(texture.outputs["Color"], emission.inputs["Color"])
    links.new(emission.outputs["Emission"], output.inputs["Surface"])

if view:
    place, target = Vector(view[1:4]), Vector(view[4:7])
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(camera)
    camera.location = place
    camera.rotation_euler = (target - place).to_track_quat("-Z", "Y").to_euler()
    camera.data.sensor_fit = "VERTICAL"
    camera.data.angle_y = math.radians(view[0])
else:
    camera = next(thing for thing in scene.objects if thing.type == "CAMERA")
scene.camera = camera

scene.render.engine = "CYCLES"
scene.cycles.device = "CPU"
scene.cycles.samples = 16
scene.cycles.use_denoising = False
scene.cycles.max_bounces = 0
scene.cycles.pixel_filter_type = "BOX"
scene.render.film_transparent = True
scene.render.resolution_x, scene.render.resolution_y = width, height
scene.view_settings.view_transform = "Standard"
scene.render.filepath = picture
bpy.ops.render.render(write_still=True)
meshes = [o for o in scene.objects if o.type == "MESH"]
shown = [o.name for o in meshes if o.matrix_world.to_scale().length > 0.1]
print(f"blender: {len(meshes)} meshes, shown: {', '.join(shown)}")
