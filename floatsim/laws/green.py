"""Linear axial law in Green strain, with viscous damping.

    eps = (l^2 - l0^2) / (2 l0^2),     N = EA eps + c deps/dt

N is conjugate to the Green strain; the true (effective) tension of the element is N l/l0.
Source: any text on finite-strain bars, e.g. Crisfield, Non-linear Finite Element Analysis of Solids
and Structures, vol. 1, section 3.3. The law carries compression: a chain without bending stiffness
then buckles between its nodes instead of pushing, and the tangent has no kink at slack.
"""

from floatsim.jit import kernel


@kernel
def green_linear(EA, c, strain, rate, push):  # type: ignore[no-untyped-def]
    """(N, dN/deps, dN/drate): EA [N], c [N s], strain [-], rate [1/s].

    push: share of EA that acts in compression; 1 but for the first part of a static solve.
    """
    if strain < 0.0:
        EA *= push
    return EA * strain + c * rate, EA, c
