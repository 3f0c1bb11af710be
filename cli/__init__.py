"""The command `slowdrift`."""
