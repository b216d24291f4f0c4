"""What stands in front of the sensor: parts, coupons, user CAD, how they lie and pile up, table, lamps, room."""
