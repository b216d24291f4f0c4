"""Scripts that draw parts A-D with build123d and bd_warehouse and write `scenes/meshes/` (extra `authoring`)."""
