"""MCAP logs: joint states, controller states and plain numbers, a group of columns a topic.

Messages in CDR with definitions of ROS 2, and JSON. They are read one by one, through `mcap` and
`mcap-ros2-support`, an optional extra.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any, Final

from ...errors import InputError
from ..expansion import most_bytes
from ..gathered import Gathered, damage_error, missing_package
from ..messages import add_message, is_read, why_not
from ..table import Table
from .format import Format

_SIGNATURE: Final = b"\x89MCAP0\r\n"


def read(path: Path) -> Table:
    """Read an MCAP file (see the module's text)."""
    with path.open("rb") as file:
        start = file.read(len(_SIGNATURE))
    if start != _SIGNATURE:
        raise InputError(
            f"{path}: this is not an MCAP file (it does not start with MCAP); correct the file's "
            "ending"
        )
    try:
        reader: Any = import_module("mcap.reader")
        ros: Any = import_module("mcap_ros2.decoder")
    except ImportError as error:
        raise missing_package(path, "MCAP", "mcap and mcap-ros2-support", "mcap", error) from error
    found = Gathered(path)
    try:
        with path.open("rb") as file:
            stream = reader.NonSeekingReader(file, record_size_limit=most_bytes())
            _read_topics(stream, ros.DecoderFactory(), found)
    except Exception as error:
        raise damage_error(path, "MCAP", error) from error
    return found.table("topic")


FORMAT = Format("MCAP", (".mcap",), read)


def _read_topics(reader: Any, ros: Any, found: Gathered) -> None:
    decoders: dict[int, Callable[[bytes], Any] | None] = {}
    # In the order of the file: sorting them by time would hold all of them at once.
    for schema, channel, message in reader.iter_messages(log_time_order=False):
        if channel.id not in decoders:
            decoders[channel.id] = _decoder(ros, channel, schema)
            if decoders[channel.id] is None:
                kind = channel.message_encoding if schema is None else schema.name
                found.unusable[channel.topic] = why_not(kind)
        if (decoder := decoders[channel.id]) is not None:
            add_message(found, channel.topic, message.log_time, decoder(message.data))


def _decoder(ros: Any, channel: Any, schema: Any) -> Callable[[bytes], Any] | None:
    if channel.message_encoding == "json":
        return _json
    if schema is None or not is_read(schema.name):
        return None
    decoder: Callable[[bytes], Any] | None = ros.decoder_for(channel.message_encoding, schema)
    return decoder


def _json(data: bytes) -> Any:
    return json.loads(data, object_hook=lambda fields: SimpleNamespace(**fields))
