"""Files that results are kept in: views, images, tables, clouds, label maps."""
