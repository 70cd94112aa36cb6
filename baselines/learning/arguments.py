"""What every PPO of stable-baselines3's make is given, whichever class learns: ours, SB3's own, sb3-contrib's."""

from typing import Any

from .settings import Settings


def ppo_arguments(settings: Settings, seed: int) -> dict[str, Any]:
    """Returns the arguments that follow from the settings, all but the policy's.

    Args:
        settings: The run's.
        seed: Seed of the learner's random numbers.
    """
    return {
        "learning_rate": settings.learning_rate_at,
        "n_steps": settings.rollout,
        "batch_size": settings.learning_seats * settings.num_kitchens * settings.rollout // settings.minibatches,
        "n_epochs": settings.epochs,
        "gamma": settings.gamma,
        "gae_lambda": settings.gae_lambda,
        "clip_range": settings.clip,
        "vf_coef": settings.value_coefficient,
        "max_grad_norm": settings.max_grad_norm,
        "seed": seed,
        "device": settings.device,
    }
