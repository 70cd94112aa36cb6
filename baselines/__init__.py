"""Reference agents: one file for each training method, their configurations, and pools of frozen agents."""
