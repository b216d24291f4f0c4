"""One reconstruction: settings, bursts, recorder, stored result."""
