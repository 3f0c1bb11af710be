"""Functions that read untrusted bytes, called in a child process that has limits and can be killed.

`call` is the entry (docs/decisions/0056-untrusted-files-in-a-child.md).
"""

from .calls import MODULES, Limits, Stopped, call, stream, warm_up

__all__ = ["MODULES", "Limits", "Stopped", "call", "stream", "warm_up"]
