"""The scene as Mitsuba holds it, the stereo rig before it, and the truth that rays find in it."""
