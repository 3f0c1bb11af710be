"""Pictures: plain data in, a plotly figure out; no Dash, no HTTP."""
