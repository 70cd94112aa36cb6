"""The shipped protocols: what is played and how it is scored, one YAML file each.

`overcooked_bench.evaluation.protocol` reads them; a file of your own works the same way.
"""
