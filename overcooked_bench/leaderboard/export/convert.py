"""Converts the actor of a stable-baselines3 model to a frozen policy's architecture and tensors.

The shapes of the weights say how the layers are connected. What they do not show is read from the model's readable
settings, or asked for.
"""

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Final, Literal, NamedTuple

from overcooked_bench.agents.policies.architecture import Architecture
from overcooked_bench.agents.policies.architectures import CONVOLUTIONS, Cnn, Mlp
from overcooked_bench.agents.policies.nature import NATURE_CONVOLUTIONS, SMALLEST, NatureCnn
from overcooked_bench.kitchen.codes import NUM_ACTIONS
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.registry import OBSERVATIONS, find_observation
from overcooked_bench.leaderboard.export.sb3_file import ExportError, SavedModel

if TYPE_CHECKING:
    import torch

    Tensors = Mapping[str, torch.Tensor]

Activation = Literal["relu", "tanh"]

CONVERTED: Final = (
    "exported are PPO and A2C with MlpPolicy or CnnPolicy, and DQN, with ReLU or Tanh, and the features extractors "
    "FlattenExtractor, NatureCNN and overcooked_bench.baselines.learning.stock.Convolutions"
)
_OURS: Final = "overcooked_bench.baselines.learning.stock.Convolutions"
_EXTRACTORS: Final = (
    "stable_baselines3.common.torch_layers.FlattenExtractor",
    "stable_baselines3.common.torch_layers.NatureCNN",
    _OURS,
)
_ACTOR_CRITIC, _DQN = "stable_baselines3.common.policies", "stable_baselines3.dqn.policies"
_CHANGED: Final = (
    "the environment was wrapped so that observations changed (VecFrameStack, resizing), and a wrapper is not "
    "part of a model; train without one, or write agent.py yourself"
)


class Converted(NamedTuple):
    """A converted actor.

    Attributes:
        architecture: Its network.
        tensors: Its weights under the architecture's names.
        mode: How it acts: "sample" as PPO and A2C do, "greedy" as DQN does.
    """

    architecture: Architecture
    tensors: Mapping[str, Any]
    mode: Literal["sample", "greedy"]


def convert(
    model: SavedModel,
    layout: Layout,
    *,
    cooking: Literal["auto", "manual"] = "auto",
    observation: str | None = None,
    activation: Activation | None = None,
    raw_observations: bool = False,
) -> Converted:
    """Converts a model.

    Args:
        model: What `read_model` returned.
        layout: The layout it was trained on.
        cooking: The cooking mode it was trained under.
        observation: What it observes; read from the shape if None.
        activation: Its activation function; read from the model's settings if None.
        raw_observations: Whether a VecNormalize around its environment left observations as they are.

    Raises:
        ExportError: It cannot be converted, or something has to be said by a flag.
    """
    _refuse(model)
    values = model.policy_module == _DQN
    if model.in_vec_normalize and not values and not raw_observations:  # of DQN, the file does not show it
        raise ExportError(
            "it was trained in a VecNormalize, whose statistics are not part of the model; train without it, or, if it "
            "left observations as they are (norm_obs=False), add --raw-observations"
        )
    told: dict[str, Any] = {"layout": layout.name, "cooking": cooking}
    told["observation"] = _observation(model, layout, observation)
    told["observation_shape"] = find_observation(told["observation"]).shape(layout)
    head = _layers(model.tensors, "q_net.q_net." if values else "mlp_extractor.policy_net.")
    if not values:
        head.append(_one(model.tensors, "action_net"))
    *head, last = head or [_one(model.tensors, "q_net.q_net.0")]
    if last["weight"].shape[0] != NUM_ACTIONS:
        raise ExportError(f"its last layer does not have {NUM_ACTIONS} outputs, one for each action; {CONVERTED}")
    tensors = {f"action.{part}": tensor for part, tensor in last.items()}
    architecture = _network(model, told, head, tensors, activation, values)
    return Converted(architecture, tensors, "greedy" if values else "sample")


