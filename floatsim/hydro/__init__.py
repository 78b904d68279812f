"""Linear potential flow: the hydrodynamic database, its readers, and the forces made from it."""
