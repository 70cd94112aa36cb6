"""Ids in the registries of Gymnasium and PettingZoo, one for each shipped layout and one for a custom grid.

The dynamics of a `-v0` id never change; a change of dynamics gets `-v1`.
"""

from overcooked_bench.kitchen.layout import layout_names

CUSTOM_ID = "Overcooked/Custom-v0"
_SINGLE = "overcooked_bench.envs.single:OvercookedEnv"
_PARALLEL = "overcooked_bench.envs.parallel:parallel_env"
_VECTOR = "overcooked_bench.envs.vector:OvercookedVectorEnv"


def env_id(layout: str) -> str:
    """Returns the id of a shipped layout: "cramped_room" is played as "Overcooked/CrampedRoom-v0"."""
    return f"Overcooked/{''.join(word.capitalize() for word in layout.split('_'))}-v0"


def register_environments() -> None:
    """Registers all ids with Gymnasium, and with PettingZoo if installed, except those that are registered already.

    No `max_episode_steps` is registered: the horizon is the kitchen's own.
    """
    from gymnasium.envs.registration import register, registry

    rows = {env_id(name): {"layout": name} for name in layout_names()} | {CUSTOM_ID: {}}
    for name, kwargs in rows.items():
        if name not in registry:
            register(name, entry_point=_SINGLE, vector_entry_point=_VECTOR, kwargs=kwargs)
    try:
        import pettingzoo
    except ModuleNotFoundError:
        return
    parallel = getattr(pettingzoo, "parallel_registry", ())  # PettingZoo before 1.27 has none
    for name, kwargs in rows.items() if parallel else ():
        if name not in parallel:
            pettingzoo.register("parallel", name, _PARALLEL, kwargs=kwargs)
