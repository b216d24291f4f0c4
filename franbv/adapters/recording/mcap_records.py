"""Takes an MCAP file apart, chunk by chunk, trusting no length in it; what was cut off is told from what is damaged.

A file that ends with MCAP's magic bytes was closed: then all of it must be whole, and every checksum right. Without
them its writer was killed, and it is read up to the last record that is there. Every record is bounded before it is
loaded. The format is that of mcap.dev/spec; package `mcap` reads the fields. Needs the extra `record`.
"""

import struct
import zlib
from collections.abc import Iterator
from io import BufferedIOBase, BytesIO
from pathlib import Path
from typing import NamedTuple

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, DataEnd, Footer, Header, Message

from franbv.adapters.recording.contents import RecordingError

MCAP_MAGIC = b"\x89MCAP0\r\n"
MOST_RECORD_BYTES = 128 * 2**20
"""Of a record, and of a chunk when it is unpacked. Choice: eight times what the writer makes of the largest image."""
RECORDING_MEND = "copy the file anew, or record again"
RECORD_HEAD = struct.Struct("<BQ")
"""Of every record: what it is, and its length [bytes]."""
FOOTER_HEAD = struct.Struct("<BQQQ")
"""The footer up to its checksum, which covers that, too."""
MALFORMED_RECORD = (McapError, struct.error, ValueError, zstandard.ZstdError, OverflowError)
"""What taking a damaged record apart can raise."""


class FoundMessage(NamedTuple):
    """A message of the file."""

    topic: str
    data: bytes
    place: "MessagePlace"


class MessagePlace(NamedTuple):
    """Where a message stands."""

    chunk: int
    """Where its chunk begins [byte]."""
    number: int
    """Its number among the chunk's messages [-]."""


class McapRecord(NamedTuple):
    """A record at the file's top."""

    opcode: int
    """What it is."""
    at: int
    """Where it begins [byte]."""
    data: bytes


def profile_of(path: Path) -> str | None:
    """What the file's header says it is; None for anything but an MCAP file."""
    with path.open("rb") as file:
        if file.read(len(MCAP_MAGIC)) != MCAP_MAGIC:
            return None
        head = file.read(RECORD_HEAD.size)
        if len(head) < RECORD_HEAD.size:
            return None
        opcode, length = RECORD_HEAD.unpack(head)
        if opcode != Opcode.HEADER or length > MOST_RECORD_BYTES:
            return None
        try:
            return Header.read(_stream(file.read(length))).profile
        except MALFORMED_RECORD:
            return None


def is_closed(path: Path) -> bool:
    """Whether the file has its end."""
    with path.open("rb") as file:
        size = file.seek(0, 2)
        file.seek(max(0, size - len(MCAP_MAGIC)))
        return size > len(MCAP_MAGIC) and file.read() == MCAP_MAGIC


def messages_of(path: Path) -> Iterator[FoundMessage]:
    """All messages in chunks, in the order in which they were written.

    RecordingError, with the byte, for what is damaged.
    """
    channels: dict[int, str] = {}
    closed = is_closed(path)
    with path.open("rb") as file:
        checksum, ended = 0, False
        for record in _records(path, file, closed):
            try:
                if record.opcode == Opcode.CHUNK:
                    yield from _messages_in(record, channels)
                elif record.opcode == Opcode.DATA_END:
                    ended = True
                    _compare(DataEnd.read(_stream(record.data)).data_section_crc, checksum, "the data")
                elif record.opcode == Opcode.FOOTER:
                    _check_summary(file, record)
            except MALFORMED_RECORD as error:
                raise _damaged(path, record.at, error) from error
            if not ended:
                head = RECORD_HEAD.pack(record.opcode, len(record.data))
                checksum = zlib.crc32(record.data, zlib.crc32(head, checksum or zlib.crc32(MCAP_MAGIC)))


def chunk_at(path: Path, at: int) -> list[bytes]:
    """The messages of one chunk, once more, by their numbers."""
    with path.open("rb") as file:
        size = file.seek(0, 2)
        file.seek(at)
        try:
            record = _record(file, size)
            if record is None or record.opcode != Opcode.CHUNK:
                raise ValueError("the chunk that was there is gone")
            return [found.data for found in _messages_in(record, None)]
        except MALFORMED_RECORD as error:
            raise _damaged(path, at, error) from error


