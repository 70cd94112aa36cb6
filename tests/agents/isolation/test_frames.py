"""Messages and frames that two processes share."""

import os

import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench.agents.isolation.frames import LEAST, PACKET, Frame, Message

WORDS = st.integers(0, 2**32 - 1)


@given(
    st.integers(0, 255),
    st.integers(0, 2**64 - 1),
    st.integers(0, 2**64 - 1),
    st.integers(-(2**31), 2**31 - 1),
    st.sampled_from(["|u1", "<f4", ""]),
    st.lists(WORDS, max_size=5).map(tuple),
)
def test_a_message_comes_back_from_its_packet(kind, number, size, row, dtype, shape):
    message = Message(kind, number, size, row, dtype, shape)
    packet = message.pack()
    assert len(packet) == PACKET
    assert Message.unpack(packet) == message


@given(st.binary(max_size=2 * PACKET) | st.binary(min_size=PACKET, max_size=PACKET))
def test_any_bytes_are_a_message_or_a_value_error(packet):
    try:
        message = Message.unpack(packet)
    except ValueError:
        return
    assert len(message.shape) <= 5


def test_nobody_can_change_the_size_of_a_frame():
    """A mapping whose memory was cut off would end our process."""
    frame, file = Frame.make(10)
    assert frame.capacity == LEAST
    for size in (0, 2 * LEAST):
        with pytest.raises(PermissionError):
            os.ftruncate(file, size)
    frame.write(b"hello")
    assert Frame.map(file).read(5) == b"hello"
