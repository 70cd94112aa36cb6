"""Made-up studies: one of a few steps that can be run, and records with known effects."""

import numpy as np

from overcooked_bench.baselines.studies.thesis_claim.records import ArmRecord, BlockRecord, Score, write_record
from overcooked_bench.baselines.studies.thesis_claim.registered import PLAN, check_registered, register
from overcooked_bench.baselines.studies.thesis_claim.study import HOME, MAIN, RECIPE, load_study
from overcooked_bench.evaluation.protocol import load_protocol

AWAY = ("human", "other-trainers", "scripted")
PROTOCOL = """
name: tiny
version: 1
play:
  pool: v1
  layouts: [forced_coordination]
  cooking: auto
  horizon: 30
  start: random
  object_probability: 0.0
  seats: [0, 1]
  episodes: 2
  mode: sample
  per_stratum: 1
  salt: spoon
report:
  metrics: [n, h50, mean, self_play]
  thresholds: [1]
"""
KITCHENS = "num_kitchens: 4, rollout: 16, epochs: 1, minibatches: 2, hidden: [8], horizon: 30"
FIVE = "agents: 2, agent_steps: 128, per_episode: 2"
MEMBERS = "candidates: 2, chosen: 2, agents: 1, per_episode: 2, candidate_steps: 128, development: greedy"


def tiny_study(folder, blocks=2):
    """Writes a study whose blocks take seconds, and registers it."""
    protocol, pool = folder / "tiny.yaml", load_protocol("v1").play.pool_sha256
    protocol.write_text(PROTOCOL)
    play = load_protocol(protocol).sha256
    (folder / RECIPE).write_text(f"""
name: tiny
protocol: {protocol}
play_sha256: '{play}'
pool_sha256: '{pool}'
arms:
  sp: {{number: 0}}
  sp-2: {{number: 1}}
  sp-long: {{method: self-play, config: fast, settings: {{steps: 192, {KITCHENS}}}}}
  sa: {{method: self-play, config: state_augmented, settings: {{steps: 192, {KITCHENS}}}}}
  pp: {{method: pretrained-partners, config: final_only, settings: {{steps: 128, {KITCHENS}, {FIVE}}}}}
  nd: {{method: population, config: no_diversity, settings: {{steps: 128, {KITCHENS}, {MEMBERS}}}}}
  l0: {{method: population, config: L0, settings: {{steps: 128, {KITCHENS}, {MEMBERS}}}}}
parts:
  pilot: {{set: pilot, blocks: {{forced_coordination: 1}}, arms: [sp]}}
  main: {{set: blocks, blocks: {{forced_coordination: {blocks}}}, arms: [sp, sp-2, sp-long, sa, pp, nd, l0]}}
view: 2
""")
    (folder / PLAN).write_text("A plan.\n")
    register(folder)
    return folder


def copied_study(folder):
    """Writes the real recipe with a plan of a line, and registers it."""
    (folder / RECIPE).write_text((HOME / RECIPE).read_text())
    (folder / PLAN).write_text("A plan.\n")
    register(folder)
    return folder, load_study(folder)


def write_blocks(home, study, means, spread=0.1, part=MAIN, counts=None, seed=0, failed=()):
    """Writes records of a part.

    Args:
        home: The study's folder.
        study: The recipe.
        means: Arm -> N at home and away; 0 for others.
        spread: Standard deviation over blocks, independent for each arm and stratum.
        part: Which part.
        counts: Layout -> blocks; all that are planned by default.
        seed: Of the noise.
        failed: Arms that could not be trained in block 0 of each layout.
    """
    known, _ = check_registered(home)
    random = np.random.default_rng(seed)
    for layout, planned in study.part(part).blocks.items():
        for index in range((counts or {}).get(layout, planned)):
            arms = []
            for arm in study.part(part).arms:
                home_mean, away_mean = means.get(arm, (0.0, 0.0))
                n = {"own": home_mean + spread * random.normal()}
                n |= {stratum: away_mean + spread * random.normal() for stratum in AWAY}
                score = Score(pool=study.pool_sha256, n=n, h50=n, partners={"somebody": n["own"]})
                if index == 0 and arm in failed:
                    arms.append(ArmRecord(arm=arm, seed=1, failed="ValueError: nan", seconds=1.0))
                else:
                    scored = {study.play_sha256: score}
                    arms.append(ArmRecord(arm=arm, seed=1, weights=arm, steps=9, seconds=3.0, scores=scored))
            record = BlockRecord(
                part=part,
                layout=layout,
                index=index,
                plan=known.plan,
                recipe=known.recipe,
                versions={},
                scoring_seconds=2.0,
                arms=tuple(arms),
            )
            write_record(record, home / "results" / f"{record.name}.json")
