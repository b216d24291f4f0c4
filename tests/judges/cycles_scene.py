"""Radiance of a scene of plain arrays by Blender's Cycles. A program of its own: it runs where `bpy` is, without ours.

    python cycles_scene.py SCENE.npz IMAGE.npy

SCENE.npz holds the numbers of every mesh and, as JSON in `description`, all else (`tests.judges.blender` writes it).
IMAGE.npy gets the radiance of every pixel, float32 (h, w), with the first row on top. Nothing of Cycles' that trades
truth for less noise is on: no clamp, no blurred lobes, no denoiser, no threshold below which light is left out.
"""

import json
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix


def main(scene_file: str, image_file: str) -> None:
    """Build the scene, render it, write the image."""
    with np.load(scene_file) as arrays:
        description = json.loads(str(arrays["description"]))
        bpy.ops.wm.read_factory_settings(use_empty=True)
        for number, body in enumerate(description["bodies"]):
            add_mesh(arrays[f"vertices_{number}"], arrays[f"faces_{number}"], surface(body))
    for lamp in description["lamps"]:
        add_mesh(np.array(lamp["corners"]), np.array([[0, 1, 2], [0, 2, 3]]), lambertian_lamp(lamp["radiance"]))
    for projector in description["projectors"]:
        add_mesh(np.array(projector["corners"]), np.array([[0, 1, 2], [0, 2, 3]]), even_projector(projector))
    add_camera(description["camera"])
    choose_settings(description["render"], description["camera"])
    np.save(image_file, render())


def add_mesh(vertices: np.ndarray, faces: np.ndarray, material: bpy.types.Material) -> None:
    """A body of flat triangles."""
    mesh = bpy.data.meshes.new("body")
    mesh.from_pydata(vertices.tolist(), [], faces.tolist())
    mesh.materials.append(material)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("body", mesh))


class Nodes:
    """The shader of one material, node by node."""

    def __init__(self, name: str) -> None:
        self.material = bpy.data.materials.new(name)
        if self.material.node_tree is None:  # Blender 5 makes one at once
            self.material.use_nodes = True
        self.tree = self.material.node_tree
        self.tree.nodes.clear()
        self.output = self.tree.nodes.new("ShaderNodeOutputMaterial")

    def add(self, kind: str, **settings) -> bpy.types.Node:
        """A node with these properties."""
        node = self.tree.nodes.new(kind)
        for name, value in settings.items():
            setattr(node, name, value)
        return node

    def math(self, operation: str, *values):
        """The number that an operation makes of numbers and sockets."""
        node = self.add("ShaderNodeMath", operation=operation)
        for socket, value in zip(node.inputs, values, strict=False):
            self.set(socket, value)
        return node.outputs[0]

    def dot(self, vector, constant):
        """Scalar product of a socket with a constant vector."""
        node = self.add("ShaderNodeVectorMath", operation="DOT_PRODUCT")
        self.set(node.inputs[0], vector)
        node.inputs[1].default_value = constant
        return node.outputs["Value"]

    def set(self, socket, value) -> None:
        """A number, or the output of another node."""
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        else:
            socket.default_value = value

    def done(self, shader: bpy.types.Node) -> bpy.types.Material:
        """The material whose surface this is."""
        self.tree.links.new(shader.outputs[0], self.output.inputs["Surface"])
        return self.material


def surface(body: dict) -> bpy.types.Material:
    """Lambertian, or a metal with complex index n + ik whose GGX alpha is the square of Blender's roughness."""
    nodes = Nodes(body["name"])
    if body["kind"] == "matte":
        shader = nodes.add("ShaderNodeBsdfDiffuse")
        shader.inputs["Color"].default_value = (*[body["reflectance"]] * 3, 1.0)
        shader.inputs["Roughness"].default_value = 0.0  # above 0 it is Oren and Nayar's
        return nodes.done(shader)
    shader = nodes.add("ShaderNodeBsdfMetallic", distribution="MULTI_GGX", fresnel_type="PHYSICAL_CONDUCTOR")
    shader.inputs["IOR"].default_value = [body["n"]] * 3
    shader.inputs["Extinction"].default_value = [body["k"]] * 3
    shader.inputs["Roughness"].default_value = body["alpha"] ** 0.5
    return nodes.done(shader)


