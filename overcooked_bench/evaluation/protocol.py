"""`Protocol`: the file that fixes what is played and how it is scored.

    name: v1
    version: 1
    play: {pool: v1, pool_sha256: 44d9..., layouts: [cramped_room], ...}
    report: {headlines: [n, h50], thresholds: [1, 2, 3, 5], ...}

Start states and random streams depend on `play` alone, so the report can change without changing any game. A new
protocol is one file in `protocols/`.
"""

import hashlib
import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from pkgutil import iter_modules
from typing import Any, Final, Literal

import msgspec

from overcooked_bench.agents.entries import shipped_entries
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.documents import LONGEST, Document, parse_yaml
from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation import metrics
from overcooked_bench.files import check_name, read_text
from overcooked_bench.shelf import Shelf, guess

NEWEST: Final = "v1"
"""The default protocol."""

MOST_STEPS: Final = 10_000
"""Maximum number of steps per episode; all its joint actions are kept in memory."""

MOST_EPISODES: Final = 10_000
"""Maximum number of start states per partner; the list of all blocks is kept in memory."""


class ProtocolError(WrongUse):
    """A protocol cannot be found or read; the message names the file and the key."""


_SHELF: Final = Shelf("protocol", "overcooked_bench.protocols", ".yaml", ProtocolError, "a YAML file", first=(NEWEST,))


class _Part(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, omit_defaults=True):
    """A part of a protocol. New keys are optional: left out, they leave the hash of every older protocol as it was."""

    @property
    def sha256(self) -> str:
        """Hash of what the part says; comments, the order of keys and keys at their defaults do not change it."""
        return _hash(self)


class Play(_Part, frozen=True, kw_only=True):
    """What is played. Two scores are comparable if they agree in this, in the pool and in the salt.

    Attributes:
        pool: Name or folder of the pool, which lists every partner and floor; null if `--pool` always names one.
        layouts: Names of layouts, in the order of the table.
        cooking: "auto" or "manual".
        horizon: Steps per episode, 10,000 at most.
        start: "random" or "standard".
        object_probability: Chance of each pot and each pair of hands to be filled at the start.
        seats: Seats of the scored agent.
        episodes: Start states per partner, 10,000 at most; each is played from every seat.
        mode: How frozen policies act, "sample" or "greedy".
        salt: The public salt, mixed into every random stream and into the order of the rows.
        pool_sha256: Hash of the pool; another pool of the same name is refused. Protocols that rank have it.
        per_stratum: Partners of each stratum, those of greatest weight, and no floors; None for all that the pool has.
        self_play: Whether the scored agent also meets a copy of itself, which counts in no score.
    """

    pool: str | None
    layouts: tuple[str, ...]
    cooking: Literal["auto", "manual"]
    horizon: int
    start: Literal["random", "standard"]
    object_probability: float
    seats: tuple[Literal[0, 1], ...]
    episodes: int
    mode: Literal["sample", "greedy"]
    salt: str
    pool_sha256: str | None = None
    per_stratum: int | None = None
    self_play: bool = False

    def __post_init__(self) -> None:
        few = self.per_stratum is None or self.per_stratum >= 1
        _check(
            ("pool", self.pool, self.pool is None or bool(self.pool.strip()), "the name or folder of a pool, or null"),
            ("layouts", self.layouts, 0 < len(set(self.layouts)) == len(self.layouts), "at least one, each once"),
            ("horizon", self.horizon, 1 <= self.horizon <= MOST_STEPS, f"a number of steps from 1 to {MOST_STEPS:,}"),
            ("object_probability", self.object_probability, 0 <= self.object_probability <= 1, "a probability"),
            ("seats", self.seats, 0 < len(set(self.seats)) == len(self.seats), "[0, 1], [0] or [1]"),
            ("episodes", self.episodes, 1 <= self.episodes <= MOST_EPISODES, f"a number from 1 to {MOST_EPISODES:,}"),
            ("salt", self.salt, is_text(self.salt), "a text"),
            ("pool_sha256", self.pool_sha256, self.pool_sha256 is None or _is_hash(self.pool_sha256), _HASH),
            ("per_stratum", self.per_stratum, few, "a number of partners from 1"),
        )

    @property
    def kitchens(self) -> dict[str, Any]:
        """The rules that kitchens follow, as keywords of `make_kitchens`."""
        return {
            "cooking": self.cooking,
            "horizon": self.horizon,
            "start": self.start,
            "object_probability": self.object_probability,
        }


