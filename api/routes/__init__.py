"""Thin routes: parameters in, a service's answer out."""