def _records(path: Path, file: BufferedIOBase, closed: bool) -> Iterator[McapRecord]:
    """Records up to the footer; of a file without an end, as many as are whole."""
    size = file.seek(0, 2)
    file.seek(0)
    if file.read(len(MCAP_MAGIC)) != MCAP_MAGIC:
        raise RecordingError(f"{path}: is no MCAP file (other first bytes); give a recording")
    while True:
        at = file.tell()
        try:
            record = _record(file, size)
        except ValueError as error:
            raise _damaged(path, at, error) from error
        if record is None:
            if closed:
                raise _damaged(path, at, "a record reaches beyond the end")
            return
        yield record
        if record.opcode == Opcode.FOOTER:
            if file.read() != MCAP_MAGIC:
                raise _damaged(path, at, "something follows the footer")
            return
        file.seek(at + RECORD_HEAD.size + len(record.data))


def _record(file: BufferedIOBase, size: int) -> McapRecord | None:
    """The record here, None where the file ends before it does; ValueError for one that is longer than any."""
    at = file.tell()
    head = file.read(RECORD_HEAD.size)
    if len(head) < RECORD_HEAD.size:
        return None
    opcode, length = RECORD_HEAD.unpack(head)
    if at + RECORD_HEAD.size + length > size:
        return None
    if length > MOST_RECORD_BYTES:
        raise ValueError(f"a record of {length} bytes")
    return McapRecord(opcode, at, file.read(length))


def _messages_in(record: McapRecord, channels: dict[int, str] | None) -> list[FoundMessage]:
    """Unpack a chunk; channels: topics by number, to which those of the chunk are added; None: topics are not asked."""
    stream = BytesIO(_unpacked(Chunk.read(_stream(record.data))))
    size, found = len(stream.getbuffer()), []
    while stream.tell() < size:
        inner = _record(stream, size)
        if inner is None:
            raise ValueError("a record reaches beyond its chunk")
        if inner.opcode == Opcode.CHANNEL and channels is not None:
            channel = Channel.read(_stream(inner.data))
            channels[channel.id] = channel.topic
        if inner.opcode == Opcode.MESSAGE:
            message = Message.read(_stream(inner.data), len(inner.data))
            if channels is not None and message.channel_id not in channels:
                raise ValueError(f"a message of channel {message.channel_id}, which is none")
            topic = "" if channels is None else channels[message.channel_id]
            found.append(FoundMessage(topic, message.data, MessagePlace(record.at, len(found))))
    return found


def _unpacked(chunk: Chunk) -> bytes:
    """The chunk's records; ValueError where size or checksum are other than it says."""
    said = chunk.uncompressed_size
    if said > MOST_RECORD_BYTES:
        raise ValueError(f"a chunk of {said} bytes")
    if chunk.compression == "zstd":
        frame = zstandard.get_frame_parameters(chunk.data)
        if frame.content_size != said or frame.window_size > MOST_RECORD_BYTES:
            raise ValueError("a chunk of another size than it says")
        data = zstandard.ZstdDecompressor().decompress(chunk.data, max_output_size=said)
    elif chunk.compression == "":
        data = chunk.data
    else:
        raise ValueError(f"compression {chunk.compression!r}, which is unknown")
    if len(data) != said or zlib.crc32(data) != chunk.uncompressed_crc:
        raise ValueError("a chunk with another checksum than it says")
    return data


def _check_summary(file: BufferedIOBase, record: McapRecord) -> None:
    """ValueError where the index of a closed file is damaged."""
    footer = Footer.read(_stream(record.data))
    if not 0 < footer.summary_start <= record.at or record.at - footer.summary_start > MOST_RECORD_BYTES:
        raise ValueError("a summary that is not there")
    file.seek(footer.summary_start)
    checksum = zlib.crc32(file.read(record.at - footer.summary_start))
    head = FOOTER_HEAD.pack(Opcode.FOOTER, len(record.data), footer.summary_start, footer.summary_offset_start)
    _compare(footer.summary_crc, zlib.crc32(head, checksum), "the summary")
    file.seek(record.at + RECORD_HEAD.size + len(record.data))


def _compare(said: int, found: int, what: str) -> None:
    if said != found:
        raise ValueError(f"{what} has another checksum than the file says")


def _stream(data: bytes) -> ReadDataStream:
    return ReadDataStream(BytesIO(data))


def _damaged(path: Path, at: int, why: object) -> RecordingError:
    reason = " ".join(f"{type(why).__name__}: {why}".split()) if isinstance(why, McapError) else why
    return RecordingError(f"{path}: is damaged at byte {at} ({reason}); {RECORDING_MEND}")
