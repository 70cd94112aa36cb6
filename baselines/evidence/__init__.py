"""Shows what a pool covers, and that its scores rank agents as other partners do."""
