"""The study of the thesis's claim that a diverse population cooperates with more strangers than self-play."""
