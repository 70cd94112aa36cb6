"""What `peers.py` and `time_to_return.py` run, each program in an interpreter that has the package it measures.

A `with_*` program takes numbers of kitchens and the seconds to spend on each, and ends by printing JSON in one line:
`version`, and `rates` as joint steps per second of each block of steps, by number of kitchens. All play cramped_room
for 400 steps per episode with random actions, which are drawn within the measured time, and make both chefs' 26-channel
observations of every step.

A `return_with_*` program trains in self-play until the last `episodes` finished episodes earned `goal` points on
average, or to its end. It takes JSON: `layout`, `seed`, `goal`, `episodes`, `started` (`time.time()` when the process
was started), `configuration` (ours), `share` (JaxMARL: of its updates, after which it gives up). It ends by printing
JSON in one line: `version`, `start_up` (seconds from the start of the process to the first step of training), `curve`
(seconds from that start, joint steps, and mean return, whenever episodes ended), `reached`.
"""
