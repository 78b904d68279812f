"""Linear axial law in Green strain, with viscous damping: the default.

    eps = (s^2 - 1)/2,   N = EA eps + c deps/dt,   T = N s,        s = l/l0

N is conjugate to the Green strain; T is the true (effective) tension along the element.
Source: any text on finite-strain bars, e.g. Crisfield, Non-linear Finite Element Analysis of Solids
and Structures, vol. 1, section 3.3. The law carries compression: a chain without bending stiffness
then buckles between its nodes instead of pushing, and the tangent has no kink at slack.
"""

from floatsim.jit import kernel


@kernel
def green(EA, c, s, rate):  # type: ignore[no-untyped-def]
    """(T, dT/ds, dT/drate): EA [N], c [N s], stretch s = l/l0 [-] and its rate [1/s]."""
    N = 0.5 * EA * (s * s - 1.0) + c * s * rate
    return N * s, N + s * (EA * s + c * rate), c * s * s
