"""The light on the paper's bench by name: task lamp and hall, hall alone, none."""

from dataclasses import replace

from materials.input_error import InputError
from materials.lights import Band
from materials.suggestion import suggest
from scenes.lamps import Lighting, lighting, lighting_for
from scenes.paper_bench.hall import rows_of_lights, window
from scenes.paper_bench.task_lamp import task_lamp

HALL_ILLUMINANCE = 300.0
"""Direct light of the hall's rows of lights on the plinth [lux]: EN 12464-1 for rough and average machining and for
medium assembly work."""
BENCH_LIGHTING_NAMES = ("task", "hall", "off")


def bench_lighting(name: str) -> Lighting:
    """`task`: the task lamp, the hall's lights and its windows; `hall`: without the task lamp; `off`: no light.

    Its band is that of white LEDs, which bring nearly all of the light.
    """
    if name not in BENCH_LIGHTING_NAMES:
        raise InputError(f"lamps {name}: the paper's bench has none; {suggest(name, BENCH_LIGHTING_NAMES)}")
    if name == "off":
        return lighting("off")
    of_hall = lighting_for(name, rows_of_lights(), HALL_ILLUMINANCE, Band.WHITE_LED)
    near = (task_lamp(),) if name == "task" else ()
    return replace(of_hall, lamps=(*near, *of_hall.lamps, window()))
