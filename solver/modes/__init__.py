"""Natural modes of the coupled system and the coefficients its lines lend the vessel."""
