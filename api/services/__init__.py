"""The rules behind the routes."""
