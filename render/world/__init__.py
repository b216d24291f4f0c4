"""The renderer's backend, the scene as it holds it, the stereo rig before it, and the truth that rays find in it."""
