"""The sea: spectra, and realisations of them as sums of linear waves.

A new spectrum is one class with `density(omega)` and its name in SPECTRA; a user's own needs no entry.
"""

from floatsim.sea.spectra import (
    Bretschneider,
    Jonswap,
    OchiHubble,
    PiersonMoskowitz,
    SpectrumTable,
    Torsethaugen,
    WhiteNoise,
)

SPECTRA = (Jonswap, PiersonMoskowitz, Bretschneider, OchiHubble, Torsethaugen, SpectrumTable, WhiteNoise)
