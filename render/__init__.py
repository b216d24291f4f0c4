"""The sensor: a scene in; infrared pair, depth, truth and labels out."""
