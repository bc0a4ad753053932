"""State machines as tables: a row says that in ``source``, when ``guard`` holds, ``target`` is next.

Guards are numbers; which of them hold is one integer with a bit for each. Rows are in order of priority.
"""

ANY_STATE = -1
"""The source of a row that holds in every state."""
Row = tuple[int, int, int]


def bit(guard: int, holds: bool) -> int:
    """Return the bit of ``guard`` if it holds."""
    return 1 << guard if holds else 0


def next_state(state: int, guards: int, rows: tuple[Row, ...]) -> int:
    """Return the state after one sample; ``guards`` holds bit g for guard g."""
    for source, guard, target in rows:
        if (source == state or source == ANY_STATE) and (guards >> guard) & 1 == 1:
            return target
    return state