class Suite(_Part, frozen=True, kw_only=True):
    """The cooperation scenarios that a score is shown with.

    Attributes:
        name: Name of the suite.
        sha256: Its hash; a score with another suite says so.
    """

    name: str
    sha256: str

    def __post_init__(self) -> None:
        _check(("name", self.name, is_text(self.name), "a text"), ("sha256", self.sha256, _is_hash(self.sha256), _HASH))


class OrderedReport(_Part, frozen=True, kw_only=True):
    """How ordered curves are summarised over training seeds.

    Attributes:
        band: The two quantiles around the mean curve.
        quantile: The quantile that is the worst-case view.
        quantile_band: The two quantiles around it; 0 is the minimum.
        positions: Shares of the partners at which a table reads the worst-case curve, ascending.

    Source: the thesis, 7.2 and Table 7.3.
    """

    band: tuple[float, float]
    quantile: float
    quantile_band: tuple[float, float]
    positions: tuple[float, ...]

    def __post_init__(self) -> None:
        def within(*shares: float) -> bool:
            return list(shares) == sorted({*shares}) and all(0 <= share <= 1 for share in shares)

        low, high = self.quantile_band
        _check(
            ("band", self.band, within(*self.band), "two quantiles from 0 to 1, ascending"),
            ("quantile", self.quantile, 0 < self.quantile < 1, "a number between 0 and 1"),
            ("quantile_band", self.quantile_band, within(low, self.quantile, high), "one below `quantile`, one above"),
            (
                "positions",
                self.positions,
                bool(self.positions) and within(*self.positions),
                "shares from 0 to 1, ascending",
            ),
        )


class Report(_Part, frozen=True, kw_only=True):
    """How the games are scored; it changes none of them.

    Attributes:
        thresholds: Numbers of soups that a partner's mean return is compared with, in soups of the layout's own value.
        metrics: Names of the metrics, besides the mean return; all that the data allow if empty.
        headlines: Those of them that scores are compared by; the first one ranks. The mean return if empty.
        ranked: Whether scores may be ranked at all.
        estimators: "plain": Student's t over training seeds, or over the episode blocks of a single one. "repaired":
            the same with least variances for counts and single partners, and over partners for a single training run;
            see `estimators.py`.
        scenarios: The suite of cooperation scenarios; null for the shipped one, whatever it is.
        reference: The scripted agent or entry that every table shows beside the scored one.
        criterion: The shipped protocol whose mean return is a further column, where the agent was scored with it.
        ordered: How ordered curves are summarised over training seeds, in `crossplay`.
    """

    thresholds: tuple[float, ...]
    metrics: tuple[str, ...] = ()
    headlines: tuple[str, ...] = ()
    ranked: bool = True
    estimators: Literal["plain", "repaired"] = "plain"
    scenarios: Suite | None = None
    reference: str | None = None
    criterion: str | None = None
    ordered: OrderedReport | None = None

    def __post_init__(self) -> None:
        right = all(0 < soups <= MOST_STEPS for soups in self.thresholds)
        listed = set(self.headlines) <= set(self.metrics or self.headlines)
        _check(
            ("thresholds", self.thresholds, right, f"numbers of soups above 0, {MOST_STEPS:,} at most"),
            ("metrics", self.metrics, len(set(self.metrics)) == len(self.metrics), "each once"),
            ("headlines", self.headlines, listed, "names that are among the metrics"),
        )

    @property
    def headline(self) -> str:
        """The metric that ranks."""
        return self.headlines[0] if self.headlines else "mean"


