"""Readers of CAD files: one module a format, all of them to named bodies in the file's own unit."""
