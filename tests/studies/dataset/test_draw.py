"""What is drawn: every declared level sooner or later, nothing else; things at rest, the camera clear of them."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from scipy.spatial.transform import RigidTransform

from materials.material import Matte, RoughConductor
from studies.dataset.config import Camera, DatasetConfig, load_dataset_config
from studies.dataset.draw.built_scene import BUILT_IN_CLASSES, build_scene
from studies.dataset.draw.draw import CAMERA_CLEARANCE, draw_scene, drawn_exposure
from studies.dataset.draw.objects import object_pool
from studies.dataset.draw.weighted_draw import drawn_material, log_uniform, pick
from studies.dataset.make.manifest import head, measured_digests, recorded

DRAWS = 4000


def test_names_are_drawn_as_often_as_their_weights_say():
    """Shares of 1, 3 and 0 to within four standard deviations of a binomial."""
    rng = np.random.default_rng(0)
    drawn = [pick(rng, {"a": 1, "b": 3, "never": 0}) for _ in range(DRAWS)]
    assert set(drawn) == {"a", "b"}
    assert drawn.count("a") / DRAWS == pytest.approx(0.25, abs=4 * np.sqrt(0.25 * 0.75 / DRAWS))


def test_log_uniform_puts_half_below_the_geometric_mean():
    """Of 30 and 360 that is 104."""
    rng = np.random.default_rng(0)
    values = np.array([log_uniform(rng, (30, 360)) for _ in range(DRAWS)])
    assert 30 <= values.min() < values.max() <= 360
    assert np.mean(values < np.sqrt(30 * 360)) == pytest.approx(0.5, abs=4 * 0.5 / np.sqrt(DRAWS))


def test_the_default_draws_every_metal_and_finish_and_no_impossible_one():
    """Gold grows no oxide; roughness along and across the lay stays in the finish's ranges."""
    materials, rng = load_dataset_config("default").materials, np.random.default_rng(0)
    drawn = {drawn_material(rng, materials).partition("@")[0] for _ in range(DRAWS)}
    assert {spec.partition(":")[0] for spec in drawn if ":" in spec} == set(materials.metals)
    assert {spec.partition(":")[2] for spec in drawn if ":" in spec} == set(materials.finishes)
    assert "gold:oxidised" not in drawn
    assert {"own", *materials.non_metals} <= drawn


def test_things_rest_and_the_camera_is_clear_of_them():
    """Lowest corners at or above the table, the first object on it; the camera outside every object's box."""
    config = load_dataset_config("default")
    config = config.model_copy(update={"objects": config.objects.model_copy(update={"parts": {"A1": 1, "C1": 1}})})
    pool = object_pool(config)
    for scene in range(6):
        draw = draw_scene(config, pool, scene)
        boxes = []
        for thing in draw.objects:
            points = RigidTransform.from_matrix(np.array(thing.T_world_model)).apply(
                pool[thing.object_id - 1].mesh.vertices
            )
            boxes.append((points.min(axis=0), points.max(axis=0)))
        assert min(low[2] for low, _ in boxes) == pytest.approx(0, abs=1e-9)
        for view in draw.views:
            eye = np.array(view.T_world_cam)[:3, 3]
            assert eye[2] > 0
            for low, high in boxes:
                outside = np.linalg.norm(np.maximum(np.maximum(low - eye, eye - high), 0))
                assert outside >= CAMERA_CLEARANCE - 1e-9


def test_materials_of_the_user_are_drawn(small_config: Path, tmp_path: Path):
    """A metal of theirs without an oxide, a plastic and a grey card are drawn, and built as they are declared."""
    path = tmp_path / "own.yaml"
    user = """
  user:
    my_steel: {kind: metal, n: 2.91, k: 4.42, valid_nm: [400, 1000], source: ellipsometry}
    my_cover: {kind: plastic, n: 1.5, alpha: 0.1, reflectance: 0.3, source: integrating sphere}
    my_card: {kind: matte, reflectance: 0.4, source: grey card}
surroundings:"""
    text = small_config.read_text().replace("\nsurroundings:", user)
    for before, after in (
        ("{own: 0.3, metal: 0.7}", "{metal: 0.7, non_metal: 0.3}"),
        ("{brass: 1, iron: 1}", "{my_steel: 1}"),
        ("{polished: 1, milled: 1}", "{polished: 1, oxidised: 1}"),
        ("non_metals: {rubber: 1}", "non_metals: {my_cover: 1}"),
        ("tables: {wood_table: 1}", "tables: {my_card: 1}"),
    ):
        assert before in text
        text = text.replace(before, after)
    path.write_text(text)
    config = load_dataset_config(str(path))
    pool, user_materials = object_pool(config), config.materials.of_user
    made_of = set()
    for scene in range(8):
        bodies = build_scene(draw_scene(config, pool, scene), pool, user_materials).scene.bodies
        made_of |= {body.material for body in bodies if body.is_part}
        (table,) = (body for body in bodies if body.name == "table")
        assert table.material == Matte("my_card", 0.4)
    metals = [made for made in made_of if isinstance(made, RoughConductor)]
    assert {(made.n, made.k, made.name.partition("@")[0]) for made in metals} == {(2.91, 4.42, "my_steel:polished")}
    assert {made.name for made in made_of if made not in metals} == {"my_cover"}
    classes = head(config, pool, measured_digests(config))["materials"]
    assert classes[: len(BUILT_IN_CLASSES)] == list(BUILT_IN_CLASSES)
    assert classes[-2:] == ["my_cover", "my_card"]
    assert "my_steel:oxidised" not in classes
    assert len(set(classes)) == len(classes) <= 255
    assert DatasetConfig.model_validate(recorded(config).model_dump(mode="json")) == recorded(config)


def test_a_cad_file_joins_the_pool(small_config: Path, tmp_path: Path):
    """In metres, its origin in the middle of its box, of the stated material; found beside the configuration."""
    trimesh.creation.box((40, 30, 20)).export(tmp_path / "block.stl")
    path = tmp_path / "with_cad.yaml"
    cad = "cad: [{file: block.stl, units: mm, material: ['iron:milled'], weight: 5}], pile_parts"
    path.write_text(small_config.read_text().replace("pile_parts", cad))
    *_, block = object_pool(load_dataset_config(str(path)))
    assert (block.number, block.name, block.weight) == (3, "block.stl", 5)
    assert np.ptp(block.mesh.vertices, axis=0) == pytest.approx([0.04, 0.03, 0.02], abs=1e-6)
    assert np.abs(block.mesh.vertices).max(axis=0) == pytest.approx([0.02, 0.015, 0.01], abs=1e-6)
    assert {body.material.name for body in block.bodies} == {"iron:milled"}
    assert len(block.digest) == 16


@pytest.mark.parametrize("seed", range(5))
def test_fixed_exposures_cover_their_range(seed: int):
    """Of 100 scenes as many have one as are asked for, within the evenness of the sequence, and each of eight parts of
    the range (in logarithms) has some; a scene's depends on its number alone."""
    camera = Camera(auto_exposure=0.8, exposure_us=(2000.0, 33000.0))
    drawn = [drawn_exposure(camera, seed, scene) for scene in range(100)]
    fixed = [exposure for exposure in drawn if exposure is not None]
    assert abs(len(fixed) - 20) <= 4
    parts, _ = np.histogram(np.log(fixed), bins=8, range=(np.log(2000), np.log(33000)))
    assert parts.sum() == len(fixed)
    assert parts.min() >= 1
    assert drawn[::7] == [drawn_exposure(camera, seed, scene) for scene in range(0, 100, 7)]
