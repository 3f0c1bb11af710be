"""A client of the service: `submit`, `wait`, `results` as xarray (docs/client.md)."""

from .client import ApiError, Client, RunFailedError

__all__ = ["ApiError", "Client", "RunFailedError"]
