"""One small dataset that all tests of datasets read: four views of two scenes, metal and rubber, made once."""

import shutil
from pathlib import Path

import pytest

from studies.cli.main import main

SMALL = """
title: Small
seed: 3
views: 4
n_frames: 2
keep_frames: true
objects: {parts: {A1: 1, C1: 1}, arrangement: {single: 0.3, pile: 0.7}, pile_parts: [2, 2]}
materials:
  kind: {own: 0.3, metal: 0.7}
  metals: {brass: 1, iron: 1}
  finishes: {polished: 1, milled: 1}
  non_metals: {rubber: 1}
surroundings:
  tables: {wood_table: 1}
  lamps: {workshop: 1, "off": 1}
  clutter: [1, 2]
  clutter_materials: {rubber: 1}
camera: {profiles: {424x240: 1}}
poses: {per_scene: 2, elevation_deg: [35, 70], distance_m: [0.3, 0.4]}
rendering: {glossy_paths: 8}
"""


@pytest.fixture(scope="session")
def small_config(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The configuration as a file."""
    path = tmp_path_factory.mktemp("config") / "small.yaml"
    path.write_text(SMALL)
    return path


@pytest.fixture(scope="session")
def small_dataset(small_config: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The dataset, made by one worker; tests that change it copy it."""
    folder = tmp_path_factory.mktemp("made") / "small"
    assert main(["dataset", "make", str(small_config), str(folder), "--workers", "1"]) == 0
    return folder


@pytest.fixture
def dataset(small_dataset: Path, tmp_path: Path) -> Path:
    """A copy that a test may spoil."""
    return Path(shutil.copytree(small_dataset, tmp_path / "copy"))
