"""What the training methods share: settings, networks, the learner, checkpoints, runs."""
