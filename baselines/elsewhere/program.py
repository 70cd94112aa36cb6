"""Runs the program `jaxmarl_ippo.py` in an environment of its own, which has JaxMARL."""

import json
import os
import shutil
import subprocess
from collections.abc import Mapping
from importlib.resources import as_file, files
from pathlib import Path
from typing import Any, Final

from overcooked_bench.errors import WrongUse

PYTHON: Final = "OVERCOOKED_BENCH_JAXMARL"
"""Environment variable: a Python that has JaxMARL and optax; where it is not set, uv makes one."""
LOG: Final = "log.txt"
"""What the program prints, in its folder."""
_PROGRAM: Final = "jaxmarl_ippo.py"
_LAST: Final = 2000
"""Characters of the log that an error shows."""


class ProgramFailed(WrongUse):
    """The program could not be started, or ended with an error; the message has the end of what it printed."""


def run_program(settings: Mapping[str, Any], folder: Path, threads: int = 1) -> None:
    """Trains an agent in JaxMARL's kitchen.

    Args:
        settings: The fields of the program's own `Settings`.
        folder: Where it writes its files; made if it is missing.
        threads: Threads that it computes on.

    Raises:
        ProgramFailed: There is no such Python, no JaxMARL, or the training failed.
        KeyboardInterrupt: Stopped by Ctrl-C; the program has ended too.
    """
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "settings.json"
    file.write_text(json.dumps(settings))
    flags = f"--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads={threads}"
    environment = {**os.environ, "JAX_PLATFORMS": "cpu", "XLA_FLAGS": flags, "PYTHONWARNINGS": "ignore"}
    with as_file(files(__package__) / _PROGRAM) as program, (folder / LOG).open("w") as log:
        call = [*_interpreter(), str(program), str(file), str(folder)]
        try:
            process = subprocess.Popen(
                call, stdin=subprocess.DEVNULL, stdout=log, stderr=log, env=environment, start_new_session=True
            )
        except OSError as error:
            raise ProgramFailed(f"{call[0]} cannot be started ({error.strerror}); {_remedy()}") from None
        try:
            code = process.wait()
        finally:
            process.terminate()
            process.wait()
    if code:
        said = (folder / LOG).read_text(errors="replace").strip()[-_LAST:]
        raise ProgramFailed(f"{folder / LOG}: the training in JaxMARL ended with code {code}; {_remedy()}\n{said}")


def _interpreter() -> list[str]:
    if python := os.environ.get(PYTHON):
        return [python]
    if shutil.which("uv"):
        return ["uv", "run", "--quiet", "--no-project", "--script"]
    raise ProgramFailed(f"there is no uv here to install JaxMARL with; {_remedy()}")


def _remedy() -> str:
    return f"install uv, or let {PYTHON} name a Python that has jaxmarl 0.2.0 and optax"
