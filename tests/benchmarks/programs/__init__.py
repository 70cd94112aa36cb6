"""What `peers.py` runs, each program in an interpreter that has the package it measures.

A program takes numbers of kitchens and the seconds to spend on each, and ends by printing JSON in one line: `version`,
and `rates` as joint steps a second of each block of steps, by number of kitchens. All play cramped_room for 400 steps
an episode with random actions, which are drawn within the measured time, and make both chefs' 26-channel observations
of every step.
"""
