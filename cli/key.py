"""`slowdrift key`: API keys of an account, from the machine that has the database."""

from __future__ import annotations

import argparse
from datetime import timedelta

from .options import RefusedError, add_data_dir, refuse, say
from .people import changing, read_secret_of, the_user


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser("key", help="API keys: add, list, revoke")
    verbs = parser.add_subparsers(dest="what", metavar="add|list|revoke", required=True)
    add = verbs.add_parser("add", help="make a key; it is shown this once")
    add.add_argument("email", help="the account for which it acts")
    add.add_argument("name", help="what it is for")
    add.add_argument("--scope", choices=("read", "submit", "admin"), default="submit", help="default: %(default)s")
    add.add_argument("--days", type=int, default=90, metavar="N", help="good for; 0: for ever (default: %(default)s)")
    add.add_argument("--team", help="the only team it opens")
    listed = verbs.add_parser("list")
    listed.add_argument("email")
    revoke = verbs.add_parser("revoke")
    revoke.add_argument("email")
    revoke.add_argument("id", help="or the key's first characters, as `list` shows them")
    for verb in verbs.choices.values():
        add_data_dir(verb)
    parser.set_defaults(func=key, changes=True)
    listed.set_defaults(changes=False)


def key(options: argparse.Namespace) -> int:
    try:
        {"add": _add, "list": _list, "revoke": _revoke}[options.what](options)
    except RefusedError as error:
        return refuse(error)
    return 0


def _add(options: argparse.Namespace) -> None:
    from store.clock import utc_now
    from store.people import ApiKey
    from store.repositories.accounts import AccountRepository
    from store.repositories.teams import TeamRepository
    from store.tokens import KEY, START, digest, new_token

    if not 0 <= options.days <= 3650:
        raise RefusedError(f"--days is {options.days}; allowed: 0 to 3650")
    token = new_token(KEY)
    with changing(options, email=options.email, name=options.name) as (session, settings):
        owner = the_user(session, options.email)
        team = TeamRepository(session).by_name(options.team) if options.team else None
        if options.team and team is None:
            raise RefusedError(f"there is no team {options.team!r}")
        made = ApiKey(
            user_id=owner.id,
            team_id=team.id if team else None,
            name=options.name[:100],
            scope=options.scope,
            start=token[:START],
            digest=digest(token, read_secret_of(settings)),
            expires_at=utc_now() + timedelta(days=options.days) if options.days else None,
        )
        AccountRepository(session).add_key(made)
    say(token)


def _list(options: argparse.Namespace) -> None:
    from store.repositories.accounts import AccountRepository

    with changing(options) as (session, _):
        for each, team in AccountRepository(session).keys(the_user(session, options.email).id):
            state = "revoked" if each.revoked_at else f"until {each.expires_at:%Y-%m-%d}" if each.expires_at else "good"
            used = f"used {each.last_used_at:%Y-%m-%d %H:%M}" if each.last_used_at else "never used"
            say("  ".join([each.id, f"{each.start}…", each.scope, team or "all teams", state, used, each.name]))


def _revoke(options: argparse.Namespace) -> None:
    from store.repositories.accounts import AccountRepository

    with changing(options, email=options.email, key=options.id) as (session, _):
        accounts = AccountRepository(session)
        owner = the_user(session, options.email)
        asked = options.id.rstrip("…")
        found = [row.id for row, _ in accounts.keys(owner.id) if asked in (row.id, row.start)]
        if len(found) != 1:
            raise RefusedError(
                f"{len(found)} keys of {owner.email} have the id {options.id!r}; see `slowdrift key list`"
            )
        accounts.revoke_key(owner.id, found[0])
    say("Revoked.")
