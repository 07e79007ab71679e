"""What accuracy costs: of a design in modelled time, of the simulator in wall-clock time."""
