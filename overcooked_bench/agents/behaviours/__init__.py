"""The small language of scripted partners, and the agents that carry it out."""
