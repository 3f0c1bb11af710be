"""The sea: dispersion, spectra and Airy kinematics (docs/theory-vessel.md, Seastates and Wave kinematics)."""
