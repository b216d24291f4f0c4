"""At which angles of incidence a material and finish give right depth, with the confidence of it."""
