"""Compiled code that is kept on disk goes when any compiled source changes."""

from __future__ import annotations

from pathlib import Path

from solver.kernels import _forget_outdated


def test_kept_code_goes_when_a_called_source_changes(tmp_path: Path) -> None:
    for folder in ("kernels", "forces"):
        (tmp_path / folder / "__pycache__").mkdir(parents=True)
    called, plain = tmp_path / "forces" / "weight.py", tmp_path / "forces" / "words.py"
    called.write_text("@njit\ndef force(): ...\n")
    plain.write_text("x = 1\n")
    kept = tmp_path / "kernels" / "__pycache__" / "march.py311.nbi"
    assert _forget_outdated(tmp_path)
    kept.write_text("code")
    assert not _forget_outdated(tmp_path)
    plain.write_text("x = 2\n")
    assert not _forget_outdated(tmp_path)
    assert kept.exists()
    called.write_text("@njit\ndef force(): return 2\n")
    assert _forget_outdated(tmp_path)
    assert not kept.exists()
