"""Plays one block again, to check that a submission plays it the same way regardless of what was played before.

Axes: B rows of the scored agent.
"""

from dataclasses import replace

from overcooked_bench.evaluation.games.block import Block, play_block

OUTLIVES = (
    "plays a block differently when it is played again: something that it keeps at module level, or a generator "
    "without a seed, outlives a block. Its score depends on how the blocks are dealt to workers and cannot be repeated"
)
ORDER = (
    "plays a block differently when its rows come in another order: rows share something, such as one generator. Let a "
    "row depend on its own seed alone (overcooked_bench.agents.sample_actions); the score stands"
)


def play_again(block: Block) -> str | None:
    """Plays a block, then plays it again with the agent's rows in reverse order; run it in a process of its own.

    The block's first start state is enough for that.

    Returns:
        How the agent's play differs, in words that follow its name; None if it does not, or if it breaks the contract,
        which playing the block itself will show.
    """
    block = replace(block, episodes=block.episodes[:1])
    first, turned = play_block(block), play_block(replace(block, turned=True))
    if not first.episodes or not turned.episodes or first.episodes == turned.episodes:
        return None
    return ORDER if play_block(block).episodes == first.episodes else OUTLIVES
