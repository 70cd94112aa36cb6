"""`overcooked-bench leaderboard`: audits results, takes them back, reviews new ones, and builds the public page."""

import argparse
from typing import Any

from overcooked_bench.agents.isolation import HOWS
from overcooked_bench.commands.common import (
    add_act_timeout,
    add_command,
    add_group,
    add_isolate,
    add_json,
    add_workers,
    console,
)

_RESULT = "the folder of a score"
_RESULTS = "a folder with a folder for each entry: score.json, submission.yaml, audit.json; and errata.yaml"


def add_leaderboard(commands: Any) -> None:
    """Declares the group."""
    inner = add_group(
        commands,
        "leaderboard",
        "audit results, take them back, review new ones, and build the public page",
        "overcooked-bench leaderboard audit scores/my_agent-v1 --agent my_agent.py",
    )
    parser = add_command(
        inner,
        "audit",
        _audit,
        "check every number of a result, play some of its cells again, and write audit.json beside it; exits with 1 if "
        "anything is wrong",
        "overcooked-bench leaderboard audit scores/my_agent-v1 --agent my_agent.py --isolate",
    )
    parser.add_argument("result", metavar="RESULT", help=_RESULT)
    parser.add_argument(
        "--agent",
        metavar="AGENT",
        help="the scored agent, as `score` takes it; without it nothing of its play is checked, and it stays unranked",
    )
    parser.add_argument("--pool", metavar="NAME|FOLDER", help="the pool that was played with (default: the protocol's)")
    parser.add_argument(
        "--all", action="store_true", help="play all cells again, not only 2 %% (20 at least); then it is reproduced"
    )
    add_workers(parser)
    add_act_timeout(parser)
    add_isolate(parser)
    add_json(parser)
    parser = add_command(
        inner,
        "withdraw",
        _withdraw,
        "take an audited result back, which stays listed with the reason and the date",
        'overcooked-bench leaderboard withdraw scores/my_agent-v1 --reason "trained on v1"',
    )
    parser.add_argument("result", metavar="RESULT", help=f"{_RESULT} that was audited")
    parser.add_argument("--reason", metavar="TEXT", required=True, help="why, in one line")
    parser.add_argument("--date", metavar="YYYY-MM-DD", help="since when (default: today)")
    parser = add_command(
        inner,
        "add",
        _add,
        "add an audited result to those that the page is built from, with its worst games and without all others",
        "overcooked-bench leaderboard add scores/my_agent-v1 my_agent results",
    )
    parser.add_argument("result", metavar="RESULT", help=f"{_RESULT}, with its audit.json if it was audited")
    parser.add_argument("submission", metavar="SUBMISSION", help="the folder of the submission.yaml")
    parser.add_argument("results", metavar="RESULTS", help=_RESULTS)
    parser = add_command(
        inner,
        "review",
        _review,
        "review a pull request that adds an entry: its files, its submission and its result; exits with 1 if anything "
        "has to be changed",
        "overcooked-bench leaderboard review checkout review.json --changes changes.txt",
    )
    parser.add_argument("checkout", metavar="CHECKOUT", help="the repository with the pull request merged")
    parser.add_argument("review", metavar="FILE", help="the JSON to write, for `leaderboard comment`")
    _add_changes(parser)
    add_workers(parser)
    parser.add_argument(
        "--isolate", choices=HOWS, default="strict", help="how the submission is isolated (default: strict)"
    )
    parser = add_command(
        inner,
        "comment",
        _comment,
        "print a review as Markdown, beside the shipped references; nothing of the review is trusted",
        "overcooked-bench leaderboard comment review.json --changes changes.txt",
    )
    parser.add_argument("review", metavar="FILE", help="what `leaderboard review` wrote")
    _add_changes(parser)
    parser = add_command(
        inner,
        "build",
        _build,
        "write the leaderboard as static pages that need nothing else, and as JSON and CSV",
        "overcooked-bench leaderboard build results site",
    )
    parser.add_argument("results", metavar="RESULTS", help=_RESULTS)
    parser.add_argument("site", metavar="SITE", help="the folder to write, new or written by this command")


def _add_changes(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--changes",
        metavar="FILE",
        required=True,
        help="a line for each file that the pull request changes, as `git diff --name-status --no-renames` prints it",
    )


def _audit(options: argparse.Namespace) -> int:
    from overcooked_bench.commands.score import unpacked_agent
    from overcooked_bench.evaluation.games.engines import default_workers
    from overcooked_bench.leaderboard.audit.audit import audit
    from overcooked_bench.leaderboard.audit.records import AUDIT_FILE
    from overcooked_bench.leaderboard.audit.terminal import audit_tables

    found = audit(
        options.result,
        None if options.agent is None else unpacked_agent(options.agent),
        pool=options.pool,
        everything=options.all,
        isolate=options.isolate,
        act_timeout=options.act_timeout,
        workers=options.workers or default_workers(),
    )
    if options.json:
        from pathlib import Path

        print(Path(options.result, AUDIT_FILE).read_text("utf-8"), end="")
    else:
        console().print(audit_tables(found))
    return 0 if found.sound else 1


def _withdraw(options: argparse.Namespace) -> int:
    from overcooked_bench.leaderboard.audit.audit import withdraw

    taken = withdraw(options.result, options.reason, options.date)
    print(f"{options.result}: {taken.status}; its files stay")
    return 0


def _add(options: argparse.Namespace) -> int:
    from overcooked_bench.leaderboard.site.adding import add

    print(add(options.result, options.submission, options.results))
    return 0


def _review(options: argparse.Namespace) -> int:
    from pathlib import Path

    import msgspec

    from overcooked_bench.evaluation.games.engines import default_workers
    from overcooked_bench.files import printable, write_whole
    from overcooked_bench.leaderboard.review.reviewing import review

    changes = _changes(options)
    workers = options.workers or default_workers()
    found = review(options.checkout, changes, isolate=options.isolate, workers=workers)
    content = msgspec.json.format(msgspec.json.encode(found), indent=2).decode() + "\n"
    write_whole(Path(options.review), content)
    print(printable(content), end="")
    return 0 if found.sound else 1


def _comment(options: argparse.Namespace) -> int:
    from overcooked_bench.files import read_regular
    from overcooked_bench.leaderboard.review.changes import ReviewError
    from overcooked_bench.leaderboard.review.comment import MOST_BYTES, comment_of

    content = read_regular(options.review, MOST_BYTES, raises=ReviewError, follow_links=False)
    print(comment_of(content, _changes(options)), end="")
    return 0


def _changes(options: argparse.Namespace) -> str:
    from overcooked_bench.files import read_text
    from overcooked_bench.leaderboard.review.changes import ReviewError

    return read_text(options.changes, 1_000_000, raises=ReviewError)


def _build(options: argparse.Namespace) -> int:
    from pathlib import Path

    from overcooked_bench.leaderboard.site.build import INDEX, build

    built = build(options.results, options.site)
    for one in built.refused:
        print(f"refused {one.name}: {one.reason}")
    print(f"{Path(options.site) / INDEX}: {built.entries:,} entries, {built.files:,} files")
    return 0
