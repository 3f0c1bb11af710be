"""Nonlinear time domain: ensembles of seeds marched in lockstep."""
