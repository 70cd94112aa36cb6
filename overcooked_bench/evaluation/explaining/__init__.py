"""Why an agent failed: the scored agent, its partners and both together, played on from the very same moments."""
