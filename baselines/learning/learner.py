"""PPO of stable-baselines3 with both loops rewritten: compact rows, one forward pass per batch, and a hook.

What is learned is SB3's PPO; only how the batch is stored, shuffled and fed differs (`collect_rollouts`, `train`), and
that a `Pressure` may change the rewards of a finished rollout and add a term to the loss, and a `lesson` another one.

Axes: T steps of a rollout, R rows (learning seats of all kitchens), B = T R samples, in minibatches of M.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.buffers import RolloutBuffer
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.utils import explained_variance
from stable_baselines3.common.vec_env import VecEnv

from .networks import TrunkPolicy
from .pressure import Pressure


class Batch(NamedTuple):
    """Samples that a loss is computed from.

    Attributes:
        seen: (M, ...) compact observations, as the trunk reads them.
        actions: (M,) int64.
        log_probs: (M,) of these actions when they were taken.
        advantages: (M,).
        returns: (M,) what the critic should have said.
        others: (M, 6) mean log-probabilities of the population, or (M, 0) without a diversity bonus.
    """

    seen: torch.Tensor
    actions: torch.Tensor
    log_probs: torch.Tensor
    advantages: torch.Tensor
    returns: torch.Tensor
    others: torch.Tensor

    def take(self, rows: torch.Tensor) -> "Batch":
        """Returns some of the samples."""
        return Batch(*(values.index_select(0, rows) for values in self))


class CompactBuffer(RolloutBuffer):
    """SB3's rollout buffer that keeps what the trunk reads, allocated once; tensors stay on the network's device.

    Attributes:
        seen: (T, R, ...) compact observations.
        logs: (T, R, 6) log-probabilities of all actions.
        judged: (T, R) values; `values` once the rollout is complete.
    """

    seen: torch.Tensor
    logs: torch.Tensor
    judged: torch.Tensor

    def reset(self) -> None:
        """Empties the buffer; its memory stays."""
        if not hasattr(self, "returns"):
            shape = self.buffer_size, self.n_envs
            for name in ("rewards", "returns", "episode_starts", "values", "advantages"):
                setattr(self, name, np.zeros(shape, np.float32))
            self.actions = np.zeros(shape, np.int64)
        self.pos, self.full, self.generator_ready = 0, False, False

    def put(
        self,
        seen: torch.Tensor,
        actions: np.ndarray[Any, Any],
        rewards: np.ndarray[Any, Any],
        episode_starts: np.ndarray[Any, Any],
        values: torch.Tensor,
        logs: torch.Tensor,
    ) -> None:
        """Keeps one step of all rows."""
        t = self.pos
        if not hasattr(self, "seen"):
            self.seen, self.logs, self.judged = (x.new_zeros(self.buffer_size, *x.shape) for x in (seen, logs, values))
        self.seen[t], self.logs[t], self.judged[t] = seen, logs, values
        self.actions[t], self.rewards[t], self.episode_starts[t] = actions, rewards, episode_starts
        self.pos += 1
        self.full = self.pos == self.buffer_size
        if self.full:
            self.values = self.judged.cpu().numpy()


class Learner(PPO):
    """PPO for a `TrunkPolicy`.

    Attributes:
        pressure: The diversity bonus, or None.
        lesson: A further term of the loss, computed from the policy as it is now, or None.
    """

    policy: TrunkPolicy
    rollout_buffer: CompactBuffer

    def __init__(self, *arguments: Any, pressure: Pressure | None = None, **keywords: Any) -> None:
        self.pressure = pressure
        self.lesson: Callable[[TrunkPolicy], torch.Tensor] | None = None
        super().__init__(*arguments, **{"rollout_buffer_class": CompactBuffer, **keywords})

    def collect_rollouts(
        self, env: VecEnv, callback: BaseCallback, rollout_buffer: RolloutBuffer, n_rollout_steps: int
    ) -> bool:
        """Plays a rollout; see SB3. Episodes that the horizon cuts off go on in the value of their last state."""
        assert isinstance(rollout_buffer, CompactBuffer)
        assert self._last_obs is not None
        self.policy.set_training_mode(False)
        rollout_buffer.reset()
        callback.on_rollout_start()
        draws = torch.rand(n_rollout_steps, env.num_envs, 1).to(self.device)
        for t in range(n_rollout_steps):
            seen = self._compact(self._last_obs)
            with torch.no_grad():
                logs, values = self.policy.judge(seen)
                drawn = (logs.exp().cumsum(1) < draws[t]).sum(1).clamp_(max=logs.shape[1] - 1)
            actions = drawn.cpu().numpy()
            new_obs, rewards, dones, infos = env.step(actions)
            self.num_timesteps += env.num_envs
            callback.update_locals(locals())
            if not callback.on_step():
                return False
            if dones.any():
                self._update_info_buffer(infos, dones)
                last = np.stack([info["terminal_observation"] for info in infos])
                rewards = rewards + self.gamma * self._values(last) * dones
            rollout_buffer.put(seen, actions, rewards, self._last_episode_starts, values, logs)  # type: ignore[arg-type]
            self._last_obs, self._last_episode_starts = new_obs, dones  # type: ignore[assignment]
        if self.pressure:
            rollout_buffer.rewards += self.pressure.watch(rollout_buffer.seen, rollout_buffer.logs)
        last_values = torch.from_numpy(self._values(self._last_obs))
        rollout_buffer.compute_returns_and_advantage(last_values=last_values, dones=dones)
        callback.update_locals(locals())
        callback.on_rollout_end()
        return True

    def train(self) -> None:
        """Learns from the rollout; see SB3."""
        self.policy.set_training_mode(True)
        self._update_learning_rate(self.policy.optimizer)
        clip: float = self.clip_range(self._current_progress_remaining)  # type: ignore[operator]
        whole = self._whole_batch()
        told: list[dict[str, torch.Tensor]] = []
        for _ in range(self.n_epochs):
            order = torch.randperm(len(whole.actions)).to(self.device)
            for rows in torch.split(order, self.batch_size):
                loss, parts = self.loss(whole.take(rows), clip)
                self.policy.optimizer.zero_grad()
                loss.backward()  # type: ignore[no-untyped-call]
                torch.nn.utils.clip_grad_norm_(self.policy.parameters(), self.max_grad_norm)
                self.policy.optimizer.step()
                told.append(parts)
            self._n_updates += 1
        for name in told[0]:
            self.logger.record(f"train/{name}", float(torch.stack([parts[name] for parts in told]).mean()))
        buffer = self.rollout_buffer
        spread = explained_variance(buffer.values.flatten(), buffer.returns.flatten())
        self.logger.record("train/explained_variance", spread)
        self.logger.record("train/n_updates", self._n_updates, exclude="tensorboard")
        self.logger.record("train/clip_range", clip)

    def loss(self, batch: Batch, clip: float) -> tuple[torch.Tensor, dict[str, torch.Tensor]]:
        """Computes PPO's loss, with the diversity bonus and the lesson.

        Args:
            batch: A minibatch.
            clip: PPO's clipping range.

        Returns:
            The loss, and what is worth logging.
        """
        logs, values = self.policy.judge(batch.seen)
        log_probs = logs.gather(1, batch.actions.unsqueeze(1)).squeeze(1)
        advantages = (batch.advantages - batch.advantages.mean()) / (batch.advantages.std() + 1e-8)
        log_ratio = log_probs - batch.log_probs
        ratio = log_ratio.exp()
        gain = torch.min(advantages * ratio, advantages * ratio.clamp(1 - clip, 1 + clip)).mean()
        entropy = -(logs.exp() * logs).sum(1).mean()
        value_loss = torch.nn.functional.mse_loss(values, batch.returns)
        loss = -gain - self.ent_coef * entropy + self.vf_coef * value_loss
        with torch.no_grad():
            parts = {
                "policy_gradient_loss": -gain,
                "value_loss": value_loss,
                "entropy_loss": -entropy,
                "approx_kl": (ratio - 1 - log_ratio).mean(),
                "clip_fraction": ((ratio - 1).abs() > clip).float().mean(),
            }
        if self.pressure:
            bonus = self.pressure.bonus(logs, batch.others)
            loss = loss - bonus
            parts["kl_bonus"] = bonus.detach()
        if self.lesson:
            lesson = self.lesson(self.policy)
            loss = loss + lesson
            parts["lesson"] = lesson.detach()
        return loss, {name: value.detach() for name, value in parts.items()}

    def _whole_batch(self) -> Batch:
        buffer, device = self.rollout_buffer, self.device
        others = self.pressure.others if self.pressure else torch.zeros(*buffer.actions.shape, 0)
        arrays = buffer.actions, buffer.advantages, buffer.returns
        actions, advantages, returns = (torch.from_numpy(a).flatten().to(device) for a in arrays)
        log_probs = buffer.logs.flatten(0, 1).gather(1, actions.unsqueeze(1)).squeeze(1)
        return Batch(
            buffer.seen.flatten(0, 1), actions, log_probs, advantages, returns, others.flatten(0, 1).to(device)
        )

    def _compact(self, observations: Any) -> torch.Tensor:
        return self.policy.compact(torch.from_numpy(observations).to(self.device))

    def _values(self, observations: Any) -> np.ndarray[Any, Any]:
        with torch.no_grad():
            values: np.ndarray[Any, Any] = self.policy.judge(self._compact(observations))[1].cpu().numpy()
        return values


MakeLearner = Callable[[int], Learner]
"""Makes a fresh learner with its kitchens for a seed of all random numbers."""
