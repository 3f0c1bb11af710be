"""Channels in the database: one row each. The first ArrayStore."""

from __future__ import annotations

from collections.abc import Iterable

from sqlalchemy import select
from sqlalchemy.orm import Session, undefer

from solver.results.channel import Channel

from ..arrays import ChannelInfo, Encoded, decode, encode
from ..errors import NotFoundError
from ..models import ChannelRow

TOGETHER = 8_000_000
"""Bytes of values inserted at once: a long list of blobs is never held whole."""


class ChannelRepository:
    """Its callers hold a run of their own scope already: channels are reached through their run only."""

    def __init__(self, session: Session):
        self.session = session

    def put(self, run_id: str, channels: Iterable[Channel]) -> None:
        held: list[ChannelRow] = []
        size = 0
        for number, channel in enumerate(channels):
            made = encode(channel)
            row = ChannelRow(
                run_id=run_id,
                number=number,
                name=channel.name,
                unit=channel.unit,
                description=channel.description,
                band=channel.band,
                axes=made.axes,
                shape=list(made.shape),
                codec=made.codec,
                payload=made.payload,
                axes_payload=made.axes_payload,
            )
            held.append(row)
            size += len(made.payload)
            if size > TOGETHER:
                self._insert(held)
                held, size = [], 0
        self._insert(held)

    def _insert(self, rows: list[ChannelRow]) -> None:
        self.session.add_all(rows)
        self.session.flush()
        for row in rows:
            self.session.expunge(row)

    def names(self, run_id: str) -> list[ChannelInfo]:
        rows = self.session.scalars(select(ChannelRow).where(ChannelRow.run_id == run_id).order_by(ChannelRow.number))
        return [_info(row) for row in rows]

    def get(self, run_id: str, name: str) -> Channel:
        row = self.session.scalars(
            select(ChannelRow)
            .where(ChannelRow.run_id == run_id, ChannelRow.name == name)
            .options(undefer(ChannelRow.payload), undefer(ChannelRow.axes_payload))
        ).one_or_none()
        if row is None:
            raise NotFoundError("channel", name)
        made = Encoded(row.codec, tuple(row.shape), row.axes, row.payload, row.axes_payload)
        return decode(made, row.name, row.unit, row.description, row.band)


def _info(row: ChannelRow) -> ChannelInfo:
    axes = tuple({key: axis.get(key) for key in ("name", "unit", "size", "first", "last")} for axis in row.axes)
    return ChannelInfo(row.name, row.unit, row.description, row.band, tuple(row.shape), axes)
