"""The small language of scripted partners, and the agents that execute it."""
