"""Whoever is tested: from a name, a file or a function to agents for each kitchen."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Final

from overcooked_bench.agents.agent import UnknownLayout
from overcooked_bench.agents.mirror import mirrored
from overcooked_bench.scenarios.scenario import Situation

if TYPE_CHECKING:
    from overcooked_bench.agents.agent import Agent
    from overcooked_bench.agents.policies.neural import Mode

AgentFactory = Callable[[str, int], "Agent"]
"""`make_agent(layout, training_seed)`, as submissions define it."""

ANY_LAYOUT: Final = "{layout}"
"""Stands for the layout in the name of frozen agents: `dev-v0/{layout}/sp-0` is another one in each kitchen."""


def agent_factory(agent: str | Path | AgentFactory, mode: "Mode" = "sample") -> AgentFactory:
    """Gives a function that makes an agent for a layout; a submission's file is executed once.

    Args:
        agent: What `load_agent` takes, `file.py:function` for a function of another name than make_agent, a name with
            `{layout}` in it, or such a function.
        mode: How frozen policies act.

    Raises:
        AgentError: There is no such agent, or a submission cannot be loaded.
        PoolError: There is no such pool, or it is damaged.
    """
    from overcooked_bench.agents.catalogue import load_agent
    from overcooked_bench.agents.submissions.loading import ENTRY, load_submission

    if not isinstance(agent, str | Path):
        return agent
    path, name = Path(agent), str(agent)
    if path.suffix == ".py" or (path / ENTRY).is_file():
        return load_submission(path).make_agent
    file, _, function = name.rpartition(":")
    if file.endswith(".py") or (file and (Path(file) / ENTRY).is_file()):
        return load_submission(file, function).make_agent
    if ANY_LAYOUT in name:
        return _one_for_each(name, mode)

    def make(layout: str, training_seed: int) -> "Agent":
        return load_agent(agent, layout, training_seed, mode)

    return make


def ways(make_agent: AgentFactory, situation: Situation, seed: int) -> Iterator[tuple[Callable[[], "Agent"], bool]]:
    """Lists how an agent may come to play a kitchen, and whether it is adapted then.

    Args:
        make_agent: Makes it.
        situation: Of the kitchen.
        seed: The training seed.
    """
    layout = situation.layout
    yield lambda: make_agent(layout.name, seed), False
    if situation.mirrored:
        yield lambda: mirrored(make_agent(layout.mirrored().name, seed)), True


def _one_for_each(name: str, mode: "Mode") -> AgentFactory:
    from overcooked_bench.agents.catalogue import load_agent
    from overcooked_bench.agents.pools.manifest import read_manifest
    from overcooked_bench.agents.pools.pool import Pool, find_pool

    folder = find_pool(name.rsplit("/", 2)[0])
    pool = Pool(folder, read_manifest(folder))

    def make(layout: str, training_seed: int) -> "Agent":
        if layout not in pool.layouts:
            raise UnknownLayout(f"the pool {pool.name} has no agents for {layout!r}")
        return load_agent(name.replace(ANY_LAYOUT, layout), layout, training_seed, mode)

    return make