def _refuse(model: SavedModel) -> None:
    """Refuses what is known not to be convertible.

    Raises:
        ExportError: It is one of these.
    """
    names = tuple(model.tensors)
    if any(name.startswith(("lstm_actor.", "lstm_critic.")) for name in names):
        why = "it has memory (a recurrent policy of sb3-contrib)"
    elif model.space == "Dict" or any(".extractors." in name for name in names):
        why = "it has several inputs (MultiInputPolicy)"
    elif model.policy_module not in (_ACTOR_CRITIC, _DQN):
        why = f"its policy is a class of {model.policy_module or 'an unknown module'}, whose code is not in the file"
    elif "log_std" in names:
        why = "its actions are not discrete"
    elif (named := _class(model, "features_extractor_class")) and named not in _EXTRACTORS:
        why = f"its features extractor is {named}, whose code is not in the file"
    else:
        return
    raise ExportError(f"{why}; {CONVERTED}. Write agent.py for others: `overcooked-bench submission new NAME`")


def _network(
    model: SavedModel,
    told: dict[str, Any],
    head: "list[Tensors]",
    tensors: "dict[str, torch.Tensor]",
    activation: Activation | None,
    values: bool,
) -> Architecture:
    """Recognises the network by its layers and adds their tensors.

    Raises:
        ExportError: It is another one.
    """
    extractor = _extractor(model.tensors, values)
    widths = tuple(int(layer["weight"].shape[0]) for layer in head)
    if not extractor:
        if not head:
            raise ExportError(f"it has no hidden layer (net_arch=[]); {CONVERTED}, with at least one")
        _name(tensors, "trunk", head)
        return Mlp(**told, hidden=widths, activation=_activation(model, activation, values))
    images = [layer for layer in extractor if layer["weight"].ndim == 4]
    dense = [layer for layer in extractor if layer["weight"].ndim == 2]
    kernels = [tuple(layer["weight"].shape[2:]) for layer in images]
    _name(tensors, "conv", images)
    if kernels == [(size, size) for _, size, _ in NATURE_CONVOLUTIONS] and len(dense) == 1:
        if min(told["observation_shape"][1:]) < SMALLEST:
            raise ExportError(f"NatureCNN needs grids of at least {SMALLEST}x{SMALLEST}; {_CHANGED}")
        tensors |= {f"features.{part}": tensor for part, tensor in dense[0].items()}
        _name(tensors, "trunk", head)
        chosen: Activation = _activation(model, activation, values) if head else "tanh"
        return NatureCnn(**told, features=int(dense[0]["weight"].shape[0]), hidden=widths, activation=chosen)
    if kernels == [(size, size) for size, _ in CONVOLUTIONS] and dense and not head and _class_is_ours(model):
        _name(tensors, "trunk", dense)
        hidden = tuple(int(layer["weight"].shape[0]) for layer in dense)
        return Cnn(**told, filters=int(images[0]["weight"].shape[0]), hidden=hidden)
    raise ExportError(
        f"its features extractor has the kernels {kernels} and {len(dense)} dense layers, followed by {len(head)}; "
        f"{CONVERTED}, the last with net_arch=[]"
    )


def _class_is_ours(model: SavedModel) -> bool:
    return _class(model, "features_extractor_class") == _OURS


def _observation(model: SavedModel, layout: Layout, given: str | None) -> str:
    """Returns what the model observes, after checking that it is what the kitchen shows.

    Raises:
        ExportError: It is not, or several observations are possible.
    """
    if given is not None:
        find_observation(given)

    def fits(name: str) -> bool:
        seen = OBSERVATIONS[name]
        if seen.refuses(layout) or (model.shape and seen.shape(layout) != model.shape):
            return False
        return model.dtype in ("", str(seen.dtype)) and model.high in (None, float(seen.high(layout)))

    possible = [name for name in OBSERVATIONS if fits(name)]
    if given in possible:
        return str(given)
    what = f"{list(model.shape)} {model.dtype} up to {model.high}"
    if given is not None or not possible:
        shown = ", ".join(
            f"{name} {list(seen.shape(layout))} {seen.dtype} up to {seen.high(layout)}"
            for name, seen in OBSERVATIONS.items()
            if not seen.refuses(layout) and given in (None, name)
        )
        raise ExportError(f"it observes {what}; on this --layout there are {shown}. If the layout is right, {_CHANGED}")
    if len(possible) > 1:
        raise ExportError(f"it observes {what}; say which observation that is: --observation {' or '.join(possible)}")
    return possible[0]


