"""The advised camera as files to use at once: a preset of the RealSense viewer, and settings for our commands."""

import json
from typing import Any

import yaml

from render.matcher import d400_preset as keys
from render.sensor import IMAGER_KEYS, SET_POINT_PER_DN
from studies.advise.preset_text import matcher_values
from studies.advise.setup import Setup

VIEWER_PRESET, SENSOR_FILE = "preset.json", "sensor.yaml"
"""Files of an advice."""
HALF_TURN_DEG = 180.0
"""Rolls go from minus that to that [deg]."""


def viewer_preset(setup: Setup) -> str:
    """JSON that the RealSense viewer loads: matcher, laser, exposure, depth coding; all that it has of what is set.

    What is no key of such a file (profile, filters, HDR, films, lamps, motion) is not in it.
    """
    sensor, imager = setup.sensor, setup.sensor.imager
    values: dict[str, Any] = dict(matcher_values(sensor.preset))
    values |= {key: getattr(imager, name) for key, name in IMAGER_KEYS.items()}
    values |= {
        keys.LASER_ON: "on" if imager.laser_power_mw > 0 else "off",
        keys.AUTO_EXPOSURE: str(sensor.auto_exposure),
        keys.SET_POINT: round(imager.set_point * SET_POINT_PER_DN),
        keys.UNITS: round(sensor.depth.unit * 1e6),
        keys.CLAMP_MIN: sensor.depth.clamp_min,
        keys.CLAMP_MAX: sensor.depth.clamp_max,
    }
    return json.dumps({key: _plain(value) for key, value in sorted(values.items())}, indent=4) + "\n"


def sensor_file(setup: Setup, title: str, words: str) -> str:
    """YAML that `--config` of our commands takes: what differs from the defaults; and what no setting of the sensor
    says, as comments."""
    sensor = setup.sensor
    said = sensor.model_dump(mode="json", exclude_defaults=True) | {"preset": sensor.preset}
    said["roll_deg"] = (sensor.mount_roll_deg + setup.stand.roll_deg + HALF_TURN_DEG) % 360 - HALF_TURN_DEG
    lamps = {} if setup.lamp_level else {"lamps": "off"}
    unturned = setup.model_copy(update={"stand": setup.stand.model_copy(update={"roll_deg": 0.0})})
    beside = unturned.model_dump(mode="json", exclude_defaults=True, exclude={"sensor"})
    comments = [
        f"# {title}: {words}.",
        *(f"# Not the sensor's: {name}: {json.dumps(value)}" for name, value in beside.items()),
    ]
    return "\n".join(comments) + "\n" + yaml.safe_dump({**lamps, "sensor": said}, sort_keys=False)


def _plain(value: Any) -> Any:
    return round(value) if isinstance(value, float) and value == round(value) else value
