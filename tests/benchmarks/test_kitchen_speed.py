"""`Kitchens.step` and `observe` against a plain copy of as many bytes into the same buffer."""

from itertools import cycle
from typing import Any

import numba
import numpy as np
import pytest
from numpy.typing import NDArray

from overcooked_bench import Kitchens, Layout
from tests.benchmarks.measuring import measure

pytestmark = [
    pytest.mark.benchmark,
    pytest.mark.parametrize("layout", ["cramped_room", "asymmetric_advantages"]),
    pytest.mark.parametrize("num_kitchens", [30, 256, 4096]),
]
DRAWN_ACTIONS = 2**15  # joint actions drawn beforehand, too many for a branch predictor to learn


def facts(layout: str, num_kitchens: int, what: str) -> dict[str, Any]:
    plan = Layout.load(layout)
    return {
        "group": f"{num_kitchens} kitchens of {plan.width}x{plan.height}",
        "kind": "kitchens",
        "layout": f"{layout} {plan.width}x{plan.height}",
        "kitchens": num_kitchens,
        "what": what,
    }


def buffer_and_template(layout: str, num_kitchens: int) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """The array that observations go into, and one kitchen's observations."""
    shown = Kitchens(layout, 1).observe("lossless26")
    return np.zeros((num_kitchens, *shown.shape[1:]), np.uint8), shown[0]


@numba.njit
def copied(template: NDArray[np.uint8], out: NDArray[np.uint8]) -> None:
    """Copies (B,) bytes to each row of (N, B)."""
    for i in range(out.shape[0]):
        for k in range(template.shape[0]):
            out[i, k] = template[k]


def test_copy_of_a_template_by_numpy(benchmark, layout, num_kitchens):
    out, template = buffer_and_template(layout, num_kitchens)
    call = lambda: np.copyto(out, template)  # noqa: E731
    measure(benchmark, call=call, joint_steps=num_kitchens, **facts(layout, num_kitchens, "copy by numpy"))
    assert (out == template).all()


def test_copy_of_a_template_compiled(benchmark, layout, num_kitchens):
    out, template = buffer_and_template(layout, num_kitchens)
    source, rows = template.reshape(-1), out.reshape(num_kitchens, -1)
    call = lambda: copied(source, rows)  # noqa: E731
    measure(benchmark, call=call, joint_steps=num_kitchens, **facts(layout, num_kitchens, "compiled copy"))
    assert (out == template).all()


def test_step_and_observe(benchmark, layout, num_kitchens):
    kitchens = Kitchens(layout, num_kitchens)
    kitchens.reset(seed=0)
    out, _ = buffer_and_template(layout, num_kitchens)
    rng = np.random.default_rng(0)
    actions = cycle(list(rng.integers(0, 6, (max(8, DRAWN_ACTIONS // num_kitchens), num_kitchens, 2))))

    def call() -> None:
        kitchens.step(next(actions))
        kitchens.observe("lossless26", out=out)

    measure(benchmark, call=call, joint_steps=num_kitchens, **facts(layout, num_kitchens, "step and observe"))
    np.testing.assert_array_equal(out, kitchens.observe("lossless26"))