class Protocol(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What two scores must share to be comparable, and what is reported of them.

    Attributes:
        name: The protocol's name; part of the default output folder.
        version: Rises whenever a score would change.
        play: What is played.
        report: How the games are scored.
    """

    name: str
    version: int
    play: Play
    report: Report

    def __post_init__(self) -> None:
        check_name(self.name, "name", ProtocolError)
        _check(("version", self.version, self.version >= 0, "a whole number from 0"))

    @property
    def sha256(self) -> str:
        """Hash of `play`, which every random stream depends on."""
        return self.play.sha256

    @property
    def report_sha256(self) -> str:
        """Hash of `report`."""
        return self.report.sha256


def protocol_names() -> tuple[str, ...]:
    """Lists the shipped protocols, the newest first."""
    return _SHELF.names()


def load_protocol(source: str | Path = NEWEST) -> Protocol:
    """Reads a shipped protocol by name, or a YAML file.

    Args:
        source: A name of `protocol_names()`, or the path of a file.

    Raises:
        ProtocolError: No such name or file, or a key is missing, unknown or wrong.
    """
    return read_protocol(read_text(_SHELF.find(source), LONGEST, raises=ProtocolError), str(source))


def with_start(protocol: Protocol, start: Literal["random", "standard"]) -> Protocol:
    """Returns a protocol that plays from other start states; its name says so, and its scores are of other games."""
    if start == protocol.play.start:
        return protocol
    play = msgspec.structs.replace(protocol.play, start=start)
    return msgspec.structs.replace(protocol, name=f"{protocol.name}-{start}", play=play)


def read_protocol(text: str, where: str) -> Protocol:
    """Parses a protocol.

    Args:
        text: The YAML.
        where: The file's name, for messages.

    Raises:
        ProtocolError: It is not YAML, or a key is missing, unknown or wrong; names the line.
    """
    document = parse_yaml(text, where, ProtocolError)
    if "play" not in document.data and "layouts" in document.data:
        inner = ", ".join(Play.__struct_fields__)
        raise document.error(
            (),
            f"a protocol has the keys {', '.join(Protocol.__struct_fields__)}; write {inner} "
            "below play, thresholds below report. Scripted partners and floors are in the pool's manifest now",
        )
    protocol = document.convert(Protocol)
    _check_names(document, protocol)
    return protocol


def _check_names(document: Document, protocol: Protocol) -> None:
    """Checks what only a file has to keep, since stored protocols may be of another version of the package.

    Raises:
        ProtocolError: A metric, an agent or a protocol is unknown, or a protocol that ranks does not say which pool it
            means.
    """
    play, report = protocol.play, protocol.report
    known = sorted(info.name for info in iter_modules(metrics.__path__))
    for key, given in (("metrics", report.metrics), ("headlines", report.headlines)):
        for index, name in enumerate(given):
            if name not in known:
                raise document.error(
                    ("report", key, index), f"no metric {name!r}; {guess(name, known)}metrics are {', '.join(known)}"
                )
    if report.reference is not None and report.reference not in (agents := (*SCRIPTED, *shipped_entries())):
        raise document.error(
            ("report", "reference"),
            f"no scripted agent or entry {report.reference!r}; {guess(report.reference, agents)}known are "
            f"{', '.join(agents)}",
        )
    if report.criterion is not None and report.criterion not in (names := protocol_names()):
        raise document.error(
            ("report", "criterion"),
            f"no protocol {report.criterion!r}; {guess(report.criterion, names)}shipped are {', '.join(names)}",
        )
    if report.headlines and play.pool is not None and play.pool_sha256 is None:
        raise document.error(
            ("play", "pool"),
            f"missing key `pool_sha256`: a protocol with headlines says which content of the pool {play.pool!r} it "
            "means; write the hash from the pool's manifest.json",
        )


def upgrade(settings: Mapping[str, Any]) -> Mapping[str, Any]:
    """Returns a stored protocol in the present form, whatever form it was stored in.

    The first form was flat, and named scripted partners and floors, which the episodes of its scores name themselves.

    Args:
        settings: A protocol as a score.json or a store holds it.
    """
    if "play" in settings:
        return settings
    name = re.sub(r"[^A-Za-z0-9_.-]+", "-", str(settings.get("name", "")))[:100].strip("-.")
    return {
        "name": name or "protocol",
        "version": settings.get("version", 0),
        "play": {key: settings[key] for key in Play.__struct_fields__ if key in settings},
        "report": {key: settings[key] for key in Report.__struct_fields__ if key in settings},
    }


@cache
def _hash(part: _Part) -> str:
    as_read = msgspec.convert(msgspec.to_builtins(part), type(part))  # an int in a float's place becomes one
    plain = {field.name: (getattr(as_read, field.name), field.default) for field in msgspec.structs.fields(part)}
    said = {name: value for name, (value, default) in plain.items() if value != default}
    return hashlib.sha256(msgspec.json.encode(said, order="sorted")).hexdigest()


def _check(*keys: tuple[str, Any, bool, str]) -> None:
    for key, value, right, wanted in keys:
        if not right:
            raise ProtocolError(f"{key} is {list(value) if isinstance(value, tuple) else value!r}; give {wanted}")


_HASH: Final = "a SHA-256, 64 hexadecimal digits"


def _is_hash(text: str) -> bool:
    return re.fullmatch("[0-9a-f]{64}", text) is not None


def is_text(text: str) -> bool:
    """Returns whether a text is not empty and can be written as UTF-8, which lone surrogates cannot."""
    try:
        return bool(text.encode())
    except UnicodeEncodeError:
        return False
