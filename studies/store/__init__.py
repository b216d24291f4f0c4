"""Files of results and of real cameras: views, images, stereo pairs, tables, clouds, label maps."""
