"""Linear axial law in engineering strain, with viscous damping.

    T = EA (s - 1) + c ds/dt,        s = l/l0

What most line codes use (MoorDyn, OrcaFlex with a constant EA). Against the Green law the tension at a strain
of e is smaller by 1.5 e: nothing for chain and cable, 15 % for a rope stretched by 10 %.
"""

from typing import Literal

from floatsim.description import Description
from floatsim.jit import kernel


@kernel
def engineering(EA, c, s, rate):  # type: ignore[no-untyped-def]
    """(T, dT/ds, dT/drate): EA [N], c [N s], stretch s = l/l0 [-] and its rate [1/s]."""
    return EA * (s - 1.0) + c * rate, EA, c


class Engineering(Description):
    """Axial law T = EA e in engineering strain e, with the section's EA and axial damping."""

    kind: Literal["engineering"] = "engineering"
