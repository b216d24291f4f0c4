"""A preset with one of its numbers changed, as text that the camera's settings take."""

import json

from render.matcher.d400_preset import D400_PRESETS, MATCHER_KEYS, RSM_ON, RSM_REMOVE, RSM_WINDOW, load_preset
from studies.advise.setup import Setup


def matcher_values(preset: str) -> dict[str, float]:
    """What a preset says to the matcher, by the keys of preset files; what a file leaves out is the Default's."""
    known = load_preset(preset)
    if not known.values:
        return dict(D400_PRESETS[known.name])
    held = {key: value for key, value in known.values.items() if key in MATCHER_KEYS}
    return {**D400_PRESETS["default"], **held}


def with_preset(setup: Setup, name: str) -> Setup:
    """One of the viewer's presets; no change where the camera has its values already."""
    if matcher_values(setup.sensor.preset) == D400_PRESETS[name]:
        return setup
    return setup.with_sensor(preset=name)


def with_neighbours(setup: Setup, least: int) -> Setup:
    """Another number of the RSM_WINDOW neighbours that must agree, 0 = RSM off; the rest of the preset as it is."""
    values = matcher_values(setup.sensor.preset)
    if (round(values[RSM_REMOVE] * RSM_WINDOW) if values[RSM_ON] else 0) == least:
        return setup
    update = {RSM_REMOVE: least / RSM_WINDOW} if least else {RSM_ON: 0}
    return setup.with_sensor(preset=json.dumps(dict(sorted((values | update).items()))))
