"""Which effects and fidelity levels of a scenario its answers need."""
