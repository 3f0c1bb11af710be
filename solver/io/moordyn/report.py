"""What a translation read, assumed, could not say and left to be filled in."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass
class Report:
    """Sentences, in the order they were found.

    read : what came over. assumed : what the source leaves open and how it was taken. dropped : what the target cannot
    say, each with what that means for the answer. missing : fields the reader must fill in before the case is whole.
    """

    read: list[str] = field(default_factory=list)
    assumed: list[str] = field(default_factory=list)
    dropped: list[str] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)

    def as_dict(self) -> dict[str, list[str]]:
        return {"read": self.read, "assumed": self.assumed, "dropped": self.dropped, "missing": self.missing}

    def comment(self, mark: str = "# ") -> str:
        """The report as lines of comment, for the head of a written file."""
        titles = {"read": "Read", "assumed": "Assumed", "dropped": "Left out", "missing": "To be filled in"}
        lines = [f"{mark}{titles[key]}: {text}" for key, texts in self.as_dict().items() for text in texts]
        return "".join(printable(line) + "\n" for line in lines)


def printable(text: str) -> str:
    """On one line, without control characters, which no YAML may hold."""
    return "".join(letter if letter.isprintable() else "?" for letter in " ".join(text.split()))
