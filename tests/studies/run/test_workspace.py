"""Whether the planner's map can hold a part: too wide, too tall, or so flat that it counts as table."""

import re

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from franbv.object_model import above_table
from franbv.parameters import Parameters
from franbv.voxel_map import empty_map
from materials.catalog import material
from materials.input_error import InputError
from scenes.primitives import box, moved
from scenes.scene import Body, Scene
from studies.run.reconstruct import check_workspace


def sheet(height: float) -> Scene:
    """A sheet of 100 x 60 mm of this height [m], lying on the table."""
    lying = moved(box((0.1, 0.06, height)), RigidTransform.from_translation([0, 0, height / 2]))
    return Scene("sheet", (Body("sheet", lying, material("white_paint"), is_part=True),), (), 0.0)


def top_is_mapped(height: float, parameters: Parameters) -> bool:
    """Whether the voxel in which the sheet's top lies counts as object, asked from the map itself."""
    voxel_map = empty_map(parameters)
    index, inside = voxel_map.indices(np.array([[0.0, 0.0, height]]))
    layer = int(index[0, 2]) if inside[0] else -1
    return bool(above_table(voxel_map, parameters)[0, 0, layer])


@pytest.mark.parametrize("height", [0.0012, 0.003, 0.0037, 0.0038, 0.005, 0.012, 0.1])
def test_a_notice_comes_exactly_where_the_map_takes_the_top_for_table(height):
    """The map itself says in which layer the top lies; what the notice advises puts it into a layer of the object."""
    notices = check_workspace(sheet(height), Parameters())
    assert bool(notices) != top_is_mapped(height, Parameters())
    for notice in notices:
        found = re.search(r"set --parameters.voxel-size (\S+) --parameters.table-clearance ([^ ,]+)", notice)
        assert found is not None
        advised = Parameters(voxel_size=float(found[1]), table_clearance=float(found[2]))
        assert top_is_mapped(height, advised)
        assert check_workspace(sheet(height), advised) == ()


def test_the_notice_names_height_limit_and_mend():
    """3 mm under the 3.75 mm at which the layer centred on 7.5 mm begins."""
    (notice,) = check_workspace(sheet(0.003), Parameters())
    assert notice == (
        "sheet: it is 3 mm tall, and the map takes all below 3.75 mm for table (voxels of 7.5 mm, table clearance "
        "5 mm), so coverage will be low whatever the material; set --parameters.voxel-size 0.003 "
        "--parameters.table-clearance 0.002, which takes longer"
    )


def test_what_no_depth_can_tell_from_the_table_is_refused():
    """A foil of 0.05 mm is flatter than a depth step of 1 mm (D400's default unit)."""
    with pytest.raises(InputError, match=r"^sheet: it is 0.05 mm tall on the table, less than one step of the camera"):
        check_workspace(sheet(0.00005), Parameters())


def test_what_does_not_fit_the_box_is_refused():
    """A sheet half a metre tall does not fit under 0.3 m."""
    with pytest.raises(InputError, match="do not fit into the mapped box of 495 x 495 x 315 mm"):
        check_workspace(sheet(0.5), Parameters())
