"""One reconstruction: settings and ablations, bursts, recorder, reference surface, stored result."""
