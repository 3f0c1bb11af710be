"""`slowdrift user`: accounts, from the machine that has the database."""

from __future__ import annotations

import argparse

from .options import RefusedError, add_data_dir, refuse, say
from .people import ask_password, changing, make_link, the_user

RESET_DAYS = 3


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser("user", help="accounts: add, list, disable, enable, reset-password")
    verbs = parser.add_subparsers(dest="what", metavar="add|list|disable|enable|reset-password", required=True)
    add = verbs.add_parser("add", help="an account; the first one administers the installation")
    add.add_argument("email")
    add.add_argument("--name", default="", help="default: what stands before the @")
    add.add_argument("--admin", action="store_true", help="administers accounts")
    add.add_argument("--team", default="default", help="team to join (default: %(default)s)")
    add.add_argument("--role", choices=("viewer", "editor", "owner"), help="in the team (default: owner if first)")
    _password(add)
    verbs.add_parser("list", help="all accounts with their teams")
    for name in ("disable", "enable", "reset-password"):
        verb = verbs.add_parser(name)
        verb.add_argument("email")
        if name == "reset-password":
            _password(verb)
    for verb in verbs.choices.values():
        add_data_dir(verb)
    parser.set_defaults(func=user, changes=True)
    verbs.choices["list"].set_defaults(changes=False)


def _password(parser: argparse.ArgumentParser) -> None:
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--password-stdin", action="store_true", help="read the password from standard input")
    how.add_argument("--link", action="store_true", help="print a link at which to choose one, good for 3 days")


def user(options: argparse.Namespace) -> int:
    verbs = {"add": _add, "list": _list, "disable": _able, "enable": _able, "reset-password": _reset}
    try:
        verbs[options.what](options)
    except RefusedError as error:
        return refuse(error)
    return 0


def _add(options: argparse.Namespace) -> None:
    from store.passwords import hash_password
    from store.people import OWNER, VIEWER
    from store.repositories.accounts import AccountRepository
    from store.repositories.entry import EntryRepository
    from store.repositories.teams import TeamRepository

    email = options.email.strip().lower()
    before, _, after = email.partition("@")
    if not before or not after or len(email) > 254 or not email.isprintable() or " " in email:
        raise RefusedError(f"{options.email!r} is no e-mail address; give one such as ada@example.org")
    hashed = None if options.link else hash_password(ask_password(options))
    with changing(options, email=email) as (session, settings):
        first = not EntryRepository(session).any_account()
        teams = TeamRepository(session)
        team = teams.by_name(options.team)
        if team is None:
            raise RefusedError(f"there is no team {options.team!r}; make it on the pages or by REST first")
        made = AccountRepository(session).add(email, options.name or before, hashed, options.admin or first)
        role = options.role or (OWNER if first else VIEWER)
        teams.join(team.id, made.id, role)
        link = make_link(session, settings, RESET_DAYS, user_id=made.id, email=email) if options.link else ""
    say(f"{email} is {role} of the team {options.team!r}" + (", and administrator." if made.is_admin else "."))
    if first:
        say("From now on everybody has to sign in.")
    if link:
        say(f"Choose a password at: {link}")


def _list(options: argparse.Namespace) -> None:
    from store.repositories.accounts import AccountRepository
    from store.repositories.teams import TeamRepository

    with changing(options) as (session, _):
        for each in reversed(AccountRepository(session).page(10_000, None)):
            marks = [mark for mark, yes in (("administrator", each.is_admin), ("disabled", each.disabled_at)) if yes]
            roles = [f"{team.name}: {role}" for team, role, _, _ in TeamRepository(session).of(each.id)]
            say("  ".join([each.email, each.name, ", ".join(roles) or "no team", *marks]))


def _able(options: argparse.Namespace) -> None:
    from store.repositories.accounts import AccountRepository

    with changing(options, email=options.email) as (session, _):
        found = the_user(session, options.email)
        AccountRepository(session).set_disabled(found, options.what == "disable")
    ended = "; the sessions have ended, the keys open nothing" if options.what == "disable" else ""
    say(f"{found.email} is {options.what}d{ended}.")


def _reset(options: argparse.Namespace) -> None:
    from store.passwords import hash_password
    from store.repositories.accounts import AccountRepository

    hashed = None if options.link else hash_password(ask_password(options))
    with changing(options, email=options.email) as (session, settings):
        found = the_user(session, options.email)
        if hashed is not None:
            AccountRepository(session).set_password(found, hashed)
            said = f"{found.email} has a new password; all sessions have ended."
        else:
            link = make_link(session, settings, RESET_DAYS, user_id=found.id, email=found.email)
            said = f"Choose a password at: {link}"
    say(said)