def lambertian_lamp(radiance: float) -> bpy.types.Material:
    """Of one radiance towards the side of the normal, dark behind."""
    nodes = Nodes("lamp")
    shader = nodes.add("ShaderNodeEmission")
    behind = nodes.add("ShaderNodeNewGeometry").outputs["Backfacing"]
    nodes.set(shader.inputs["Strength"], nodes.math("MULTIPLY", nodes.math("SUBTRACT", 1.0, behind), radiance))
    return nodes.done(shader)


def even_projector(projector: dict) -> bpy.types.Material:
    """A small square that lights every plane across its axis evenly, within its field.

    A white wall at 1 m is to have radiance s: intensity pi s / cos^3 at an angle to the axis, so radiance
    pi s / (area cos^4).
    """
    nodes = Nodes("projector")
    towards = nodes.add("ShaderNodeNewGeometry").outputs["Incoming"]  # from the surface to where its light is asked for
    x, y, z = (nodes.dot(towards, axis) for axis in projector["axes"])
    ahead = nodes.math("GREATER_THAN", z, 1e-3)
    cosine = nodes.math("MAXIMUM", z, 1e-3)
    inside = ahead
    for across, half in zip((x, y), projector["half_field"], strict=True):
        tangent = nodes.math("ABSOLUTE", nodes.math("DIVIDE", across, cosine))
        inside = nodes.math("MULTIPLY", inside, nodes.math("LESS_THAN", tangent, half))
    strength = nodes.math("DIVIDE", np.pi * projector["mean"] / projector["area"], nodes.math("POWER", cosine, 4.0))
    shader = nodes.add("ShaderNodeEmission")
    nodes.set(shader.inputs["Strength"], nodes.math("MULTIPLY", strength, inside))
    return nodes.done(shader)


def add_camera(camera: dict) -> None:
    """A pinhole. `T_world_cam` has the image's axes: x right, y down, z forward; Blender's camera looks along -z."""
    width, height, fx, cx, cy = (camera[name] for name in ("width", "height", "fx", "cx", "cy"))
    data = bpy.data.cameras.new("camera")
    data.sensor_fit, data.sensor_width = "HORIZONTAL", 36.0
    data.lens = fx * data.sensor_width / width
    data.shift_x = ((width - 1) / 2 - cx) / width
    data.shift_y = (cy - (height - 1) / 2) / width
    data.clip_start, data.clip_end = 1e-3, 1e3
    placed = bpy.data.objects.new("camera", data)
    placed.matrix_world = Matrix(camera["T_world_cam"]) @ Matrix.Diagonal((1.0, -1.0, -1.0, 1.0))
    bpy.context.scene.collection.objects.link(placed)
    bpy.context.scene.camera = placed


def choose_settings(wanted: dict, camera: dict) -> None:
    """Plain path tracing with boxes for pixels."""
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("dark")
    scene.world.color = (0.0, 0.0, 0.0)
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = camera["width"], camera["height"]
    scene.render.resolution_percentage = 100
    scene.render.threads_mode, scene.render.threads = "FIXED", wanted["threads"]
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.seed = "CPU", wanted["samples"], 1
    cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_fast_gi = cycles.use_guiding = False
    cycles.pixel_filter_type = "BOX"
    cycles.light_sampling_threshold = cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.blur_glossy = 0.0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = wanted["bounces"]
    cycles.film_exposure = 1.0


def render() -> np.ndarray:
    """Linear radiance, by way of an EXR file of 32 bits, the one lossless way out of a Blender without windows."""
    scene = bpy.context.scene
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.image_settings.color_mode = "RGB"
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder) / "image.exr")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        width, height = image.size
        pixels = np.zeros(width * height * image.channels, np.float32)
        image.pixels.foreach_get(pixels)
    return pixels.reshape(height, width, -1)[::-1, :, 0].copy()


if __name__ == "__main__":
    main(*sys.argv[1:])
