"""Read a dataset as numpy arrays, view by view. Needs numpy and OpenCV, no renderer.

dataset = studies.dataset.open("DIR")
view = dataset[0]
view.depth        # (h, w) float32 [m], 0 = none
view.cause        # (h, w) uint8, codes of dataset.causes
view.arrays()     # all images of the view by name
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, SupportsIndex

import cv2
import numpy as np
from jaxtyping import Bool, Float

from studies.base.reading import reading
from studies.dataset.format.folders import DATASET, SPLIT, bounded_bytes, existing_dataset, read_json
from studies.dataset.format.layers import BY_FOLDER, FRAMES, Layer, decoded

MOST_PIXELS = 1280 * 720
"""Of an image: the largest stream profile."""


class Dataset(Sequence["DatasetView"]):
    """All views of a dataset; images are read when they are asked for."""

    def __init__(self, root: str | Path) -> None:
        """Read the list of views; InputError where there is no dataset."""
        self.root = existing_dataset(Path(root))
        with reading(self.root, f"run `franbv dataset check {root}`"):
            self.info: dict[str, Any] = read_json(self.root / DATASET)
            self._keys = [
                (folder, number)
                for folder in sorted(path for path in (self.root / SPLIT).glob("*") if _is_scene(path))
                for number in sorted(map(int, read_json(folder / "scene_camera.json")))
            ]

    @property
    def causes(self) -> dict[int, str]:
        """Names of the codes in label maps."""
        return {int(code): name for code, name in self.info["causes"].items()}

    @property
    def materials(self) -> list[str]:
        """Names of the numbers in material maps, from 1."""
        return self.info["materials"]

    def __len__(self) -> int:
        """Number of views."""
        return len(self._keys)

    def __getitem__(self, index: SupportsIndex | slice) -> "DatasetView":  # type: ignore[override]  # slices would hide what is read
        """One view; TypeError for a slice."""
        if isinstance(index, slice):
            raise TypeError("a dataset gives one view at a time; write [dataset[k] for k in range(...)]")
        return DatasetView(*self._keys[index])

    def __iter__(self) -> Iterator["DatasetView"]:
        """All views in order."""
        return (DatasetView(*key) for key in self._keys)


def _is_scene(path: Path) -> bool:
    """Whether this is a folder; ValueError for a link, which may lead anywhere."""
    if path.is_symlink():
        raise ValueError(f"{path}: is a link, not a scene's folder")
    return path.is_dir()


@dataclass(frozen=True)
class DatasetView:
    """One pose of one scene. Every layer of the card's table is an attribute: `view.depth`, `view.cause`..."""

    folder: Path
    """Of the scene."""
    number: int
    """Of the view in it."""

    def __getattr__(self, name: str) -> np.ndarray:
        """An image by its folder's name, in SI units, NaN for nothing."""
        if name not in BY_FOLDER or name == FRAMES.folder:
            raise AttributeError(f"a view has no {name}; its images are {', '.join(BY_FOLDER)}")
        return decoded(BY_FOLDER[name], self.raw(name))

    def raw(self, name: str) -> np.ndarray:
        """An image as it is stored."""
        layer = BY_FOLDER[name]
        return read_layer(self.folder / name / f"{self.number:06d}.png", layer)

    def arrays(self) -> dict[str, np.ndarray]:
        """All images of the view."""
        there = (name for name in BY_FOLDER if name != FRAMES.folder and (self.folder / name).is_dir())
        return {name: getattr(self, name) for name in there}

    @property
    def frames(self) -> Float[np.ndarray, "n h w"]:
        """The single depth frames [m]; ValueError where they were not kept."""
        paths = sorted((self.folder / FRAMES.folder).glob(f"{self.number:06d}_*.png"))
        if not paths:
            raise ValueError(f"{self.folder}: single frames were not kept; make the dataset with `keep_frames: true`")
        return np.stack([decoded(FRAMES, read_layer(path, FRAMES)) for path in paths])

    def masks(self, visible: bool = True) -> Bool[np.ndarray, "n h w"]:
        """What is seen of each object, or its whole silhouette."""
        folder = self.folder / ("mask_visib" if visible else "mask")
        paths = sorted(folder.glob(f"{self.number:06d}_*.png"))
        layer = Layer(folder.name, np.uint8, 1, "")
        shape = (0, *self.raw("depth").shape)
        return np.stack([read_layer(path, layer) > 0 for path in paths]) if paths else np.zeros(shape, bool)

    @cached_property
    def _scene(self) -> dict[str, Any]:
        return {name: read_json(self.folder / f"{name}.json") for name in ("scene_camera", "scene_gt", "scene")}

    @property
    def intrinsics(self) -> Float[np.ndarray, "3 3"]:
        """K of all full-size images [px]."""
        return np.array(self._scene["scene_camera"][str(self.number)]["cam_K"]).reshape(3, 3)

    @property
    def intrinsics_decimated(self) -> Float[np.ndarray, "3 3"]:
        """K of the decimated images, along the middle of each block [px]."""
        return np.array(self._scene["scene"]["K_decimated"]).reshape(3, 3)

    @property
    def T_world_cam(self) -> Float[np.ndarray, "4 4"]:  # noqa: N802  # the frame's name
        """Pose of the left imager [m]."""
        return np.array(self._scene["scene"]["draw"]["views"][self.number]["T_world_cam"])

    @property
    def objects(self) -> list[tuple[int, Float[np.ndarray, "4 4"]]]:
        """obj_id and pose T_cam_model of each object [m], in the order of the masks."""
        found = []
        for entry in self._scene["scene_gt"][str(self.number)]:
            pose = np.eye(4)
            pose[:3, :3] = np.array(entry["cam_R_m2c"]).reshape(3, 3)
            pose[:3, 3] = np.array(entry["cam_t_m2c"]) / 1000
            found.append((entry["obj_id"], pose))
        return found

    @property
    def bodies(self) -> list[dict[str, Any]]:
        """Name, material and object (-1 = none) of the numbers in the body map, from 1."""
        return self._scene["scene"]["bodies"]

    @property
    def draw(self) -> dict[str, Any]:
        """Everything that was drawn for the scene."""
        return self._scene["scene"]["draw"]


def read_layer(path: Path, layer: Layer) -> np.ndarray:
    """A PNG of this coding; ValueError where it is something else, larger than any stream, or in a linked folder."""
    if path.parent.is_symlink():
        raise ValueError(f"{path.parent}: is a link, which may lead anywhere")
    data = bounded_bytes(path)
    width, height = (int.from_bytes(data[k : k + 4], "big") for k in (16, 20))
    if not data.startswith(b"\x89PNG\r\n\x1a\n") or not 0 < width * height <= MOST_PIXELS:
        raise ValueError(f"{path}: is no PNG of at most {MOST_PIXELS} pixels")
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    channels = 0 if image is None else 1 if image.ndim == 2 else image.shape[2]
    if image is None or channels != layer.channels or image.dtype != layer.dtype:
        raise ValueError(f"{path}: is not a PNG of {layer.channels} channel(s) of {np.dtype(layer.dtype).name}")
    return image[..., ::-1] if image.ndim == 3 else image