def _activation(model: SavedModel, given: Activation | None, values: bool) -> Activation:
    """Returns the activation function of the hidden layers.

    Raises:
        ExportError: It is another one than ReLU or Tanh, or the file does not say.
    """
    if model.policy_settings is None:
        if given is None:
            raise ExportError("the file does not say its activation function; add --activation relu or tanh")
        return given
    named = _class(model, "activation_fn")
    default: Activation = "relu" if values else "tanh"
    known: dict[str, Activation] = {"": default, "ReLU": "relu", "Tanh": "tanh"}
    short = named.rpartition(".")[2]
    if short not in known or named not in ("", f"torch.nn.modules.activation.{short}"):
        raise ExportError(f"its activation function is {named}; {CONVERTED}")
    if given not in (None, known[short]):
        raise ExportError(f"--activation {given}: the model says {known[short]}; leave the flag out")
    return known[short]


def _class(model: SavedModel, key: str) -> str:
    """Returns the full name of a class among the policy's settings, as its text says; empty if it is left out."""
    if key not in (model.policy_settings or {}):
        return ""
    text = str((model.policy_settings or {})[key])
    found = re.fullmatch(r"<class '([\w.]+)'>", text)
    return found[1] if found else f"{text[:100]!r}"


def _extractor(tensors: "Tensors", values: bool) -> "list[Tensors]":
    """Returns the layers of the actor's own features extractor in their order, none if it only flattens."""
    own = "q_net.features_extractor." if values else "pi_features_extractor."
    if not values and not any(name.startswith(own) for name in tensors):
        own = "features_extractor."
    rest = {name.removeprefix(own) for name in tensors if name.startswith(own)}
    parts = [part for part in ("cnn.", "linear.", "layers.") if any(name.startswith(part) for name in rest)]
    if any(not name.startswith(("cnn.", "linear.", "layers.")) for name in rest):
        raise ExportError(f"its features extractor has layers of unknown use ({', '.join(sorted(rest))}); {CONVERTED}")
    return [layer for part in parts for layer in _layers(tensors, own + part)]


def _layers(tensors: "Tensors", prefix: str) -> "list[Tensors]":
    """Returns weight and bias of the layers `<prefix><number>`, in the order of the numbers.

    Raises:
        ExportError: A layer there has something else.
    """
    numbers: dict[int, dict[str, Any]] = {}
    for name, tensor in tensors.items():
        if name.startswith(prefix):
            number, _, part = name.removeprefix(prefix).partition(".")
            if not number.isdecimal() or part not in ("weight", "bias"):
                raise ExportError(f"{name}: a layer of unknown use; {CONVERTED}")
            numbers.setdefault(int(number), {})[part] = tensor
    found: list[Tensors] = [numbers[number] for number in sorted(numbers)]
    if any(len(layer) != 2 or layer["weight"].ndim not in (2, 4) for layer in found):
        raise ExportError(f"{prefix}: not layers with weight and bias; {CONVERTED}")
    return found


def _one(tensors: "Tensors", name: str) -> "Tensors":
    try:
        return {part: tensors[f"{name}.{part}"] for part in ("weight", "bias")}
    except KeyError:
        raise ExportError(f"it has no layer {name}; {CONVERTED}") from None


def _name(tensors: "dict[str, torch.Tensor]", name: str, layers: "list[Tensors]") -> None:
    """Adds layers under a name of the architecture."""
    for i, layer in enumerate(layers):
        tensors |= {f"{name}.{i}.{part}": tensor for part, tensor in layer.items()}
