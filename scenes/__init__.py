"""What stands in front of the sensor: parts, coupons, table, lamps, room, user CAD."""
