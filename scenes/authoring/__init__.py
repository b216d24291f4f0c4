"""Scripts that draw the parts with build123d and bd_warehouse and write `scenes/meshes/` (extra `authoring`)."""
