"""`python -m overcooked_bench.baselines.studies.thesis_claim`: runs the study, and analyses it."""

from .command import main

raise SystemExit(main())
