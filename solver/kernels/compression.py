"""The part of an element's shortening that makes no compression (docs/theory.md, L17-L18)."""

from __future__ import annotations

from numba import njit

#: bound on the regularisation as a share of weight × depth: half of it where an element begins to give way, the rest
#: in proportion to the shortening, so that tangents stay regular
SHARE = 5e-4


@njit(cache=True, fastmath={"contract", "reassoc", "arcp", "nsz"}, error_model="numpy")
def released(strain, limit, knee):  # type: ignore[no-untyped-def]
    """Shortening ς that an element takes without force, as a strain, and the share of EA/L left in dT/dl (L17, L18).

    strain : (l - L)/L; limit : P_E/EA, infinite where compression is allowed; knee : ρ. The axial force is EA (strain + ς).
    Exactly 0 and 1 above the limit.
    """
    y = max(-(strain + limit), 0.0)
    u = min(y / (2.0 * knee), 1.0)
    rest = 1.0 - knee
    return rest * (y - knee * u * (2.0 - u)), 1.0 - rest * u
