"""What is learned and how: settings, networks, the learner, frozen policies."""
