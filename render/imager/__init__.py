"""The infrared imager: radiance in, noisy 8-bit images out."""
