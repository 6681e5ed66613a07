"""ROS bags, of ROS 1 (``.bag``) and ROS 2 (``.db3``): a group of columns a topic.

They are read one message after the other through `rosbags`, an optional extra. Of a folder that
``ros2 bag`` wrote name the file in it.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from importlib import import_module
from pathlib import Path
from typing import Any, Final

from ...errors import InputError
from ..gathered import Gathered, damage_error, missing_package
from ..messages import add_message, is_read, why_not
from ..table import Table
from .format import Format

_BAG: Final = b"#ROSBAG V2.0\n"
_SQLITE: Final = b"SQLite format 3\0"
_LONGEST: Final = 2**24
"""Bytes of a message of numbers."""


def read(path: Path) -> Table:
    """Read a bag (see the module's text)."""
    with path.open("rb") as file:
        start = file.read(len(_SQLITE))
    first = path.suffix.casefold() == ".bag"
    if not start.startswith(_BAG if first else _SQLITE):
        told = "ROS 1 (it does not start with #ROSBAG)" if first else "ROS 2 (it is no SQLite file)"
        raise InputError(f"{path}: this is not a bag of {told}; correct the file's ending")
    try:
        types: Any = import_module("rosbags.typesys")
        bags: Any = import_module("rosbags.rosbag1")
    except ImportError as error:
        raise missing_package(path, "a ROS bag", "rosbags", "ros", error) from error
    found = Gathered(path)
    try:
        if first:
            _read_first(path, types, bags, found)
        else:
            _read_second(path, types, found)
    except Exception as error:
        raise damage_error(path, "a ROS bag", error) from error
    return found.table("topic")


FORMAT = Format("ROS bag", (".bag", ".db3"), read)


def _read_first(path: Path, types: Any, bags: Any, found: Gathered) -> None:
    store = types.get_typestore(types.Stores.ROS1_NOETIC)
    with bags.Reader(path) as reader:
        wanted = []
        for connection in reader.connections:
            if is_read(connection.msgtype):
                _learn(types, store, connection.msgtype, connection.msgdef.data)
                wanted.append(connection)
            else:
                found.unusable[connection.topic] = why_not(connection.msgtype)
        if not wanted:
            return
        for connection, received, data in reader.messages(connections=wanted):
            message = store.deserialize_ros1(data, connection.msgtype)
            add_message(found, connection.topic, received, message)


def _read_second(path: Path, types: Any, found: Gathered) -> None:
    store = types.get_typestore(types.Stores.LATEST)
    with closing(
        sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro&immutable=1", uri=True)
    ) as bag:
        definitions = dict(_definitions(bag))
        topics: dict[int, tuple[str, str]] = {}
        for place, topic, kind, encoding in bag.execute(
            "SELECT id, name, type, serialization_format FROM topics"
        ):
            if encoding != "cdr" or not is_read(kind):
                found.unusable[topic] = why_not(kind)
                continue
            if kind in definitions:
                _learn(types, store, kind, definitions[kind])
            if kind not in store.fielddefs:
                found.unusable[topic] = f"holds {kind}, and the bag does not say what that is"
                continue
            topics[place] = topic, kind
        # What is no message of numbers would not fit in memory at once.
        rows = bag.execute(
            "SELECT topic_id, timestamp, data FROM messages WHERE length(data) <= ? "
            "ORDER BY timestamp",
            (_LONGEST,),
        )
        for place, received, data in rows:
            if place in topics:
                topic, kind = topics[place]
                add_message(found, topic, received, store.deserialize_cdr(data, kind))


def _definitions(bag: sqlite3.Connection) -> Iterator[tuple[str, str]]:
    """What the types of messages are made of: bags since Iron say it."""
    held = bag.execute("SELECT 1 FROM sqlite_master WHERE name = 'message_definitions'").fetchone()
    if held:
        yield from bag.execute(
            "SELECT topic_type, encoded_message_definition FROM message_definitions "
            "WHERE encoding = 'ros2msg'"
        )


def _learn(types: Any, store: Any, kind: str, definition: str) -> None:
    new = types.get_types_from_msg(definition, kind)
    store.register({name: fields for name, fields in new.items() if name not in store.fielddefs})
