"""Wind: what blows at the rotor and along the tower."""
